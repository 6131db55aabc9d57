//! An infinite texture, band-limited for the viewing distance.
//!
//! It sums octaves of random values on grids, smoothed by a cubic B-spline. The spectrum of such an octave has its
//! first zero at a wavelength of one grid spacing and next to nothing beyond, so that an octave with a spacing of two
//! pixels is free of aliasing; finer ones fade out by the size of a pixel on the surface.

use crate::kernels::hash::scrambled;

/// Base-2 logarithm of the coarsest octave's grid spacing, 4 m. The finest is 2^10 times finer, 3.9 mm.
const COARSEST_LOG2_M: i32 = 2;
const OCTAVES: i32 = 11;
/// Amplitude of an octave in gray levels. All visible ones sum to a standard deviation of 30 to 45 levels.
const AMPLITUDE: f64 = 50.0;
/// An octave is fully visible from this many halvings of its spacing above a pixel's footprint, and invisible one
/// below.
const FULL_LOG2: f64 = 1.5;

/// The gray level of a texture at a point where a pixel covers `footprint_m`, given by its base-2 logarithm.
///
/// With a period, the texture repeats seamlessly along u.
pub(super) fn gray(uv_m: [f64; 2], period_m: Option<f64>, seed: u32, footprint_log2_m: f64) -> f64 {
    let mut sum = 128.0;
    for octave in 0..OCTAVES {
        let spacing_log2_m = COARSEST_LOG2_M - octave;
        let above = f64::from(spacing_log2_m) - footprint_log2_m - FULL_LOG2 + 1.0;
        let share = above.clamp(0.0, 1.0);
        if !(share > 0.0) {
            break;
        }
        let weight = share * share * (3.0 - 2.0 * share);
        sum += AMPLITUDE
            * weight
            * noise(uv_m, period_m, 2.0_f64.powi(spacing_log2_m), scrambled(seed ^ scrambled(octave as u32)));
    }
    sum
}

fn noise([u, v]: [f64; 2], period_m: Option<f64>, spacing_m: f64, seed: u32) -> f64 {
    // A whole number of grid points per period.
    let points = period_m.map(|period| (period / spacing_m).round().max(1.0));
    let column_at = match (points, period_m) {
        (Some(points), Some(period)) => u / period * points,
        _ => u / spacing_m,
    };
    let (column, column_weights) = spline(column_at);
    let (row, row_weights) = spline(v / spacing_m);
    let columns: [u32; 4] = std::array::from_fn(|i| {
        let column = column - 1 + i as i64;
        points.map_or(column, |points| column.rem_euclid(points as i64)) as u32
    });
    let mut sum = 0.0;
    for (j, row_weight) in row_weights.into_iter().enumerate() {
        let seed = scrambled(seed ^ (row - 1 + j as i64) as u32);
        let values = columns.map(|column| f64::from(scrambled(seed ^ column)));
        sum +=
            row_weight * column_weights.iter().zip(values).map(|(weight, value)| weight * value).sum::<f64>();
    }
    // The weights sum to 1: map 0 to u32::MAX to −1 to 1 in one step.
    sum / f64::from(u32::MAX) * 2.0 - 1.0
}

/// The grid point at or before a position, and the weights of the four around it.
fn spline(at: f64) -> (i64, [f64; 4]) {
    let before = at.floor();
    let t = at - before;
    let s = 1.0 - t;
    let weights = [s * s * s, (3.0 * t - 6.0) * t * t + 4.0, (3.0 * s - 6.0) * s * s + 4.0, t * t * t];
    (before as i64, weights.map(|weight| weight / 6.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn deviation(values: &[f64]) -> f64 {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
    }

    #[test]
    fn there_is_contrast_near_and_far_and_none_beyond() {
        for (footprint_m, range) in
            [(1e-3, 35.0..55.0), (0.03, 25.0..45.0), (0.3, 15.0..35.0), (10.0, 0.0..1e-9)]
        {
            let step = 7.3 * f64::max(footprint_m, 0.1);
            let places = (0..4000).map(|i| [f64::from(i % 63) * step, f64::from(i / 63) * step]);
            let values: Vec<f64> = places.map(|uv| gray(uv, None, 3, f64::log2(footprint_m))).collect();
            assert!(range.contains(&deviation(&values)), "{footprint_m} m: {}", deviation(&values));
        }
    }

    #[test]
    fn a_period_is_met_without_a_seam() {
        let period = 2.3;
        for i in 0..200 {
            let v = 0.013 * f64::from(i);
            let at = |u: f64| gray([u, v], Some(period), 1, -8.0);
            assert!((at(-period / 2.0) - at(period / 2.0)).abs() < 1e-6);
            assert!((at(-period / 2.0 + 1e-7) - at(period / 2.0 - 1e-7)).abs() < 0.02);
        }
    }

    #[test]
    fn seeds_differ_and_fade_is_smooth() {
        assert!((gray([0.3, 0.4], None, 1, -7.0) - gray([0.3, 0.4], None, 2, -7.0)).abs() > 1e-3);
        for i in 0..1000 {
            let log2 = -9.0 + 0.01 * f64::from(i);
            let [a, b] = [log2, log2 + 1e-6].map(|log2| gray([12.3, -4.56], None, 9, log2));
            assert!((a - b).abs() < 1e-3, "{log2}");
        }
    }
}
