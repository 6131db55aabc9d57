//! Smooths an image by `[1 2 1]/4` in both directions, mirrored at the border: the finest level of the pyramid.

use super::parallel_rows::{Split, bands, dimensions, reflect_101, repeat_last};
use super::test_inputs::{Fill, gray_cases};
use crate::frame::Size;
use crate::kernel::{Tolerance, kernel, params};

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
    "binomial" + ["image"],
    reference(Params; gray) -> (smooth_gray),
    cases: |size| gray_cases(size, Fill::ALL, bytemuck::bytes_of(&Params::new(size)), &[], &[size.stride()], size),
    tolerance: Tolerance {
        absolute: 0.0,
        relative: 4.0 * f32::EPSILON, of_largest: 0.0,
        reason: "eight additions of positive numbers in another order; whole numbers below 2²⁰ are exact",
    },
);

impl Params {
    /// The parameters for an image of this size.
    pub fn new(size: Size) -> Self {
        Self { width: size.width, height: size.height }
    }
}

fn reference(p: &Params, gray: &[f32], smooth_gray: &mut [f32]) {
    let (width, height, stride) = dimensions(p.width, p.height);
    let row = |y: isize| &gray[reflect_101(y, height) * stride..][..stride];
    let split = Split { scratch: width + 2, ..Split::rows_of(stride) };
    bands(smooth_gray, &mut [], split, #[inline(always)] |band| {
        for (i, out) in band.out.chunks_exact_mut(stride).enumerate() {
            let y = (band.y0 + i) as isize;
            let (above, here, below) = (row(y - 1), row(y), row(y + 1));
            let sums = &mut *band.scratch;
            for x in 0..width {
                sums[x + 1] = above[x] + 2.0 * here[x] + below[x];
            }
            sums[0] = sums[1 + reflect_101(-1, width)];
            sums[width + 1] = sums[1 + reflect_101(width as isize, width)];
            for x in 0..width {
                out[x] = (sums[x] + 2.0 * sums[x + 1] + sums[x + 2]) * 0.0625;
            }
            repeat_last(out, width);
        }
    });
}
