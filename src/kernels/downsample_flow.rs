//! Reduces a given flow to a coarser level: the mean over each coarse pixel's area, scaled to the level's pixel size.
//!
//! A displacement that is not finite, or over 10⁹ in magnitude, is unknown and counts as zero.

use super::parallel_rows::{Split, bands, dimensions, repeat_last};
use super::tables;
use super::test_inputs::{Fill, cases as each_fill, planes};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the two levels.
    struct Params {
        /// Pixels in a row of the result.
        width: u32,
        /// Rows of the result.
        height: u32,
        /// Pixels in a row of the given flow.
        in_width: u32,
        /// Rows of the given flow.
        in_height: u32,
        /// The factor of the displacements.
        scale: f32,
    }
}

kernel!(
    "downsample_flow" + [],
    reference(Params; fine, cover_x, cover_y) -> (flow),
    cases: cases,
    tolerance: Tolerance {
        absolute: 40.0 * 16.0 * f32::EPSILON,
        relative: 8.0 * f32::EPSILON, of_largest: 0.0,
        reason: "a mean of displacements up to 40 px of either sign, fused or not",
    },
);

fn reference(p: &Params, fine: &[f32], cover_x: &[f32], cover_y: &[f32], flow: &mut [f32]) {
    let (width, _, stride) = dimensions(p.width, p.height);
    let (_, _, in_stride) = dimensions(p.in_width, p.in_height);
    bands(flow, &mut [], Split::rows_of(2 * stride), #[inline(always)] |band| {
        for (i, rows) in band.out.chunks_exact_mut(2 * stride).enumerate() {
            let (u, v) = rows.split_at_mut(stride);
            let cover_y = &cover_y[4 * (band.y0 + i)..][..4];
            for x in 0..width {
                let cover_x = &cover_x[4 * x..][..4];
                let (mut sum, mut weights) = ([0.0, 0.0], 0.0);
                for j in 0..cover_y[1] as usize {
                    let row = 2 * (cover_y[0] as usize + j) * in_stride;
                    for i in 0..cover_x[1] as usize {
                        let at = row + cover_x[0] as usize + i;
                        let weight = weight(j, cover_y) * weight(i, cover_x);
                        let (du, dv) = (fine[at], fine[at + in_stride]);
                        if du.abs() <= 1e9 && dv.abs() <= 1e9 {
                            sum[0] += weight * du;
                            sum[1] += weight * dv;
                        }
                        weights += weight;
                    }
                }
                u[x] = p.scale * sum[0] / weights;
                v[x] = p.scale * sum[1] / weights;
            }
            repeat_last(u, width);
            repeat_last(v, width);
        }
    });
}

#[inline(always)]
fn weight(i: usize, cover: &[f32]) -> f32 {
    match i {
        0 => cover[2],
        _ if i + 1 == cover[1] as usize => cover[3],
        _ => 1.0,
    }
}

fn cases(size: Size) -> Vec<Case> {
    let coarse = Size::new((size.width * 3).div_ceil(5), (size.height * 3).div_ceil(5));
    let params = Params {
        width: coarse.width,
        height: coarse.height,
        in_width: size.width,
        in_height: size.height,
        scale: 0.6,
    };
    each_fill(Fill::ALL, bytemuck::bytes_of(&params), &[2 * coarse.stride()], coarse, |fill| {
        vec![
            planes(size, 2, fill, [-40.0, 40.0], 5),
            tables::cover(size.width, coarse.width),
            tables::cover(size.height, coarse.height),
        ]
    })
}
