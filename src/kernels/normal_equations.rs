//! Each pixel's normal equations for its displacement, with the second frame sampled where the flow so far points.
//!
//! Farnebäck, Two-frame motion estimation based on polynomial expansion, SCIA 2003, section 3; the border's weights and
//! the treatment of places outside the image are OpenCV's.

use super::expansion_pair::{BLOCK, Block, ExpansionPair, Model, Stretch, fours, squared};
use super::parallel_rows::dimensions;
use super::test_inputs::{Fill, cases as each_fill, planes, quads};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the image.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// The share of the flow so far in the equations: 1 to solve for the flow, 0 to solve for its increment.
        carried: f32,
        /// The weight of a pixel whose place is outside the second frame: 1, or 0 to leave it out.
        outside: f32,
    }
}

kernel!(
    "normal_equations" + ["image", "equations", "model", "second"],
    reference(Params; quad_0, cross_term_0, quad_1, cross_term_1, flow) -> (equations),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-5,
        relative: 1e-4,
        of_largest: 1.5e-5,
        reason: "a place's fraction has 2⁻¹⁴ px at 641, and h sums products of two expansions and of the flow that \
                 may cancel: some hundred roundings of the largest",
    },
    variants: { narrow: { WORKGROUP_X = 16 }, wide: { WORKGROUP_X = 64 } },
);

fn reference(
    p: &Params,
    quad_0: &[f32],
    cross_term_0: &[f32],
    quad_1: &[f32],
    cross_term_1: &[f32],
    flow: &[f32],
    equations: &mut [f32],
) {
    let (width, height, stride) = dimensions(p.width, p.height);
    let (quad_0, quad_1) = (fours(quad_0), fours(quad_1));
    let pair =
        ExpansionPair { quad_0, cross_term_0, quad_1, cross_term_1, certainty_1: None, width, height, stride, kappa: 0.0, time: 1.0 };
    pair.each_block(equations, flow, #[inline(always)] |model, stretch| equations_of(model, stretch, p));
}

/// G = AᵀA and h = AᵀΔb with Δb = b + `carried` · A d: channels xx, xy, yy, x, y.
#[inline(always)]
pub(super) fn equations_of(model: &Model, stretch: &Stretch<'_>, p: &Params) -> [Block; 5] {
    let Stretch { u, v, weights_x, weight_y, .. } = *stretch;
    let mut channels = [[0.0; BLOCK]; 5];
    for (i, ((u, v), weight_x)) in u.iter().zip(v).zip(weights_x).enumerate() {
        let counts = if model.inside[i] > 0.0 { 1.0 } else { p.outside };
        let w = counts * weight_x * weight_y;
        let (u, v) = (p.carried * u, p.carried * v);
        let (a_xx, a_xy, a_yy) = (model.a_xx[i], model.a_xy[i], model.a_yy[i]);
        let b_x = w * (model.b_x[i] + a_xx * u + a_xy * v);
        let b_y = w * (model.b_y[i] + a_xy * u + a_yy * v);
        let (a_xx, a_xy, a_yy) = (w * a_xx, w * a_xy, w * a_yy);
        [channels[0][i], channels[1][i], channels[2][i]] = squared(a_xx, a_xy, a_yy);
        channels[3][i] = a_xx * b_x + a_xy * b_y;
        channels[4][i] = a_xy * b_x + a_yy * b_y;
    }
    channels
}

fn cases(size: Size) -> Vec<Case> {
    both(size, counting)
}

/// Cases in which the flow so far and what is outside count, and cases in which neither does.
pub(super) fn both(size: Size, counting: impl Fn(Size, &Params) -> Vec<Case>) -> Vec<Case> {
    let all = [1.0, 0.0].map(|share| {
        let params = Params { width: size.width, height: size.height, carried: share, outside: share };
        let cases = counting(size, &params).into_iter();
        cases.map(move |case| Case { name: format!("{}, {share} carried and outside", case.name), ..case })
    });
    all.into_iter().flatten().collect()
}

fn counting(size: Size, params: &Params) -> Vec<Case> {
    let ranges = [[-20.0, 20.0], [-20.0, 20.0], [-4.0, 4.0], [-4.0, 4.0]];
    each_fill(Fill::ALL, bytemuck::bytes_of(params), &[5 * size.stride()], size, |fill| {
        let far = if fill == Fill::Extreme { 1e12 } else { 6.0 };
        // Flows of 0 keep whole places, where a wrong border shows; a flow of 10¹² is far outside.
        let near = if fill == Fill::Extreme { 0.0 } else { -6.0 };
        vec![
            quads(size, fill, ranges, 1),
            planes(size, 1, fill, [-4.0, 4.0], 2),
            quads(size, fill, ranges, 3),
            planes(size, 1, fill, [-4.0, 4.0], 4),
            planes(size, 2, fill, [near, far], 5),
        ]
    })
}
