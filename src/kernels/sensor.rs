//! The camera sensor: adds noise to gray levels and rounds them to whole numbers from 0 to 255.
//!
//! The noise is the sum of four uniform numbers (Irwin and Hall), within 3.5 standard deviations, from a hash of the
//! pixel and the frame's seed: independent of the order of computation.

use super::hash::scrambled;
use super::parallel_rows::{Split, bands, dimensions, repeat_last};
use super::test_inputs::{Fill, cases as each_fill, planes};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the image, and the noise.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// Gray levels of a step of the sum of four 16-bit numbers: see [`noise_step`].
        noise: f32,
    }
}

kernel!(
    "sensor" + ["hash"],
    reference(Params; gray, seed) -> (picture),
    cases: cases,
    tolerance: Tolerance {
        absolute: 0.0, relative: 0.0, of_largest: 0.0,
        reason: "whole numbers; no level of the cases lies within 1/500 of where rounding changes",
    },
);

/// The step of the noise for a standard deviation in gray levels: of four numbers of 65536 steps each, whose variances
/// are (65536² − 1) / 12.
pub fn noise_step(deviation_levels: f64) -> f32 {
    (deviation_levels / ((65536.0_f64.powi(2) - 1.0) / 3.0).sqrt()) as f32
}

/// The two words of the `seed` buffer.
pub fn seed_words(seed: u64) -> [f32; 2] {
    [seed as u32, (seed >> 32) as u32].map(f32::from_bits)
}

fn reference(p: &Params, gray: &[f32], seed: &[f32], picture: &mut [f32]) {
    let (width, _, stride) = dimensions(p.width, p.height);
    let seed = [seed[0].to_bits(), seed[1].to_bits()];
    let noise = p.noise;
    bands(
        picture,
        &mut [],
        Split::rows_of(stride),
        #[inline(always)]
        |band| {
            for (i, row) in band.out.chunks_exact_mut(stride).enumerate() {
                let y = band.y0 + i;
                let levels = &gray[y * stride..][..width];
                for (x, (out, level)) in row[..width].iter_mut().zip(levels).enumerate() {
                    let level = level + noise * deviate(seed, (y * width + x) as u32);
                    *out = (level + 0.5).floor().clamp(0.0, 255.0);
                }
                repeat_last(row, width);
            }
        },
    );
}

/// The noise of a pixel, in steps.
#[inline(always)]
fn deviate([low, high]: [u32; 2], pixel: u32) -> f32 {
    let one = scrambled(low ^ scrambled(high ^ scrambled(pixel)));
    let other = scrambled(one ^ 0x9e37_79b9);
    let sum = (one >> 16) + (one & 0xffff) + (other >> 16) + (other & 0xffff);
    (sum as i32 - 131_070) as f32
}

fn cases(size: Size) -> Vec<Case> {
    let seed = 0x0123_4567_89ab_cdef;
    let params = Params { width: size.width, height: size.height, noise: noise_step(2.0) };
    each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &[size.stride()], size, |fill| {
        let mut gray = planes(size, 1, fill, [-3.0, 258.0], 9);
        let words = seed_words(seed);
        for (y, row) in gray.chunks_exact_mut(size.stride()).enumerate() {
            for (x, level) in row[..size.width as usize].iter_mut().enumerate() {
                let pixel = (y * size.width as usize + x) as u32;
                let noise = params.noise * deviate(words.map(f32::to_bits), pixel);
                // Off the half-levels.
                if ((*level + noise).rem_euclid(1.0) - 0.5).abs() < 0.002 {
                    *level += 0.01;
                }
            }
            repeat_last(row, size.width as usize);
        }
        vec![gray, words.to_vec()]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_has_its_mean_deviation_and_no_pattern() {
        let (step, count) = (f64::from(noise_step(2.0)), 400_000);
        let values: Vec<f64> = (0..count).map(|i| step * f64::from(deviate([7, 9], i))).collect();
        let mean_of = |terms: &mut dyn Iterator<Item = f64>| terms.sum::<f64>() / f64::from(count);
        let mean = mean_of(&mut values.iter().copied());
        let variance = mean_of(&mut values.iter().map(|v| v * v));
        // Three standard errors: 2 / √400 000, and 4 · √(1.7 / 400 000) for this distribution.
        assert!(mean.abs() < 0.0095, "{mean}");
        assert!((variance - 4.0).abs() < 0.025, "{variance}");
        for lag in [1, 2, 320, 321] {
            let correlation = mean_of(&mut values.iter().zip(&values[lag..]).map(|(a, b)| a * b)) / 4.0;
            assert!(correlation.abs() < 0.005, "{lag}: {correlation}");
        }
        let other: Vec<f64> = (0..count).map(|i| step * f64::from(deviate([8, 9], i))).collect();
        let correlation = mean_of(&mut values.iter().zip(&other).map(|(a, b)| a * b)) / 4.0;
        assert!(correlation.abs() < 0.005, "{correlation}");
    }

    #[test]
    fn no_case_lies_where_rounding_changes() {
        for case in [Size::new(65, 33), Size::new(641, 363)].into_iter().flat_map(cases) {
            let params: Params = bytemuck::pod_read_unaligned(&case.params);
            let (width, _, stride) = dimensions(params.width, params.height);
            let seed = [case.inputs[1][0].to_bits(), case.inputs[1][1].to_bits()];
            for (y, row) in case.inputs[0].chunks_exact(stride).enumerate() {
                for (x, level) in row[..width].iter().enumerate() {
                    let level = level + params.noise * deviate(seed, (y * width + x) as u32);
                    assert!((level.rem_euclid(1.0) - 0.5).abs() > 0.0019, "{}: {level}", case.name);
                }
            }
        }
    }
}
