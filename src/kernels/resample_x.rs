//! Smooths the rows of an image by a Gaussian and samples them at fractional columns: the horizontal half of one
//! pyramid step.

use super::parallel_rows::{Split, bands, dimensions, reflect_101, repeat_last};
use super::resample_y::mix_weights;
use super::tables;
use super::test_inputs::{Fill, gray_cases};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the images and of the Gaussian.
    struct Params {
        /// Pixels in a row of the result.
        width: u32,
        /// Rows, of both images.
        height: u32,
        /// Pixels in a row of the sampled image.
        in_width: u32,
        /// Samples of the Gaussian, odd.
        taps: u32,
    }
}

kernel!(
    "resample_x" + ["image"],
    reference(Params; columns, gauss, place) -> (level),
    cases: cases,
    tolerance: Tolerance {
        absolute: 0.0,
        relative: 32.0 * f32::EPSILON, of_largest: 0.0,
        reason: "sums of positive products, at most some thirty terms of weight, fused or not",
    },
);

fn reference(p: &Params, columns: &[f32], gauss: &[f32], place: &[f32], level: &mut [f32]) {
    let (width, _, stride) = dimensions(p.width, p.height);
    let (in_width, _, in_stride) = dimensions(p.in_width, p.height);
    let taps = p.taps as usize;
    let radius = taps / 2;
    let mirrored = in_width + 2 * radius + 2;
    let split = Split { scratch: (taps + 1) * width + mirrored, ..Split::rows_of(stride) };
    bands(level, &mut [], split, #[inline(always)] |band| {
        let (weights, mirrored) = band.scratch.split_at_mut((taps + 1) * width);
        for (x, weights) in weights.chunks_exact_mut(taps + 1).enumerate() {
            mix_weights(weights, &gauss[..taps], place[2 * x + 1]);
        }
        for (i, out) in band.out.chunks_exact_mut(stride).enumerate() {
            let row = &columns[(band.y0 + i) * in_stride..][..in_stride];
            for (k, m) in mirrored[..radius].iter_mut().enumerate() {
                *m = row[reflect_101(k as isize - radius as isize, in_width)];
            }
            mirrored[radius..radius + in_width].copy_from_slice(&row[..in_width]);
            for (k, m) in mirrored[radius + in_width..].iter_mut().enumerate() {
                *m = row[reflect_101((in_width + k) as isize, in_width)];
            }
            for (x, (out, weights)) in out[..width].iter_mut().zip(weights.chunks_exact(taps + 1)).enumerate() {
                let under = &mirrored[place[2 * x] as usize..][..taps + 1];
                *out = weights.iter().zip(under).fold(0.0, |sum, (w, v)| sum + w * v);
            }
            repeat_last(out, width);
        }
    });
}

fn cases(size: Size) -> Vec<Case> {
    let half = Size::new(size.width.div_ceil(2), size.height);
    let gauss = tables::gauss(1.5, 9);
    let place = tables::place(size.width, half.width);
    let params =
        Params { width: half.width, height: size.height, in_width: size.width, taps: gauss.len() as u32 };
    gray_cases(size, Fill::ALL, bytemuck::bytes_of(&params), &[gauss, place], &[half.stride()], half)
}
