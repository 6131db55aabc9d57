//! Smooths the columns of an image by a Gaussian and samples them at fractional rows: the vertical half of one pyramid
//! step.

use super::parallel_rows::{Split, bands, dimensions, reflect_101, weighted_sum};
use super::tables;
use super::test_inputs::{Fill, gray_cases};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the images and of the Gaussian.
    struct Params {
        /// Pixels in a row, of both images.
        width: u32,
        /// Rows of the result.
        height: u32,
        /// Rows of the sampled image.
        in_height: u32,
        /// Samples of the Gaussian, odd.
        taps: u32,
    }
}

kernel!(
    "resample_y" + ["image"],
    reference(Params; gray, gauss, place) -> (columns),
    cases: cases,
    tolerance: Tolerance {
        absolute: 0.0,
        relative: 32.0 * f32::EPSILON, of_largest: 0.0,
        reason: "sums of positive products, at most some thirty terms of weight, fused or not",
    },
);

fn reference(p: &Params, gray: &[f32], gauss: &[f32], place: &[f32], columns: &mut [f32]) {
    let (_, _, stride) = dimensions(p.width, p.height);
    let in_height = p.in_height as usize;
    let taps = p.taps as usize;
    let split = Split { scratch: taps + 1, ..Split::rows_of(stride) };
    bands(columns, &mut [], split, #[inline(always)] |band| {
        for (i, out) in band.out.chunks_exact_mut(stride).enumerate() {
            let y = band.y0 + i;
            mix_weights(band.scratch, &gauss[..taps], place[2 * y + 1]);
            let first = place[2 * y] as isize - (taps / 2) as isize;
            weighted_sum(out, band.scratch, |k| {
                &gray[reflect_101(first + k as isize, in_height) * stride..][..stride]
            });
        }
    });
}

/// Sampling at a fraction between two smoothed samples is one sum over one more sample.
#[inline(always)]
pub(super) fn mix_weights(weights: &mut [f32], gauss: &[f32], fraction: f32) {
    let mut before = 0.0;
    for (weight, &here) in weights.iter_mut().zip(gauss.iter().chain(&[0.0])) {
        *weight = here * (1.0 - fraction) + before * fraction;
        before = here;
    }
}

fn cases(size: Size) -> Vec<Case> {
    let half = Size::new(size.width, size.height.div_ceil(2));
    let gauss = tables::gauss(1.5, 9);
    let place = tables::place(size.height, half.height);
    let params =
        Params { width: size.width, height: half.height, in_height: size.height, taps: gauss.len() as u32 };
    gray_cases(size, Fill::ALL, bytemuck::bytes_of(&params), &[gauss, place], &[size.stride()], half)
}
