//! Samples the second image by cubic interpolation where the flow so far points, and compares it with the first.
//!
//! Cubic convolution with a = −½ (Keys, Cubic convolution interpolation for digital image processing, IEEE Trans. ASSP
//! 1981), the border repeated. Outputs: the mean of both images, their difference (the second less the first), and the
//! share that both show: the product of their certainties, the second's sampled bilinearly, and 0 outside the second
//! image, where the mean is the first image alone and the difference 0.

use super::parallel_rows::{Split, bands_of_three, dimensions, repeat_last};
use super::test_inputs::{Fill, cases as each_fill, planes};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the images.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
    }
}

kernel!(
    "cubic_warp" + [],
    reference(Params; first, certainty_0, second, certainty_1, flow) -> (mean, change, share),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-6,
        relative: 0.0,
        of_largest: 3e-4,
        reason: "a place's fraction has 2⁻¹⁴ px at 641, once along each axis, times the slope of the interpolation, which is \
                 up to 2.4 times the step between two pixels; and some roundings of the largest",
    },
);

#[allow(clippy::too_many_arguments, reason = "they are the kernel's buffers")]
fn reference(
    p: &Params,
    first: &[f32],
    certainty_0: &[f32],
    second: &[f32],
    certainty_1: &[f32],
    flow: &[f32],
    mean: &mut [f32],
    change: &mut [f32],
    share: &mut [f32],
) {
    let (width, height, stride) = dimensions(p.width, p.height);
    let split = Split { second_row: stride, third_row: stride, dearer: 24, ..Split::rows_of(stride) };
    bands_of_three([mean, change, share], split, #[inline(always)] |band| {
        let rows = band.out.chunks_exact_mut(stride).zip(band.second.chunks_exact_mut(stride));
        for (i, ((mean, change), share)) in rows.zip(band.third.chunks_exact_mut(stride)).enumerate() {
            let y = band.y0 + i;
            let (u, v) = flow[2 * y * stride..][..2 * stride].split_at(stride);
            let (first, certainty) = (&first[y * stride..][..stride], &certainty_0[y * stride..][..stride]);
            for x in 0..width {
                let (at_x, at_y) = (x as f32 + u[x], y as f32 + v[x]);
                let inside = at_x >= 0.0
                    && at_y >= 0.0
                    && at_x <= (width - 1) as f32
                    && at_y <= (height - 1) as f32;
                let [gray, shown] = match inside {
                    true => between(second, certainty_1, [at_x, at_y], [width, height, stride]),
                    false => [first[x], 0.0],
                };
                mean[x] = 0.5 * (first[x] + gray);
                change[x] = gray - first[x];
                share[x] = certainty[x] * shown;
            }
            for row in [mean, change, share] {
                repeat_last(row, width);
            }
        }
    });
}

/// The gray level and the certainty at a place inside the image.
#[inline(always)]
fn between(
    second: &[f32],
    certainty: &[f32],
    [at_x, at_y]: [f32; 2],
    [width, height, stride]: [usize; 3],
) -> [f32; 2] {
    let (left, above) = (at_x as usize, at_y as usize);
    let (f_x, f_y) = (at_x - left as f32, at_y - above as f32);
    let columns = [left.saturating_sub(1), left, (left + 1).min(width - 1), (left + 2).min(width - 1)];
    let rows = [above.saturating_sub(1), above, (above + 1).min(height - 1), (above + 2).min(height - 1)];
    let weights = cubic(f_x);
    let mut gray = 0.0;
    for (y, weight) in rows.into_iter().zip(cubic(f_y)) {
        let row = &second[y * stride..][..stride];
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| weights[i] * row[columns[i]]);
        gray += weight * (a + b + c + d);
    }
    let [above, below] = [rows[1], rows[2]].map(|y| {
        let row = &certainty[y * stride..][..stride];
        (1.0 - f_x) * row[columns[1]] + f_x * row[columns[2]]
    });
    [gray, (1.0 - f_y) * above + f_y * below]
}

/// The weights of the four neighbours of a place that lies this far behind the second one.
#[inline(always)]
fn cubic(f: f32) -> [f32; 4] {
    [
        f * (f * (1.0 - 0.5 * f) - 0.5),
        f * f * (1.5 * f - 2.5) + 1.0,
        f * (f * (2.0 - 1.5 * f) + 0.5),
        f * f * (0.5 * f - 0.5),
    ]
}

fn cases(size: Size) -> Vec<Case> {
    let params = Params { width: size.width, height: size.height };
    let rows = [size.stride(); 3];
    each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &rows, size, |fill| {
        // Flows of 0 keep whole places, where a wrong border shows; a flow of 10¹² is far outside.
        let flow = if fill == Fill::Extreme { [0.0, 1e12] } else { [-6.0, 6.0] };
        vec![
            planes(size, 1, fill, [0.0, 255.0], 1),
            planes(size, 1, Fill::Textured, [0.0, 1.0], 2),
            planes(size, 1, fill, [0.0, 255.0], 3),
            planes(size, 1, Fill::Textured, [0.0, 1.0], 4),
            planes(size, 2, fill, flow, 5),
        ]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cubic convolution with a = −½ reproduces polynomials of second degree.
    #[test]
    fn weights_reproduce_parabolas() {
        for f in [0.0, 0.25, 0.5, 0.8] {
            let moment = |n: i32| -> f32 { cubic(f).iter().zip(-1..).map(|(w, x)| w * (x as f32).powi(n)).sum() };
            for (n, expected) in [(0, 1.0), (1, f), (2, f * f)] {
                // Four products of a few units: some roundings of 2⁻²⁴ each.
                assert!((moment(n) - expected).abs() <= 1e-6, "{f}, {n}: {}", moment(n));
            }
        }
    }
}
