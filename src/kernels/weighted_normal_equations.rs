//! Each pixel's normal equations for its displacement, weighted by the certainty of both frames' expansions.
//!
//! As [`super::normal_equations`], with the equations weighted by the certainty of the first frame's pixel times that
//! of the place in the second frame. A place outside the second frame counts with the first frame's certainty: the
//! proportion of equations inside and outside then stays the same when all certainty is halved. The second frame is
//! sampled by normalised interpolation, each of the four pixels around a place by its bilinear weight times its
//! certainty, so that those without an expansion do not draw it towards zero.
//!
//! Farnebäck, Two-frame motion estimation based on polynomial expansion, SCIA 2003, section 3; Knutsson and Westin,
//! Normalized and differential convolution, CVPR 1993.

use super::expansion_pair::{ExpansionPair, fours};
use super::normal_equations::{both, equations_of};
use super::parallel_rows::dimensions;
use super::test_inputs::{Fill, cases as each_fill, planes, quads};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel};

pub use super::normal_equations::Params;

kernel!(
    "weighted_normal_equations" + ["image", "equations", "model", "second"],
    reference(
        Params; quad_0, cross_term_0, certainty_0, quad_1, cross_term_1, certainty_1, flow
    ) -> (equations),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-5,
        relative: 1e-4,
        of_largest: 3e-5,
        reason: "twice that of the equations without certainty, for the weight of the place has the same error again",
    },
);

/// Equations of less certainty are left out, because their expansion is a quotient of two numbers near zero.
const LEAST_CERTAINTY: f32 = 1e-6;

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
    let pair =
        ExpansionPair { quad_0, cross_term_0, quad_1, cross_term_1, certainty_1, width, height, stride, kappa: 0.0, time: 1.0 };
    pair.each_block(equations, flow, #[inline(always)] |model, stretch| {
        let mut channels = equations_of(model, stretch, p);
        for (i, &own) in certainty_0[stretch.at..][..stretch.count].iter().enumerate() {
            let certainty = own * if model.inside[i] > 0.0 { model.certainty_1[i] } else { own };
            let weight = if certainty > LEAST_CERTAINTY { certainty } else { 0.0 };
            for channel in &mut channels {
                channel[i] *= weight;
            }
        }
        channels
    });
}

fn cases(size: Size) -> Vec<Case> {
    both(size, counting)
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
            planes(size, 1, fill, [0.0, 1.0], 6),
            quads(size, fill, ranges, 3),
            planes(size, 1, fill, [-4.0, 4.0], 4),
            planes(size, 1, fill, [0.0, 1.0], 7),
            planes(size, 2, fill, [near, far], 5),
        ]
    })
}
