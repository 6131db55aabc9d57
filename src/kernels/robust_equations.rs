//! Each pixel's equations for the increment of its displacement, each divided by its own slope and weighted by a robust
//! function of how far they are from holding.
//!
//! With H the mean of both expansions' Hessians, the second one sampled where the flow so far points, and r the difference
//! of their slopes there, H δ = r are two equations for the increment δ. The slope that multiplies δ divides each one, so
//! that its residual is a displacement in pixels (Zimmer, Bruhn and Weickert, Optic flow in harmony, IJCV 2011, section
//! 3.3), and the weight 1 / √(s + ε²), where s is the sum of the squared residuals, is that of a robust L1 norm (Brox,
//! Bruhn, Papenberg and Weickert, ECCV 2004). Farnebäck's equations (SCIA 2003) are those without both.
//!
//! Slopes between pixels are read by bilinear interpolation of the four expansions around a place, each continued by the
//! share κ of its own Hessian: linear interpolation errs by half the slope's second derivative, continuation by as much in
//! the other direction.

use super::expansion_pair::{BLOCK, Block, ExpansionPair, Model, Stretch, fours};
use super::parallel_rows::dimensions;
use super::test_inputs::{Fill, cases as each_fill, planes, quads};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the image, and the equations' form.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// The share κ of its Hessian by which an expansion is continued to a place between pixels.
        kappa: f32,
        /// ζ²: what is added to the squared slope that divides an equation. It stands for the noise of the slopes.
        floor: f32,
        /// ε², in square pixels, above 0; 0 for equations that all have the weight 1.
        robust: f32,
        /// The weight of a pixel whose place is outside the second frame: 1, with the first expansion alone, or 0.
        outside: f32,
        /// 1 to take OpenCV's weights off pixels near the border, or 0: a window that repeats the border counts them often.
        border: f32,
    }
}

kernel!(
    "robust_equations" + ["equations", "model", "second", "continued", "slope_residual", "robust"],
    reference(Params; quad_0, cross_term_0, quad_1, cross_term_1, flow) -> (equations),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-5,
        relative: 2e-4,
        of_largest: 1.5e-5,
        reason: "a place's fraction has 2⁻¹⁴ px at 641, which times the difference of two expansions is some hundred \
                 roundings of the largest; quotients and a reciprocal root add some units in the last place",
    },
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
    let certainty_1 = None;
    let pair = ExpansionPair {
        quad_0,
        cross_term_0,
        quad_1,
        cross_term_1,
        certainty_1,
        width,
        height,
        stride,
        kappa: p.kappa,
        time: 1.0,
    };
    pair.each_block(equations, flow, #[inline(always)] |model, stretch| equations_of(model, stretch, p, 1.0));
}

/// G = ψ Σ n h hᵀ and q = ψ Σ n r h over the two equations: channels xx, xy, yy, x, y; outside the second frame the first expansion's own, times
/// `outside`. `time` is that of the second expansion, which multiplies the Hessian.
#[inline(always)]
pub(super) fn equations_of(model: &Model, stretch: &Stretch<'_>, p: &Params, time: f32) -> [Block; 5] {
    let mut channels = [[0.0; BLOCK]; 5];
    for (i, inside) in model.inside.iter().enumerate() {
        // The model has half of the Hessians and of the slopes' difference.
        let [xx, xy, yy] = [&model.a_xx, &model.a_xy, &model.a_yy].map(|a| 2.0 * time * a[i]);
        let (r_x, r_y) = (2.0 * model.b_x[i], 2.0 * model.b_y[i]);
        let [n_x, n_y, s] = residual(xx, xy, yy, r_x, r_y, p.floor);
        let psi = if p.robust > 0.0 { 1.0 / (s + p.robust).sqrt() } else { 1.0 };
        let psi = if *inside > 0.0 { psi } else { p.outside * psi };
        let edge = stretch.weights_x[i] * stretch.weight_y;
        let psi = psi * (1.0 + p.border * (edge * edge - 1.0));
        let (n_x, n_y) = (psi * n_x, psi * n_y);
        channels[0][i] = n_x * xx * xx + n_y * xy * xy;
        channels[1][i] = n_x * xx * xy + n_y * xy * yy;
        channels[2][i] = n_x * xy * xy + n_y * yy * yy;
        channels[3][i] = n_x * xx * r_x + n_y * xy * r_y;
        channels[4][i] = n_x * xy * r_x + n_y * yy * r_y;
    }
    channels
}

/// The reciprocals of both squared slopes, and the sum of the squared residuals in pixels.
#[inline(always)]
pub(super) fn residual(xx: f32, xy: f32, yy: f32, r_x: f32, r_y: f32, floor: f32) -> [f32; 3] {
    let n_x = 1.0 / (xx * xx + xy * xy + floor);
    let n_y = 1.0 / (xy * xy + yy * yy + floor);
    [n_x, n_y, n_x * (r_x * r_x) + n_y * (r_y * r_y)]
}

/// Cases with robust weights and continued expansions, and cases with neither.
fn cases(size: Size) -> Vec<Case> {
    let all = [("robust", 0.3, 0.25, 0.01), ("plain", 0.0, 0.04, 0.0)].map(|(name, kappa, floor, robust)| {
        let outside = if robust > 0.0 { 0.0 } else { 1.0 };
        let params = Params { width: size.width, height: size.height, kappa, floor, robust, outside, border: outside };
        let cases = inputs(size, bytemuck::bytes_of(&params), &[]);
        cases.into_iter().map(move |case| Case { name: format!("{}, {name}", case.name), ..case })
    });
    all.into_iter().flatten().collect()
}

/// The inputs of the two frames' expansions and of the flow; `certainties` are inputs 2 and 5, if there are any.
pub(super) fn inputs(size: Size, params: &[u8], certainties: &[[f32; 2]]) -> Vec<Case> {
    let ranges = [[-20.0, 20.0], [-20.0, 20.0], [-4.0, 4.0], [-4.0, 4.0]];
    each_fill(Fill::ALL, params, &[5 * size.stride()], size, |fill| {
        let far = if fill == Fill::Extreme { 1e12 } else { 6.0 };
        // Flows of 0 keep whole places, where a wrong border shows; a flow of 10¹² is far outside.
        let near = if fill == Fill::Extreme { 0.0 } else { -6.0 };
        let mut inputs = Vec::new();
        for seed in [1, 3] {
            inputs.push(quads(size, fill, ranges, seed));
            inputs.push(planes(size, 1, fill, [-4.0, 4.0], seed + 1));
            inputs.extend(certainties.iter().map(|range| planes(size, 1, fill, *range, seed + 6)));
        }
        inputs.push(planes(size, 2, fill, [near, far], 5));
        inputs
    })
}
