//! Each pixel's equations for the increment of its displacement from the constancy of brightness.
//!
//! Horn and Schunck, Determining optical flow, Artificial Intelligence 17, 1981: I_x δu + I_y δv + I_t = 0, in gray levels
//! per frame. The slopes I_x and I_y are those of the mean of both images, by differences over five pixels that are exact
//! for polynomials of fourth degree (and nearer the border by differences of the next pixels); I_t is the difference of the
//! second image, sampled where the flow so far points, and the first. With the weight w that is G = w ∇I ∇Iᵀ and
//! q = −w I_t ∇I. The weight is the least share that both images show of the pixels in question, divided by
//! √(1 + I_t² / ε²), the robust function of Charbonnier, Blanc-Féraud, Aubert and Barlaud (IEEE Trans. Image Processing
//! 1997), if one is wanted.

use super::parallel_rows::{Split, bands, clamp_index, dimensions, extend_row, repeat_last};
use super::test_inputs::{Fill, cases as each_fill, planes};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the images, and the weights' form.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// 1 / ε²: the inverse square of the difference, in gray levels, up to which the weight is nearly constant; 0 for
        /// constant weights.
        robust: f32,
        /// γ: what is added to G_xx and G_yy, which draws the increment towards 0, in squared gray levels per pixel.
        prior: f32,
    }
}

kernel!(
    "brightness_equations" + [],
    reference(Params; mean, change, share) -> (equations),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-5,
        relative: 1e-5,
        // The largest is a product of differences, so the largest square of a gray level is its measure.
        of_largest: 1e-5,
        reason: "products of differences that may cancel: some ten roundings of the square of the largest gray level",
    },
);

/// How far the slopes' differences reach, in pixels.
const RADIUS: usize = 2;

fn reference(p: &Params, mean: &[f32], change: &[f32], share: &[f32], equations: &mut [f32]) {
    let (width, height, stride) = dimensions(p.width, p.height);
    let extended = width + 2 * RADIUS;
    let split = Split { scratch: 2 * extended, dearer: 2, ..Split::rows_of(5 * stride) };
    bands(equations, &mut [], split, #[inline(always)] |band| {
        let (gray, shown) = band.scratch.split_at_mut(extended);
        for (i, channels) in band.out.chunks_exact_mut(5 * stride).enumerate() {
            let y = band.y0 + i;
            let rows = [-2, -1, 0, 1, 2].map(|step| clamp_index(y as isize + step, height) * stride);
            let [grays, shares] = [mean, share].map(|image| rows.map(|row| &image[row..][..width]));
            extend_row(gray, grays[RADIUS], width, RADIUS);
            extend_row(&mut shown[..extended], shares[RADIUS], width, RADIUS);
            let change = &change[y * stride..][..width];
            for x in 0..width {
                let [a, b, _, c, d] = [0, 1, 2, 3, 4].map(|step| gray[x + step]);
                let i_x = slope([a, b, c, d], x, width);
                let [a, b, _, c, d] = grays.map(|row| row[x]);
                let i_y = slope([a, b, c, d], y, height);
                let least = |values: [f32; 5]| values.into_iter().fold(f32::INFINITY, f32::min);
                let known = least([0, 1, 2, 3, 4].map(|step| shown[x + step])).min(least(shares.map(|row| row[x])));
                let i_t = change[x];
                let w = known / (1.0 + i_t * i_t * p.robust).sqrt();
                let (w_x, w_y) = (w * i_x, w * i_y);
                let values = [w_x * i_x + p.prior, w_x * i_y, w_y * i_y + p.prior, -w_x * i_t, -w_y * i_t];
                for (channel, value) in values.into_iter().enumerate() {
                    channels[channel * stride + x] = value;
                }
            }
            channels.chunks_exact_mut(stride).for_each(|row| repeat_last(row, width));
        }
    });
}

/// The slope at position `i` of a row of `n` pixels from the two pixels before it and the two behind it, the ends repeated.
#[inline(always)]
fn slope([far_before, before, after, far_after]: [f32; 4], i: usize, n: usize) -> f32 {
    let inner = (8.0 * (after - before) - (far_after - far_before)) * (1.0 / 12.0);
    let distance = (i + 1).min(n - 1) - i.saturating_sub(1);
    let edge = (after - before) * if distance > 1 { 0.5 } else { 1.0 };
    if i >= RADIUS && i + RADIUS < n { inner } else { edge }
}

fn cases(size: Size) -> Vec<Case> {
    let all = [("plain", 0.0, 0.0), ("robust", 4.0, 0.0), ("prior", 0.0, 64.0)].map(|(name, robust, prior)| {
        let params = Params { width: size.width, height: size.height, robust, prior };
        let cases = each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &[5 * size.stride()], size, |fill| {
            // Differences of a few gray levels are those whose robust weight varies.
            vec![
                planes(size, 1, fill, [0.0, 255.0], 1),
                planes(size, 1, fill, [-3.0, 3.0], 2),
                planes(size, 1, Fill::Textured, [0.0, 1.0], 3),
            ]
        });
        cases.into_iter().map(move |case| Case { name: format!("{}, {name}", case.name), ..case })
    });
    all.into_iter().flatten().collect()
}
