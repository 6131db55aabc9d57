//! The flow on the view sphere averaged over square cells.
//!
//! The errors of neighbouring pixels' flow are correlated over about a window's width: cells of that order keep all
//! information. A cell's place and rate are means over its samples, in the plane of the ideal pinhole at unit distance:
//! of `m / m_z` for the midpoint bearing m, and of `(F − m F_z / m_z) / m_z` for the spherical flow F.
//!
//! Channels: 0 the confidence along the expected direction, 1 and 2 the place, 3 and 4 the rate, 5 the confidence in
//! every direction.

use super::bearings::{Pinhole, rows};
use super::cell_confidence::CHANNELS as CONFIDENCES;
use super::parallel_rows::{Split, bands, dimensions, repeat_last};
use super::spherical_flow::motion_case;
use super::test_inputs::{Fill, cases as each_fill, planes};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the cells and of the image, and the ideal pinhole that took it.
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
        /// Pixels of a focal length, to the right and down.
        focal: [f32; 2],
        /// Where the axis meets the image.
        centre: [f32; 2],
    }
}

kernel!(
    "cells" + ["sphere", "turn"],
    reference(Params; flow, motion, certainty, confidence) -> (cells),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-5,
        relative: 1e-5, of_largest: 0.0,
        reason: "rates are spherical flows divided by the cosine from the axis, squared: at 75 degrees fifteen times the \
                 roundings of the spherical flow",
    },
);

/// Channels of the result.
pub const CHANNELS: usize = 6;

fn reference(
    p: &Params,
    flow: &[f32],
    motion: &[f32],
    certainty: &[f32],
    confidence: &[f32],
    cells: &mut [f32],
) {
    let (width, height, stride) = dimensions(p.width, p.height);
    let (columns, _, out_stride) = dimensions(p.columns, p.rows);
    let motion = rows(motion);
    let pinhole = Pinhole { focal: p.focal, centre: p.centre };
    let (cell, step) = (p.cell as usize, p.step as usize);
    bands(cells, &mut [], Split { dearer: 8, ..Split::rows_of(CHANNELS * out_stride) }, #[inline(always)] |band| {
        for (i, rows) in band.out.chunks_exact_mut(CHANNELS * out_stride).enumerate() {
            let row = band.y0 + i;
            for column in 0..columns {
                let mut sums = [0.0f32; 5];
                for y in (row * cell..(row + 1) * cell).step_by(step).filter(|y| *y < height) {
                    for x in (column * cell..(column + 1) * cell).step_by(step).filter(|x| *x < width) {
                        let d = [flow[2 * y * stride + x], flow[(2 * y + 1) * stride + x]];
                        let (seen, known) = pinhole.midpoint_flow(&motion, [x as f32, y as f32], d);
                        let (m, f) = (seen.midpoint, seen.flow);
                        // Directions beside or behind the camera have no place in the pinhole's plane.
                        if known && m[2] > 0.01 {
                            let w = certainty[y * stride + x];
                            let place = [m[0] / m[2], m[1] / m[2]];
                            sums[0] += w;
                            for k in 0..2 {
                                sums[1 + k] += w * place[k];
                                sums[3 + k] += w * ((f[k] - place[k] * f[2]) / m[2]);
                            }
                        }
                    }
                }
                let known = sums[0] > 1e-3;
                let share = 1.0 / sums[0].max(1e-6);
                for (channel, of) in [(0, 0), (5, 1)] {
                    let confidence = confidence[(CONFIDENCES * row + of) * out_stride + column];
                    rows[channel * out_stride + column] = if known { confidence } else { 0.0 };
                }
                for k in 1..5 {
                    rows[k * out_stride + column] = if known { sums[k] * share } else { 0.0 };
                }
            }
            rows.chunks_exact_mut(out_stride).for_each(|row| repeat_last(row, columns));
        }
    });
}

fn cases(size: Size) -> Vec<Case> {
    let (width, height) = (size.width as f32, size.height as f32);
    let side = 8;
    let extent = Size::new(size.width.div_ceil(side), size.height.div_ceil(side));
    let params = Params {
        columns: extent.width,
        rows: extent.height,
        width: size.width,
        height: size.height,
        cell: side,
        step: 2,
        focal: [0.134 * width + 1.0, 0.15 * height + 1.0],
        centre: [0.52 * width, 0.47 * height],
    };
    each_fill(Fill::ALL, bytemuck::bytes_of(&params), &[CHANNELS * extent.stride()], extent, |fill| {
        let range = if fill == Fill::Extreme { [0.0, 1e12] } else { [-0.04 * width, 0.04 * width] };
        let mut certainty = planes(size, 1, fill, [0.1, 1.0], 4);
        // A corner without certainty, as a mask makes it.
        for row in certainty.chunks_exact_mut(size.stride()).take(20) {
            row.iter_mut().take(20).for_each(|c| *c = 0.0);
        }
        // The previous kernels never make a certainty NaN.
        certainty.iter_mut().filter(|c| c.is_nan()).for_each(|c| *c = 0.5);
        vec![
            planes(size, 2, fill, range, 3),
            motion_case(),
            certainty,
            planes(extent, CONFIDENCES, Fill::Textured, [0.0, 1.0], 5),
        ]
    })
}
