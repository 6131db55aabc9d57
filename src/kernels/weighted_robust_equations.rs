//! As [`super::robust_equations`], weighted by the certainty of both frames' expansions.
//!
//! The weight is the certainty of the first frame's pixel times that of the place in the second frame, which is sampled by
//! normalised interpolation, as in [`super::weighted_normal_equations`] (Knutsson and Westin, Normalized and differential
//! convolution, CVPR 1993).

use super::expansion_pair::{ExpansionPair, fours};
use super::parallel_rows::dimensions;
use super::robust_equations::{equations_of, inputs};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel};

pub use super::robust_equations::Params;

kernel!(
    "weighted_robust_equations" + ["equations", "model", "weighted_second", "slope_residual", "robust"],
    reference(
        Params; quad_0, cross_term_0, certainty_0, quad_1, cross_term_1, certainty_1, flow
    ) -> (equations),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-5,
        relative: 4e-4,
        of_largest: 3e-5,
        reason: "twice that of the equations without certainty, for the weight of the place has the same error again",
    },
);

/// Equations of less certainty are left out, because their expansion is a quotient of two numbers near zero.
pub(super) const LEAST_CERTAINTY: f32 = 1e-6;

#[allow(clippy::too_many_arguments, reason = "one for each buffer, as in the shader")]
fn reference(
    p: &Params,
    quad_0: &[f32],
    cross_term_0: &[f32],
    certainty_0: &[f32],
    quad_1: &[f32],
    cross_term_1: &[f32],
    certainty_1: &[f32],
    flow: &[f32],
    equations: &mut [f32],
) {
    let (width, height, stride) = dimensions(p.width, p.height);
    let (quad_0, quad_1) = (fours(quad_0), fours(quad_1));
    let certainty_1 = Some(certainty_1);
    let kappa = p.kappa;
    let pair =
        ExpansionPair { quad_0, cross_term_0, quad_1, cross_term_1, certainty_1, width, height, stride, kappa, time: 1.0 };
    pair.each_block(equations, flow, #[inline(always)] |model, stretch| {
        let mut channels = equations_of(model, stretch, p, 1.0);
        for (i, &own) in certainty_0[stretch.at..][..stretch.count].iter().enumerate() {
            let certainty = own * if model.inside[i] > 0.0 { model.certainty_1[i] } else { own };
            let weight = if certainty > LEAST_CERTAINTY { certainty } else { 0.0 };
            for channel in &mut channels {
                channel[i] = if weight > 0.0 { weight * channel[i] } else { 0.0 };
            }
        }
        channels
    });
}

fn cases(size: Size) -> Vec<Case> {
    let params =
        Params { width: size.width, height: size.height, kappa: 0.3, floor: 0.25, robust: 0.01, outside: 1.0, border: 1.0 };
    inputs(size, bytemuck::bytes_of(&params), &[[0.0, 1.0]])
}
