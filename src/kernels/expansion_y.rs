//! Polynomial expansion, vertical half: an image's columns are summed with the applicability times 1, y and y².
//!
//! Farnebäck, Two-frame motion estimation based on polynomial expansion, SCIA 2003, section 2, with the separable
//! Gaussian applicability of his thesis (2002).

use super::parallel_rows::{Split, bands, clamp_index, dimensions, weighted_sum};
use super::tables;
use super::test_inputs::{Fill, gray_cases};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the image and of the neighbourhood.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// The neighbourhood has `2 radius + 1` rows.
        radius: u32,
    }
}

kernel!(
    "expansion_y" + ["image"],
    reference(Params; level, applicability) -> (moments),
    cases: cases,
    tolerance: Tolerance {
        absolute: 0.0,
        relative: 1e-5,
        of_largest: 8e-6,
        reason: "eleven products of the brightness with y² g, fused or not; Σ y g f cancels, so what is left has the \
                 roundings of the largest",
    },
);

/// Takes the applicability times the n-th power of the distance out of its table, past `padding` leading zeros.
#[inline(always)]
pub(super) fn power(table: &[f32], padding: usize, n: usize, out: &mut [f32]) {
    for (k, out) in out.iter_mut().enumerate() {
        let sample = padding + k;
        *out = table[12 * (sample / 4) + 4 * n + sample % 4];
    }
}

fn reference(p: &Params, level: &[f32], applicability: &[f32], moments: &mut [f32]) {
    let (_, height, stride) = dimensions(p.width, p.height);
    let radius = p.radius as isize;
    let taps = 2 * p.radius as usize + 1;
    let split = Split { scratch: taps, ..Split::rows_of(3 * stride) };
    bands(moments, &mut [], split, #[inline(always)] |band| {
        for channel in 0..3 {
            power(applicability, 0, channel, band.scratch);
            for (i, rows) in band.out.chunks_exact_mut(3 * stride).enumerate() {
                let first = (band.y0 + i) as isize - radius;
                weighted_sum(&mut rows[channel * stride..][..stride], band.scratch, |k| {
                    &level[clamp_index(first + k as isize, height) * stride..][..stride]
                });
            }
        }
    });
}

fn cases(size: Size) -> Vec<Case> {
    let params = Params { width: size.width, height: size.height, radius: 5 };
    let weights = tables::applicability_from(&tables::applicability(5, 1.2).weights, 5);
    gray_cases(size, Fill::NUMBERS, bytemuck::bytes_of(&params), &[weights], &[3 * size.stride()], size)
}
