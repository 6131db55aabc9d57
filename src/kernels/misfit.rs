//! How far the two frames' expansions are from agreeing under a flow, in pixels.
//!
//! Outputs: `squared_misfit`, the sum s of the squared residuals of [`super::robust_equations`], at most 9, and 9 where the place is
//! outside the second frame or the first frame's pixel has no certainty; `agreement`, 1 − ½ min(√s, 2), times the certainty
//! and times h / (h + 0.05), where h is the squared norm of the Hessian: 1 where the expansions agree, 0 where they miss each
//! other by two pixels, and where there is no texture at all, not even noise.

use super::expansion_pair::{BLOCK, ExpansionPair, fours};
use super::parallel_rows::dimensions;
use super::robust_equations::residual;
use super::test_inputs::{Fill, cases as each_fill, planes, quads};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the image, and the residuals' form, as in [`super::robust_equations`].
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// The share κ of its Hessian by which an expansion is continued to a place between pixels.
        kappa: f32,
        /// ζ²: what is added to the squared slope that divides an equation.
        floor: f32,
    }
}

kernel!(
    "misfit" + ["equations", "model", "second", "continued", "slope_residual"],
    reference(Params; quad_0, cross_term_0, quad_1, cross_term_1, certainty, flow) -> (squared_misfit, agreement),
    cases: cases,
    tolerance: Tolerance {
        absolute: 2e-4,
        relative: 2e-4,
        of_largest: 0.0,
        reason: "a place's fraction has 2⁻¹⁴ px at 641, which times two expansions' difference over their slope is some 10⁻⁴ px \
                 where slopes are steep beside their floor",
    },
);

/// The largest squared residual that is told from others.
const LARGEST: f32 = 9.0;
/// The squared norm of the Hessian, in squared gray levels per px⁴, at which there is half a texture.
const FLAT: f32 = 0.05;

#[allow(clippy::too_many_arguments, reason = "one for each buffer, as in the shader")]
fn reference(
    p: &Params,
    quad_0: &[f32],
    cross_term_0: &[f32],
    quad_1: &[f32],
    cross_term_1: &[f32],
    certainty: &[f32],
    flow: &[f32],
    squared_misfit: &mut [f32],
    agreement: &mut [f32],
) {
    let (width, height, stride) = dimensions(p.width, p.height);
    let pair = ExpansionPair {
        quad_0: fours(quad_0),
        cross_term_0,
        quad_1: fours(quad_1),
        cross_term_1,
        certainty_1: None,
        width,
        height,
        stride,
        kappa: p.kappa,
        time: 1.0,
    };
    pair.each_block_of_two(squared_misfit, agreement, flow, #[inline(always)] |model, stretch| {
        let mut channels = [[0.0; BLOCK]; 2];
        for (i, certainty) in certainty[stretch.at..][..stretch.count].iter().enumerate() {
            let (xx, xy, yy) = (2.0 * model.a_xx[i], 2.0 * model.a_xy[i], 2.0 * model.a_yy[i]);
            let [_, _, s] = residual(xx, xy, yy, 2.0 * model.b_x[i], 2.0 * model.b_y[i], p.floor);
            let share = if model.inside[i] > 0.0 { *certainty } else { 0.0 };
            // NaN is as large as can be.
            let s = if s < LARGEST { s } else { LARGEST };
            channels[0][i] = LARGEST - share * (LARGEST - s);
            let texture = xx * xx + 2.0 * (xy * xy) + yy * yy;
            // A texture without bounds, after overflow, is none.
            let seen = if texture <= 1e30 { texture / (texture + FLAT) } else { 0.0 };
            channels[1][i] = share * seen * (1.0 - 0.5 * s.sqrt().min(2.0));
        }
        channels
    });
}

fn cases(size: Size) -> Vec<Case> {
    let params = Params { width: size.width, height: size.height, kappa: 0.3, floor: 0.25 };
    let ranges = [[-2.0, 2.0], [-2.0, 2.0], [-2.0, 2.0], [-2.0, 2.0]];
    let rows = [size.stride(), size.stride()];
    each_fill(Fill::ALL, bytemuck::bytes_of(&params), &rows, size, |fill| {
        // Flows of 0 keep whole places, where a wrong border shows; a flow of 10¹² is far outside.
        let flow = if fill == Fill::Extreme { [0.0, 1e12] } else { [-6.0, 6.0] };
        vec![
            quads(size, fill, ranges, 1),
            planes(size, 1, fill, [-2.0, 2.0], 2),
            quads(size, fill, ranges, 3),
            planes(size, 1, fill, [-2.0, 2.0], 4),
            planes(size, 1, Fill::Textured, [0.0, 1.0], 5),
            planes(size, 2, fill, flow, 6),
        ]
    })
}
