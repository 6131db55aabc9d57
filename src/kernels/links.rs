//! The linear equations that smoothness makes of each pixel's own and its four neighbours': what [`super::sweep`] solves.
//!
//! Each pixel's flow d has equations G δ = q for the increment δ, and is held to its neighbours' by links s, each the mean of
//! both pixels' smoothness. With S the sum of a pixel's links, its new flow is (G + S)⁻¹ (c + Σ s d_j), where c = G d + q plus
//! what the expected slopes add: along a link the flow is expected to change by the mean of both pixels' slopes.
//!
//! Outputs: `system`, the inverse (G + S)⁻¹ (xx, xy, yy) and c (x, y); `link`, the links to the right and down, 0 across the
//! border.

use super::parallel_rows::{Split, bands, dimensions, repeat_last};
use super::slope_weights::four_rows;
use super::test_inputs::{Fill, Random, cases as each_fill, planes};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the image.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
    }
}

kernel!(
    "links" + [],
    reference(Params; equations, flow, smooth_weight, slope) -> (system, link),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-6,
        relative: 1e-5,
        of_largest: 2e-6,
        reason: "sums and products of a pixel's and its neighbours' values, and a reciprocal of a determinant that the links \
                 keep well off zero: some ten roundings of the largest",
    },
);

/// What keeps the determinant off zero where a pixel has neither neighbours nor texture.
const SMALLEST: f32 = 1e-9;

fn reference(
    p: &Params,
    equations: &[f32],
    flow: &[f32],
    smooth_weight: &[f32],
    slope: &[f32],
    system: &mut [f32],
    link: &mut [f32],
) {
    let (width, height, stride) = dimensions(p.width, p.height);
    let split = Split {
        second_row: 2 * stride,
        scratch: 4 * stride,
        dearer: 2,
        ..Split::rows_of(5 * stride)
    };
    bands(system, link, split, #[inline(always)] |band| {
        let rows = band.out.chunks_exact_mut(5 * stride).zip(band.second.chunks_exact_mut(2 * stride));
        for (i, (system, link)) in rows.enumerate() {
            let y = band.y0 + i;
            let (above, below) = (y.saturating_sub(1), (y + 1).min(height - 1));
            let weights = [above, y, below].map(|y| &smooth_weight[y * stride..][..stride]);
            let (right, down) = link.split_at_mut(stride);
            let up_exists = if y > 0 { 0.5 } else { 0.0 };
            let down_exists = if y + 1 < height { 0.5 } else { 0.0 };
            // The links to the left and up, and what the expected slopes add to x and to y. Slices of one length spare the
            // loops a check per pixel.
            let (left, rest) = band.scratch.split_at_mut(stride);
            let (up, added) = rest.split_at_mut(stride);
            let (left, up, added) = (&mut left[..width], &mut up[..width], &mut added[..2 * stride]);
            let [weights_above, weights, weights_below] = weights.map(|row| &row[..width]);
            let (right_row, down_row) = (&mut right[..width], &mut down[..width]);
            for x in 0..width {
                up[x] = up_exists * (weights[x] + weights_above[x]);
                down_row[x] = down_exists * (weights[x] + weights_below[x]);
            }
            for ((link, a), b) in right_row[..width - 1].iter_mut().zip(weights).zip(&weights[1..]) {
                *link = 0.5 * (a + b);
            }
            right_row[width - 1] = 0.0;
            left[0] = 0.0;
            left[1..].copy_from_slice(&right_row[..width - 1]);
            let (left, up, right, down) = (&*left, &*up, &*right_row, &*down_row);
            let slopes = [above, y, below].map(|y| four_rows(slope, y, stride).map(|row| &row[..width]));
            for (channel, added) in added.chunks_exact_mut(stride).enumerate() {
                let added = &mut added[..width];
                let along_x = slopes[1][2 * channel];
                let [above, here, below] = [0, 1, 2].map(|i| slopes[i][2 * channel + 1]);
                let horizontal = |x: usize, before: usize, next: usize| {
                    left[x] * (along_x[x] + along_x[before]) - right[x] * (along_x[x] + along_x[next])
                };
                added[0] = horizontal(0, 0, 1.min(width - 1));
                added[width - 1] = horizontal(width - 1, width.saturating_sub(2), width - 1);
                if let Some(inner) = width.checked_sub(2) {
                    let added = &mut added[1..][..inner];
                    let (left, right) = (&left[1..][..inner], &right[1..][..inner]);
                    let (before, along, next) = (&along_x[..inner], &along_x[1..][..inner], &along_x[2..][..inner]);
                    for x in 0..inner {
                        added[x] = left[x] * (along[x] + before[x]) - right[x] * (along[x] + next[x]);
                    }
                }
                for x in 0..width {
                    let vertical = up[x] * (here[x] + above[x]) - down[x] * (here[x] + below[x]);
                    added[x] = 0.5 * (added[x] + vertical);
                }
            }
            let (added_x, added_y) = added.split_at(stride);
            let (added_x, added_y) = (&added_x[..width], &added_y[..width]);
            let [u, v] = [0, 1].map(|channel| &flow[(2 * y + channel) * stride..][..width]);
            let [g_xx, g_xy, g_yy, q_x, q_y] =
                [0, 1, 2, 3, 4].map(|channel| &equations[(5 * y + channel) * stride..][..width]);
            let mut channels = system.chunks_exact_mut(stride).map(|row| &mut row[..width]);
            let [Some(xx), Some(xy), Some(yy), Some(c_x), Some(c_y)] = [(); 5].map(|()| channels.next()) else {
                unreachable!("there are five channels");
            };
            for x in 0..width {
                let sum = right[x] + left[x] + down[x] + up[x] + SMALLEST;
                c_x[x] = g_xx[x] * u[x] + g_xy[x] * v[x] + q_x[x] + added_x[x];
                c_y[x] = g_xy[x] * u[x] + g_yy[x] * v[x] + q_y[x] + added_y[x];
                let (a, c, b) = (g_xx[x] + sum, g_yy[x] + sum, g_xy[x]);
                let inverse = 1.0 / (a * c - b * b);
                (xx[x], xy[x], yy[x]) = (c * inverse, -b * inverse, a * inverse);
            }
            for row in system.chunks_exact_mut(stride).chain(link.chunks_exact_mut(stride)) {
                repeat_last(row, width);
            }
        }
    });
}

fn cases(size: Size) -> Vec<Case> {
    let params = Params { width: size.width, height: size.height };
    let rows = [5 * size.stride(), 2 * size.stride()];
    each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &rows, size, |fill| {
        vec![
            definite(size, 1),
            planes(size, 2, fill, [-6.0, 6.0], 2),
            planes(size, 1, fill, [0.5, 20.0], 3),
            planes(size, 4, fill, [-0.5, 0.5], 4),
        ]
    })
}

/// Equations of two random slopes a pixel, each of about 1, so that the determinant is not below zero.
pub(super) fn definite(size: Size, seed: u32) -> Vec<f32> {
    let mut random = Random::new(seed);
    let stride = size.stride();
    let mut values = vec![0.0; 5 * stride * size.height as usize];
    for rows in values.chunks_exact_mut(5 * stride) {
        for x in 0..size.width as usize {
            let [a, b, c, d, r_x, r_y] = [(); 6].map(|()| 2.0 * random.next() - 1.0);
            let pixel = [a * a + c * c, a * b + c * d, b * b + d * d, a * r_x + c * r_y, b * r_x + d * r_y];
            for (channel, value) in pixel.into_iter().enumerate() {
                rows[channel * stride + x] = value;
            }
        }
        rows.chunks_exact_mut(stride).for_each(|row| repeat_last(row, size.width as usize));
    }
    values
}
