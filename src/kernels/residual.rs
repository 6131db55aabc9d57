//! The residual of each pixel: how well the two frames' expansions agree under the estimated flow.
//!
//! Channels of the result: AᵀA (xx, xy, yy), the square of the residual of Δb = −½ (b2 − b1), and 1 where both frames
//! show the place. All are weighted by the first frame's certainty.

use super::expansion_pair::{BLOCK, ExpansionPair, fours, squared};
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
    }
}

kernel!(
    "residual" + ["equations", "model", "second"],
    reference(Params; quad_0, cross_term_0, quad_1, cross_term_1, certainty, flow) -> (evidence),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-5,
        relative: 1e-4,
        of_largest: 3e-5,
        reason: "a place's fraction has 2⁻¹⁴ px at 641, and Δb is a difference that is squared: some hundred \
                 roundings of the largest",
    },
);

#[allow(clippy::too_many_arguments, reason = "they are the kernel's buffers")]
fn reference(
    p: &Params,
    quad_0: &[f32],
    cross_term_0: &[f32],
    quad_1: &[f32],
    cross_term_1: &[f32],
    certainty: &[f32],
    flow: &[f32],
    evidence: &mut [f32],
) {
    let (width, height, stride) = dimensions(p.width, p.height);
    let (quad_0, quad_1) = (fours(quad_0), fours(quad_1));
    let pair =
        ExpansionPair { quad_0, cross_term_0, quad_1, cross_term_1, certainty_1: None, width, height, stride, kappa: 0.0, time: 1.0 };
    pair.each_block(evidence, flow, #[inline(always)] |model, stretch| {
        let mut channels = [[0.0; BLOCK]; 5];
        let certainties = &certainty[stretch.at..][..stretch.count];
        for (i, (weight_x, certainty)) in stretch.weights_x.iter().zip(certainties).enumerate() {
            let share = model.inside[i] * certainty;
            let w = share * weight_x * stretch.weight_y;
            let (b_x, b_y) = (w * model.b_x[i], w * model.b_y[i]);
            [channels[0][i], channels[1][i], channels[2][i]] =
                squared(w * model.a_xx[i], w * model.a_xy[i], w * model.a_yy[i]);
            channels[3][i] = b_x * b_x + b_y * b_y;
            channels[4][i] = share;
        }
        channels
    });
}

fn cases(size: Size) -> Vec<Case> {
    let params = Params { width: size.width, height: size.height };
    let ranges = [[-20.0, 20.0], [-20.0, 20.0], [-4.0, 4.0], [-4.0, 4.0]];
    each_fill(Fill::ALL, bytemuck::bytes_of(&params), &[5 * size.stride()], size, |fill| {
        // Flows of 0 keep whole places, where a wrong border shows; a flow of 10¹² is far outside.
        let flow = if fill == Fill::Extreme { [0.0, 1e12] } else { [-6.0, 6.0] };
        vec![
            quads(size, fill, ranges, 1),
            planes(size, 1, fill, [-4.0, 4.0], 2),
            quads(size, fill, ranges, 3),
            planes(size, 1, fill, [-4.0, 4.0], 4),
            planes(size, 1, fill, [0.0, 1.0], 5),
            planes(size, 2, fill, flow, 6),
        ]
    })
}
