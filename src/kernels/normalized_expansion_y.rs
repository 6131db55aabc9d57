//! Polynomial expansion by normalised convolution, vertical half: the columns of an image's certainty c, and of the
//! image f times its certainty, are summed with the applicability g times powers of y.
//!
//! Channels are Σ yᵏ g c for k from 0 to 4, the elements of the normal matrix, then Σ yᵏ g c f for k from 0 to 2.
//! Farnebäck, Two-frame motion estimation based on polynomial expansion, SCIA 2003, section 2, with the separable
//! Gaussian applicability of his thesis (2002). With a weight of 1 the border is repeated outside, so that a certainty
//! of 1 everywhere gives the expansion without certainty; with 0 only pixels of the image count.

use super::expansion_y::power;
use super::parallel_rows::{Split, bands, clamp_index, dimensions, weighted_sum};
use super::tables;
use super::test_inputs::{Fill, cases as each_fill, planes};
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
        /// The weight of rows outside the image: 1 repeats the border, 0 leaves them out.
        outside: f32,
    }
}

kernel!(
    "normalized_expansion_y" + ["image"],
    reference(Params; weighted, certainty, applicability) -> (moments),
    cases: cases,
    tolerance: Tolerance {
        absolute: 0.0,
        relative: 1e-5,
        of_largest: 8e-6,
        reason: "eleven products of the brightness with y² g, fused or not; Σ y g c f cancels, so what is left has the \
                 roundings of the largest",
    },
);

/// Channels of the moments.
pub(super) const CHANNELS: usize = 8;

/// The applicability times the powers 0 to 4 of the distance, `taps` weights each.
///
/// The table holds the first three; the others are multiplied here, as in the shader.
#[inline(always)]
pub(super) fn powers(applicability: &[f32], padding: usize, radius: usize, weights: &mut [f32]) {
    let taps = 2 * radius + 1;
    for n in 0..3 {
        power(applicability, padding, n, &mut weights[n * taps..][..taps]);
    }
    for n in 3..5 {
        for k in 0..taps {
            weights[n * taps + k] = weights[(n - 1) * taps + k] * (k as f32 - radius as f32);
        }
    }
}

fn reference(p: &Params, weighted: &[f32], certainty: &[f32], applicability: &[f32], moments: &mut [f32]) {
    let (_, height, stride) = dimensions(p.width, p.height);
    let radius = p.radius as usize;
    let taps = 2 * radius + 1;
    let split = Split { scratch: 5 * taps, ..Split::rows_of(CHANNELS * stride) };
    bands(
        moments,
        &mut [],
        split,
        #[inline(always)]
        |band| {
            powers(applicability, 0, radius, band.scratch);
            for (channel, (picture, power)) in
                [certainty; 5].into_iter().zip(0..).chain([weighted; 3].into_iter().zip(0..)).enumerate()
            {
                let weights = &band.scratch[power * taps..][..taps];
                for (i, rows) in band.out.chunks_exact_mut(CHANNELS * stride).enumerate() {
                    let y = band.y0 + i;
                    let inside = match p.outside > 0.0 {
                        true => 0..taps,
                        false => radius.saturating_sub(y)..taps.min(height + radius - y),
                    };
                    let first = (y + inside.start) as isize - radius as isize;
                    weighted_sum(&mut rows[channel * stride..][..stride], &weights[inside], |k| {
                        &picture[clamp_index(first + k as isize, height) * stride..][..stride]
                    });
                }
            }
        },
    );
}

fn cases(size: Size) -> Vec<Case> {
    let all = [("repeated", 1.0), ("left out", 0.0)].map(|(name, outside)| {
        let params = Params { width: size.width, height: size.height, radius: 5, outside };
        let rows = [CHANNELS * size.stride()];
        let cases = each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &rows, size, |fill| {
            let [weighted, certainty] = masked(size, fill);
            vec![weighted, certainty, tables::applicability_from(&tables::applicability(5, 1.2).weights, 5)]
        });
        cases.into_iter().map(move |case| Case { name: format!("{}, border {name}", case.name), ..case })
    });
    all.into_iter().flatten().collect()
}

/// An image times its certainty, and that certainty, of which a quarter of the image has none.
pub(super) fn masked(size: Size, fill: Fill) -> [Vec<f32>; 2] {
    let mut weighted = planes(size, 1, fill, [0.0, 255.0], 3);
    let mut certainty = planes(size, 1, fill, [0.0, 1.0], 4);
    let (width, height, stride) = dimensions(size.width, size.height);
    for (i, (f, c)) in weighted.iter_mut().zip(&mut certainty).enumerate() {
        if i % stride > width / 2 && i / stride > height / 2 {
            *c = 0.0;
        }
        *f *= *c;
    }
    [weighted, certainty]
}
