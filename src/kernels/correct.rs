//! Adds a coarser level's correction of a predicted flow to the prediction of this level.
//!
//! The correction is what the coarser level has changed, less a threshold: its magnitude is reduced by that, down to 0 (soft
//! thresholding; Donoho, De-noising by soft-thresholding, IEEE Trans. Information Theory 1995), so that a coarse level's noise
//! does not enter a good prediction. It is sampled bilinearly.

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
        /// Pixels in a row of the coarser level.
        in_width: u32,
        /// Rows of the coarser level.
        in_height: u32,
        /// The factor of displacements from the coarser level to this one.
        scale: f32,
        /// The magnitude, in pixels of the coarser level, that is taken off a correction.
        threshold: f32,
    }
}

kernel!(
    "correct" + [],
    reference(Params; prediction, coarse_flow, coarse_prediction, place_x, place_y) -> (flow),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-5,
        relative: 1e-6,
        of_largest: 2e-6,
        reason: "differences, linear mixes and a root of displacements: some ten roundings of the largest",
    },
);

fn reference(
    p: &Params,
    prediction: &[f32],
    coarse_flow: &[f32],
    coarse_prediction: &[f32],
    place_x: &[f32],
    place_y: &[f32],
    flow: &mut [f32],
) {
    let (width, _, stride) = dimensions(p.width, p.height);
    let (in_width, in_height, in_stride) = dimensions(p.in_width, p.in_height);
    let split = Split { scratch: 2 * in_stride, dearer: 2, ..Split::rows_of(2 * stride) };
    let places = place_x.as_chunks::<2>().0;
    bands(flow, &mut [], split, #[inline(always)] |band| {
        for (i, rows) in band.out.chunks_exact_mut(2 * stride).enumerate() {
            let y = band.y0 + i;
            let (above, fraction) = (place_y[2 * y] as usize, place_y[2 * y + 1]);
            let below = (above + 1).min(in_height - 1);
            for (channel, mixed) in band.scratch.chunks_exact_mut(in_stride).take(2).enumerate() {
                let [above, below] = [above, below].map(|y| (2 * y + channel) * in_stride);
                for (x, mixed) in mixed[..in_width].iter_mut().enumerate() {
                    let change = |row: usize| coarse_flow[row + x] - coarse_prediction[row + x];
                    *mixed = change(above) * (1.0 - fraction) + change(below) * fraction;
                }
            }
            let (mixed_u, mixed_v) = band.scratch.split_at(in_stride);
            let (u, v) = rows.split_at_mut(stride);
            let (u_0, v_0) = prediction[2 * y * stride..][..2 * stride].split_at(stride);
            for (x, place) in places[..width].iter().enumerate() {
                let left = place[0] as usize;
                let right = (left + 1).min(in_width - 1);
                let across = |mixed: &[f32]| mixed[left] * (1.0 - place[1]) + mixed[right] * place[1];
                let (c_u, c_v) = (across(mixed_u), across(mixed_v));
                let magnitude = (c_u * c_u + c_v * c_v).sqrt();
                let share = p.scale * (magnitude - p.threshold).max(0.0) / magnitude.max(1e-9);
                u[x] = u_0[x] + share * c_u;
                v[x] = v_0[x] + share * c_v;
            }
            repeat_last(u, width);
            repeat_last(v, width);
        }
    });
}

fn cases(size: Size) -> Vec<Case> {
    let coarse = Size::new(size.width.div_ceil(2), size.height.div_ceil(2));
    let params = Params {
        width: size.width,
        height: size.height,
        in_width: coarse.width,
        in_height: coarse.height,
        scale: 2.0,
        threshold: 0.5,
    };
    each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &[2 * size.stride()], size, |fill| {
        vec![
            planes(size, 2, fill, [-6.0, 6.0], 1),
            planes(coarse, 2, fill, [-1.0, 1.0], 2),
            planes(coarse, 2, Fill::Textured, [-1.0, 1.0], 3),
            tables::place(coarse.width, size.width),
            tables::place(coarse.height, size.height),
        ]
    })
}
