//! Averages columns of five channels, and their moments along the column, by a symmetric window: the vertical half of the
//! sums of an affine motion model.
//!
//! With t the distance from the window's centre along the column, relative to its radius, the outputs are the five channels
//! G_xx, G_xy, G_yy, q_x, q_y averaged, then the five times t averaged, then the three of G times t². Rows outside the image
//! have no weight: a repeated border would stand in the model at a place where it is not. [`super::solve_affine`] has the
//! other half.

use super::parallel_rows::{Split, bands, dimensions, weighted_sum};
use super::test_inputs::{Fill, cases as each_fill, planes};
use super::tables;
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the image and of the window.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// The window has `2 radius + 1` rows, with a radius from 1 to 512.
        radius: u32,
        /// The length of a pixel relative to the radius.
        step: f32,
    }
}

/// Channels of the output.
pub const CHANNELS: usize = 13;

kernel!(
    "affine_columns" + [],
    reference(Params; equations, window) -> (columns),
    cases: cases,
    tolerance: Tolerance {
        absolute: 0.0,
        relative: 4.0 * f32::EPSILON,
        of_largest: 16.0 * f32::EPSILON,
        reason: "a mean of values of either sign, fused or not: some roundings of the largest",
    },
);

fn reference(p: &Params, equations: &[f32], window: &[f32], columns: &mut [f32]) {
    let (_, height, stride) = dimensions(p.width, p.height);
    let radius = p.radius as usize;
    let taps = 2 * radius + 1;
    let split = Split { scratch: 2 * taps, dearer: 4, ..Split::rows_of(CHANNELS * stride) };
    bands(columns, &mut [], split, #[inline(always)] |band| {
        let weights = powers(&window[..taps], p.step, band.scratch);
        for (i, rows) in band.out.chunks_exact_mut(CHANNELS * stride).enumerate() {
            let y = band.y0 + i;
            // The window's rows inside the image.
            let (begin, end) = (radius.saturating_sub(y), taps.min(height + radius - y));
            let source = |k: usize| &equations[(y + begin + k - radius) * 5 * stride..][..5 * stride];
            let (one, rest) = rows.split_at_mut(5 * stride);
            let (first, second) = rest.split_at_mut(5 * stride);
            weighted_sum(one, &weights[0][begin..end], source);
            weighted_sum(first, &weights[1][begin..end], source);
            weighted_sum(second, &weights[2][begin..end], |k| &source(k)[..3 * stride]);
        }
    });
}

/// A window's weights times 1, t and t². `room` holds two values per weight.
#[inline(always)]
pub(super) fn powers<'a>(window: &'a [f32], step: f32, room: &'a mut [f32]) -> [&'a [f32]; 3] {
    let radius = (window.len() / 2) as f32;
    let (first, second) = room.split_at_mut(window.len());
    let second = &mut second[..window.len()];
    for (k, weight) in window.iter().enumerate() {
        let t = (k as f32 - radius) * step;
        first[k] = weight * t;
        second[k] = first[k] * t;
    }
    [window, first, second]
}

fn cases(size: Size) -> Vec<Case> {
    let params = Params { width: size.width, height: size.height, radius: 6, step: 1.0 / 6.0 };
    each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &[CHANNELS * size.stride()], size, |fill| {
        vec![planes(size, 5, fill, [-100.0, 100.0], 11), tables::window_from(&tables::window(13, true), 6)]
    })
}
