//! Averages rows of weighted slopes by a symmetric window and divides them by the averaged weight: the slopes that the flow
//! is expected to have at each pixel.
//!
//! Channels of the result: ∂u/∂x, ∂u/∂y, ∂v/∂x, ∂v/∂y in pixels per pixel, clamped to ±½.

use super::solve::{self, average};
use super::test_inputs::{Fill, cases as each_fill, planes};
use super::{parallel_rows::repeat_last, tables};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the image and of the window.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// The window has `2 radius + 1` columns.
        radius: u32,
    }
}

kernel!(
    "expected_slope" + ["image", "window", "average"],
    reference(Params; columns, window) -> (slope),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-6,
        relative: 1e-5,
        of_largest: 2e-6,
        reason: "a quotient of two means of values of either sign, fused or not: some ten roundings of the largest",
    },
);

/// The steepest slope that is expected, in pixels per pixel.
const STEEPEST: f32 = 0.5;
/// What keeps the averaged weight off zero.
const SMALLEST: f32 = 1e-12;

fn reference(p: &Params, columns: &[f32], window: &[f32], slope: &mut [f32]) {
    let (width, stride) = (p.width as usize, Size::new(p.width, p.height).stride());
    let shape = solve::Params { width: p.width, height: p.height, radius: p.radius };
    average(&shape, columns, window, slope, 4, #[inline(always)] |_, averages, rows| {
        let [weight, slopes @ ..] = averages;
        for (row, slope) in rows.chunks_exact_mut(stride).zip(slopes) {
            for x in 0..width {
                let mean = slope[x] * (1.0 / (weight[x] + SMALLEST));
                row[x] = mean.clamp(-STEEPEST, STEEPEST);
            }
            repeat_last(row, width);
        }
    });
}

fn cases(size: Size) -> Vec<Case> {
    let params = Params { width: size.width, height: size.height, radius: 6 };
    each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &[4 * size.stride()], size, |fill| {
        let mut weighted = planes(size, 5, fill, [-0.4, 0.4], 3);
        for rows in weighted.chunks_exact_mut(5 * size.stride()) {
            // The weights are above 0, and at most 1.
            rows[..size.stride()].iter_mut().for_each(|weight| *weight = 0.1 + weight.abs());
        }
        vec![weighted, tables::window_from(&tables::window(13, true), 8)]
    })
}
