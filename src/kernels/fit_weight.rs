//! The weight of each pixel's flow for its neighbours: high where the two frames agree under it.
//!
//! With m the squared misfit averaged over 3 × 3 pixels by the binomial [1 2 1]/4 along both axes, it is exp(−m / (2 σ²)) +
//! 10⁻³, where σ = 0.35 px.

use super::parallel_rows::{Split, bands, dimensions, repeat_last};
use super::test_inputs::{Fill, cases as each_fill, planes};
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
    "fit_weight" + ["exponential"],
    reference(Params; squared_misfit) -> (weight),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-6,
        relative: 4e-5,
        of_largest: 0.0,
        reason: "an exponent down to −53 has roundings of 4·10⁻⁶, and a mean of nine values some more",
    },
);

/// −log₂ e / (2 σ²), so that 2 to the power of it times m is exp(−m / (2 σ²)).
const EXPONENT: f32 = -5.888_551_6;
/// The weight of a pixel without any agreement.
const LEAST: f32 = 1e-3;

fn reference(p: &Params, squared_misfit: &[f32], weight: &mut [f32]) {
    let (width, height, stride) = dimensions(p.width, p.height);
    let split = Split { scratch: stride, dearer: 2, ..Split::rows_of(stride) };
    bands(weight, &mut [], split, #[inline(always)] |band| {
        for (i, out) in band.out.chunks_exact_mut(stride).enumerate() {
            let y = band.y0 + i;
            let row = |y: usize| &squared_misfit[y * stride..][..stride];
            let (above, here, below) = (row(y.saturating_sub(1)), row(y), row((y + 1).min(height - 1)));
            for x in 0..width {
                band.scratch[x] = 0.25 * above[x] + 0.5 * here[x] + 0.25 * below[x];
            }
            let mean = &band.scratch[..width];
            for x in 0..width {
                let (before, next) = (mean[x.saturating_sub(1)], mean[(x + 1).min(width - 1)]);
                let m = 0.25 * before + 0.5 * mean[x] + 0.25 * next;
                out[x] = power_of_two(EXPONENT * m) + LEAST;
            }
            repeat_last(out, width);
        }
    });
}

/// 2 to the power of x, for x from −126 to 0, within 3·10⁻⁷ of it: the same on every processor.
#[inline(always)]
pub(super) fn power_of_two(x: f32) -> f32 {
    let x = x.max(-126.0);
    let whole = x.floor();
    let f = x - whole;
    // 2^f for f from 0 to 1, by the polynomial of least relative error.
    let p = 0.055_485_28 + f * (0.009_675_456 + f * (0.001_246_780_1 + f * 0.000_216_130_9));
    let p = 1.0 + f * (0.693_147_04 + f * (0.240_229_3 + f * p));
    p * f32::from_bits(((whole as i32 + 127) as u32) << 23)
}

fn cases(size: Size) -> Vec<Case> {
    let params = Params { width: size.width, height: size.height };
    each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &[size.stride()], size, |fill| {
        vec![planes(size, 1, fill, [0.0, 9.0], 1)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_two_are_exact_to_some_units_in_the_last_place() {
        for i in 0..=53_000 {
            let x = -f64::from(i) / 1000.0;
            let found = f64::from(power_of_two(x as f32));
            let expected = f64::from(x as f32).exp2();
            assert!((found / expected - 1.0).abs() < 4e-7, "{x}: {found} {expected}");
        }
        assert_eq!(power_of_two(0.0), 1.0);
    }
}
