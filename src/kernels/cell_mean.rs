//! The mean of a plane over each cell's samples, weighted by their certainty: the confidence of a cell's flow from that
//! of its pixels.
//!
//! It is written twice, in the place of the two channels of [`cell_confidence`](super::cell_confidence).

use super::parallel_rows::{Split, bands, dimensions, repeat_last};
use super::test_inputs::{Fill, cases as each_fill, planes};
use super::cell_confidence::CHANNELS;
pub use super::cell_evidence::Params;
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel};

kernel!(
    "cell_mean" + [],
    reference(Params; plane, certainty) -> (mean),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-30,
        relative: 2e-5,
        of_largest: 0.0,
        reason: "a sum of at most some hundred products that are not negative, and one division: a rounding each",
    },
);

fn reference(p: &Params, plane: &[f32], certainty: &[f32], mean: &mut [f32]) {
    let (width, height, stride) = dimensions(p.width, p.height);
    let (columns, _, out_stride) = dimensions(p.columns, p.rows);
    let (cell, step) = (p.cell as usize, p.step as usize);
    bands(mean, &mut [], Split { dearer: 8, ..Split::rows_of(CHANNELS * out_stride) }, #[inline(always)] |band| {
        for (i, out) in band.out.chunks_exact_mut(CHANNELS * out_stride).enumerate() {
            let row = band.y0 + i;
            for column in 0..columns {
                let (mut count, mut sum) = (0.0, 0.0);
                for y in (row * cell..(row + 1) * cell).step_by(step).filter(|y| *y < height) {
                    for x in (column * cell..(column + 1) * cell).step_by(step).filter(|x| *x < width) {
                        count += 1.0;
                        sum += plane[y * stride + x] * certainty[y * stride + x];
                    }
                }
                (out[column], out[out_stride + column]) = (sum / count, sum / count);
            }
            out.chunks_exact_mut(out_stride).for_each(|row| repeat_last(row, columns));
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
    each_fill(Fill::ALL, bytemuck::bytes_of(&params), &[CHANNELS * extent.stride()], extent, |fill| {
        vec![planes(size, 1, fill, [0.0, 1.0], 1), planes(size, 1, Fill::Textured, [0.0, 1.0], 2)]
    })
}
