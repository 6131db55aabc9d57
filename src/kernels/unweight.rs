//! Divides an image that was smoothed together with its certainty by that certainty: the smoothed image of the known
//! pixels, and 0 where next to none is known (Knutsson and Westin, Normalized and differential convolution, CVPR 1993).

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

/// Below this certainty a pixel is unknown.
const LEAST: f32 = 1e-3;

kernel!(
    "unweight" + [],
    reference(Params; weighted, certainty) -> (gray),
    cases: cases,
    tolerance: Tolerance { absolute: 1e-30, relative: 1e-6, of_largest: 0.0, reason: "a division, which GPUs round to 2.5 units" },
);

fn reference(p: &Params, weighted: &[f32], certainty: &[f32], gray: &mut [f32]) {
    let (width, _, stride) = dimensions(p.width, p.height);
    bands(gray, &mut [], Split::rows_of(stride), #[inline(always)] |band| {
        for (i, out) in band.out.chunks_exact_mut(stride).enumerate() {
            let row = (band.y0 + i) * stride;
            for (x, out) in out[..width].iter_mut().enumerate() {
                let share = certainty[row + x];
                *out = if share >= LEAST { weighted[row + x] / share } else { 0.0 };
            }
            repeat_last(out, width);
        }
    });
}

fn cases(size: Size) -> Vec<Case> {
    let params = Params { width: size.width, height: size.height };
    each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &[size.stride()], size, |fill| {
        vec![planes(size, 1, fill, [0.0, 255.0], 1), planes(size, 1, fill, [0.0, 1.0], 2)]
    })
}
