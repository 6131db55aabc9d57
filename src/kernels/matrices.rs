//! Each pixel's normal equations for its displacement, with the second frame read where the flow so far points.
//!
//! Farnebäck, Two-frame motion estimation based on polynomial expansion, SCIA 2003, section 3; the border's weights and
//! what happens outside the picture are OpenCV's.

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
    "matrices" + ["image", "equations", "second"],
    reference(Params; quad_0, cross_term_0, quad_1, cross_term_1, flow) -> (equations),
    cases: cases,
    tolerance: Tolerance {
        absolute: 4e-3,
        relative: 1e-4,
        reason: "a place's fraction has 2⁻¹⁴ px at 641; the expansions differ by up to 40 from pixel to pixel in these \
                 cases, and h sums products of two of them and of the flow",
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
    let pair =
        Pair { quad_0: fours(quad_0), cross_term_0, quad_1: fours(quad_1), cross_term_1, width, height, stride };
    let split = Split { scratch: stride, ..Split::rows_of(5 * stride) };
    bands(equations, &mut [], split, #[inline(always)] |band| {
        for (x, weight) in band.scratch.iter_mut().enumerate() {
            *weight = border_weight(x.min(width - 1), width);
        }
        for (i, rows) in band.out.chunks_exact_mut(5 * stride).enumerate() {
            let y = band.y0 + i;
            let weight_y = border_weight(y, height);
            let (u, v) = fours(&flow[2 * y * stride..][..2 * stride]).split_at(stride / 4);
            let out = rows.as_chunks_mut::<4>().0;
            for four in 0..stride / 4 {
                let d = [u[four], v[four]].map(Vec4::from_array);
                let mut model = pair.model(four, y, d);
                let weight = weight_y * Vec4::from_array(fours(band.scratch)[four]);
                let b_x = weight * (model.b_x + model.a_xx * d[0] + model.a_xy * d[1]);
                let b_y = weight * (model.b_y + model.a_xy * d[0] + model.a_yy * d[1]);
                for a in [&mut model.a_xx, &mut model.a_xy, &mut model.a_yy] {
                    *a *= weight;
                }
                let g = model.squared();
                let h = [model.a_xx * b_x + model.a_xy * b_y, model.a_xy * b_x + model.a_yy * b_y];
                // Equations that overflowed or were never numbers say nothing; zeros keep that from spreading.
                let size = g[0].abs() + g[1].abs() + g[2].abs() + h[0].abs() + h[1].abs();
                let known = size.cmple(Vec4::splat(1e30));
                for (channel, value) in [g[0], g[1], g[2], h[0], h[1]].into_iter().enumerate() {
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
