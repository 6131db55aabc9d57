//! The confidence of each cell's flow, from its [`cell_evidence`]: along the direction that it is
//! expected to have, and in every direction.
//!
//! The flow that translation causes points away from the direction of motion. A thin upright thing says little of its
//! flow along itself (the aperture problem), but much of its flow across, and across is where an obstacle beside the
//! path moves. With the mean G of AᵀA and the variance r of the residual, the error along a unit vector e has the
//! variance `(r + 0.001) eᵀG⁻¹e`; its root is mapped as [`confidence`](super::confidence) maps the error in the worst
//! direction, which is the second channel. The first is the larger of the two.
//!
//! Near the direction of motion, or where that is not known, no direction is expected, and both channels are the same.

use super::bearings::rows;
use super::cell_evidence;
use super::confidence::{confidence_along, confidence_of};
use super::parallel_rows::{Split, bands, dimensions, repeat_last};
use super::spherical_flow::motion_case;
use super::test_inputs::{Fill, Random, cases as each_fill, planes};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the cells, and the ideal pinhole.
    struct Params {
        /// Cells in a row.
        columns: u32,
        /// Rows of cells.
        rows: u32,
        /// Distance of neighbouring cells' centres in the pinhole's plane.
        pitch: [f32; 2],
        /// The first cell's centre in that plane.
        origin: [f32; 2],
        /// Pixels of a focal length, to the right and down.
        focal: [f32; 2],
        /// The largest standard error of the direction of motion at which the flow has an expected direction, radians.
        known_rad: f32,
        /// The least distance from the direction of motion at which it has one, in the pinhole's plane.
        near: f32,
    }
}

kernel!(
    "cell_confidence" + ["confidence"],
    reference(Params; evidence, motion) -> (confidence),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-4,
        relative: 0.0, of_largest: 0.0,
        reason: "as in confidence: the least eigenvalue, and the determinant, are differences, and keep four digits where \
                 the eigenvalues are in a ratio of some hundred, and the share of 1 is taken of their root",
    },
);

/// Channels of the result: along the expected direction, and in every direction.
pub const CHANNELS: usize = 2;

fn reference(p: &Params, evidence: &[f32], motion: &[f32], confidence: &mut [f32]) {
    let (columns, _, stride) = dimensions(p.columns, p.rows);
    let [v_x, v_y, v_z, v_error] = rows(motion)[3];
    bands(confidence, &mut [], Split::rows_of(CHANNELS * stride), #[inline(always)] |band| {
        for (i, out) in band.out.chunks_exact_mut(CHANNELS * stride).enumerate() {
            let row = band.y0 + i;
            for column in 0..columns {
                let mean: [f32; cell_evidence::CHANNELS] = std::array::from_fn(|k| evidence[(cell_evidence::CHANNELS * row + k) * stride + column]);
                let every = confidence_of(mean);
                let plane = [
                    p.origin[0] + column as f32 * p.pitch[0],
                    p.origin[1] + row as f32 * p.pitch[1],
                ];
                let away = [v_z * plane[0] - v_x, v_z * plane[1] - v_y];
                let expected = v_error < p.known_rad && away[0] * away[0] + away[1] * away[1] > p.near * p.near;
                let e = [away[0] * p.focal[0], away[1] * p.focal[1]];
                let along = if expected { confidence_along(mean, e).max(every) } else { every };
                (out[column], out[stride + column]) = (along, every);
            }
            out.chunks_exact_mut(stride).for_each(|row| repeat_last(row, columns));
        }
    });
}

fn cases(size: Size) -> Vec<Case> {
    let extent = Size::new(size.width.div_ceil(4), size.height.div_ceil(4));
    let params = Params {
        columns: extent.width,
        rows: extent.height,
        pitch: [0.02, 0.03],
        origin: [-0.2, -0.3],
        focal: [200.0, 210.0],
        known_rad: 0.3,
        near: 0.05,
    };
    each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &[CHANNELS * extent.stride()], extent, |fill| {
        let mut evidence = planes(extent, cell_evidence::CHANNELS, fill, [0.0, 1.0], 3);
        let mut random = Random::new(4);
        let stride = extent.stride();
        for rows in evidence.chunks_exact_mut(cell_evidence::CHANNELS * stride) {
            for column in 0..stride {
                // A matrix AᵀA, of eigenvalues in a ratio of up to a hundred.
                let from = column.min(extent.width as usize - 1);
                let [large, ratio, angle] = [0, 1, 2].map(|_| random.next());
                let (sin, cos) = (3.0 * angle).sin_cos();
                let (first, second) = (4.0 * large + 0.1, (4.0 * large + 0.1) * (0.01 + 0.9 * ratio));
                let g = [
                    first * cos * cos + second * sin * sin,
                    (first - second) * sin * cos,
                    first * sin * sin + second * cos * cos,
                ];
                for (k, value) in g.into_iter().enumerate() {
                    rows[k * stride + column] = if from == column { value } else { rows[k * stride + from] };
                }
            }
        }
        vec![evidence, motion_case()]
    })
}
