//! The evidence of each cell's flow: means over its samples.
//!
//! Channels: 0 to 2 AᵀA (xx, xy, yy), 3 the square of the residual of Δb, 4 the share that both frames show. The
//! equations are set up again at the samples only: with every fourth pixel of every fourth row that costs a sixteenth of
//! the whole plane. [`cell_confidence`](super::cell_confidence) judges them.

use super::expansion_pair::{fours, squared};
use super::parallel_rows::{Split, bands, dimensions, repeat_last};
use super::test_inputs::{Fill, cases as each_fill, planes, quads};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the cells and of the image.
    struct Params {
        /// Cells in a row.
        columns: u32,
        /// Rows of cells.
        rows: u32,
        /// Pixels in a row.
        width: u32,
        /// Rows of pixels.
        height: u32,
        /// Pixels of a cell's side, 1 to 64.
        cell: u32,
        /// Pixels from one sample to the next, at least 1.
        step: u32,
    }
}

kernel!(
    "cell_evidence" + ["equations", "model", "second"],
    reference(
        Params; quad_0, cross_term_0, quad_1, cross_term_1, certainty_0, certainty_1, flow
    ) -> (evidence),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-6,
        relative: 2e-5, of_largest: 1e-6,
        reason: "means of squares over at most some hundred samples; a product xy and a residual are differences, of \
                 terms as large as the largest value",
    },
);

/// Channels of the result.
pub const CHANNELS: usize = 5;

/// The second frame between the four pixels around a place.
struct Second<'a> {
    quad: &'a [[f32; 4]],
    cross_term: &'a [f32],
    width: usize,
    height: usize,
    stride: usize,
}

impl Second<'_> {
    /// b_x, b_y, A_xx, A_yy, 2 A_xy there, and the pixel above and to the left; none outside.
    #[inline(always)]
    fn at(&self, x: f32, y: f32) -> Option<([f32; 5], usize)> {
        let (right, bottom) = ((self.width - 1) as f32, (self.height - 1) as f32);
        if !(x >= 0.0 && y >= 0.0 && x < right && y < bottom) {
            return None;
        }
        let (left, above) = (x as usize, y as usize);
        let (fx, fy) = (x - left as f32, y - above as f32);
        let first = above * self.stride + left;
        let mut sum = [0.0; 5];
        for (at, w) in [
            (first, (1.0 - fx) * (1.0 - fy)),
            (first + 1, fx * (1.0 - fy)),
            (first + self.stride, (1.0 - fx) * fy),
            (first + self.stride + 1, fx * fy),
        ] {
            for (sum, value) in sum.iter_mut().zip(self.quad[at]) {
                *sum += w * value;
            }
            sum[4] += w * self.cross_term[at];
        }
        Some((sum, first))
    }
}

#[allow(clippy::too_many_arguments, reason = "they are the kernel's buffers")]
fn reference(
    p: &Params,
    quad_0: &[f32],
    cross_term_0: &[f32],
    quad_1: &[f32],
    cross_term_1: &[f32],
    certainty_0: &[f32],
    certainty_1: &[f32],
    flow: &[f32],
    evidence: &mut [f32],
) {
    let (width, height, stride) = dimensions(p.width, p.height);
    let (columns, _, out_stride) = dimensions(p.columns, p.rows);
    let quad_0 = fours(quad_0);
    let second = Second { quad: fours(quad_1), cross_term: cross_term_1, width, height, stride };
    let (cell, step) = (p.cell as usize, p.step as usize);
    bands(evidence, &mut [], Split { dearer: 32, ..Split::rows_of(CHANNELS * out_stride) }, #[inline(always)] |band| {
        for (i, rows) in band.out.chunks_exact_mut(CHANNELS * out_stride).enumerate() {
            let row = band.y0 + i;
            for column in 0..columns {
                let mut count = 0.0;
                let mut sums = [0.0f32; CHANNELS];
                for y in (row * cell..(row + 1) * cell).step_by(step).filter(|y| *y < height) {
                    for x in (column * cell..(column + 1) * cell).step_by(step).filter(|x| *x < width) {
                        count += 1.0;
                        let at = y * stride + x;
                        let (u, v) = (flow[2 * y * stride + x], flow[(2 * y + 1) * stride + x]);
                        let Some((other, there)) = second.at(x as f32 + u, y as f32 + v) else { continue };
                        let share = certainty_0[at] * certainty_1[there];
                        let q = quad_0[at];
                        let [b_x, b_y] = [0, 1].map(|k| share * 0.5 * (q[k] - other[k]));
                        let [a_xx, a_yy] = [2, 3].map(|k| share * 0.5 * (q[k] + other[k]));
                        let a_xy = share * 0.25 * (cross_term_0[at] + other[4]);
                        let [g_xx, g_xy, g_yy] = squared(a_xx, a_xy, a_yy);
                        let rest = b_x * b_x + b_y * b_y;
                        if g_xx.abs() + g_xy.abs() + g_yy.abs() + rest <= 1e30 {
                            for (sum, value) in sums.iter_mut().zip([g_xx, g_xy, g_yy, rest, share]) {
                                *sum += value;
                            }
                        }
                    }
                }
                for (channel, sum) in sums.into_iter().enumerate() {
                    rows[channel * out_stride + column] = sum * (1.0 / count);
                }
            }
            rows.chunks_exact_mut(out_stride).for_each(|row| repeat_last(row, columns));
        }
    });
}

fn cases(size: Size) -> Vec<Case> {
    let side = 8;
    let extent = Size::new(size.width.div_ceil(side), size.height.div_ceil(side));
    let params = Params {
        columns: extent.width,
        rows: extent.height,
        width: size.width,
        height: size.height,
        cell: side,
        step: 2,
    };
    let ranges = [[-2.0, 2.0], [-2.0, 2.0], [-4.0, 4.0], [-4.0, 4.0]];
    each_fill(Fill::ALL, bytemuck::bytes_of(&params), &[CHANNELS * extent.stride()], extent, |fill| {
        let flow = if fill == Fill::Extreme { [0.0, 1e12] } else { [-6.0, 6.0] };
        vec![
            quads(size, fill, ranges, 1),
            planes(size, 1, fill, [-4.0, 4.0], 2),
            quads(size, fill, ranges, 3),
            planes(size, 1, fill, [-4.0, 4.0], 4),
            planes(size, 1, Fill::Textured, [0.0, 1.0], 5),
            planes(size, 1, Fill::Textured, [0.5, 1.0], 6),
            planes(size, 2, fill, flow, 7),
        ]
    })
}
