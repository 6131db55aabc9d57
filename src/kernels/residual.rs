//! How well the two frames' expansions agree under the flow that was found, pixel by pixel.
//!
//! Channels of the result: AᵀA (xx, xy, yy), the square of what the flow leaves of Δb = −½ (b2 − b1), and 1 where both
//! frames show the place, times the first frame's certainty, which all of them are weighted with.

use glam::Vec4;

use super::cases::{Fill, cases as each_fill, planes, quads};
use super::pair::{Pair, border_weight, fours};
use super::rows::{Split, bands, dimensions};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the picture.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
    }
}

kernel!(
    "residual" + ["equations", "second"],
    reference(Params; quad_0, cross_term_0, quad_1, cross_term_1, certainty, flow) -> (evidence),
    cases: cases,
    tolerance: Tolerance {
        absolute: 2e-2,
        relative: 1e-4,
        reason: "a place's fraction has 2⁻¹⁴ px at 641; the expansions differ by up to 40 from pixel to pixel in these \
                 cases, and ‖Δb‖² is up to 800",
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
    let pair =
        Pair { quad_0: fours(quad_0), cross_term_0, quad_1: fours(quad_1), cross_term_1, width, height, stride };
    let split = Split { scratch: stride, ..Split::rows_of(5 * stride) };
    bands(evidence, &mut [], split, #[inline(always)] |band| {
        for (x, weight) in band.scratch.iter_mut().enumerate() {
            *weight = border_weight(x.min(width - 1), width);
        }
        for (i, rows) in band.out.chunks_exact_mut(5 * stride).enumerate() {
            let y = band.y0 + i;
            let weight_y = border_weight(y, height);
            let (u, v) = fours(&flow[2 * y * stride..][..2 * stride]).split_at(stride / 4);
            let certainty = &fours(certainty)[y * stride / 4..][..stride / 4];
            let out = rows.as_chunks_mut::<4>().0;
            for four in 0..stride / 4 {
                let mut model = pair.model(four, y, [u[four], v[four]].map(Vec4::from_array));
                let share = Vec4::select(model.inside, Vec4::from_array(certainty[four]), Vec4::ZERO);
                let weight = share * weight_y * Vec4::from_array(fours(band.scratch)[four]);
                for term in
                    [&mut model.a_xx, &mut model.a_xy, &mut model.a_yy, &mut model.b_x, &mut model.b_y]
                {
                    *term *= weight;
                }
                let g = model.squared();
                let rest = model.b_x * model.b_x + model.b_y * model.b_y;
                let size = g[0].abs() + g[1].abs() + g[2].abs() + rest;
                let known = size.cmple(Vec4::splat(1e30));
                for (channel, value) in [g[0], g[1], g[2], rest, share].into_iter().enumerate() {
                    out[channel * (stride / 4) + four] = Vec4::select(known, value, Vec4::ZERO).to_array();
                }
            }
        }
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
