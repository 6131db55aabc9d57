//! The structure tensor of each pixel: its gradient g times its transpose, g gᵀ. The gradient is Sobel's of 3 × 3 pixels,
//! mirrored at the border, times a scale.

use super::parallel_rows::{Split, bands, dimensions, reflect_101, repeat_last};
use super::test_inputs::{Fill, gray_cases};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the image, and the scale of gradients.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// The factor of Sobel's sums.
        scale: f32,
    }
}

kernel!(
    "structure_tensor" + ["image"],
    reference(Params; gray) -> (tensor),
    cases: cases,
    tolerance: Tolerance {
        absolute: 0.0,
        relative: 0.0, of_largest: 1e-6,
        reason: "products of two differences that may cancel: some ten roundings of the square of the largest, which the \
                 scale brings to the order of 1",
    },
);

fn reference(p: &Params, gray: &[f32], tensor: &mut [f32]) {
    let (width, height, stride) = dimensions(p.width, p.height);
    let row = |y: isize| &gray[reflect_101(y, height) * stride..][..stride];
    let split = Split { scratch: 2 * (width + 2), dearer: 2, ..Split::rows_of(3 * stride) };
    bands(tensor, &mut [], split, #[inline(always)] |band| {
        let (smooth, down) = band.scratch.split_at_mut(width + 2);
        for (i, out) in band.out.chunks_exact_mut(3 * stride).enumerate() {
            let y = (band.y0 + i) as isize;
            let (above, here, below) = (row(y - 1), row(y), row(y + 1));
            // Sums along the columns of the row, one pixel further on both sides.
            for x in 0..width {
                smooth[x + 1] = above[x] + 2.0 * here[x] + below[x];
                down[x + 1] = below[x] - above[x];
            }
            for sums in [&mut *smooth, &mut *down] {
                sums[0] = sums[1 + reflect_101(-1, width)];
                sums[width + 1] = sums[1 + reflect_101(width as isize, width)];
            }
            let (xx, rest) = out.split_at_mut(stride);
            let (xy, yy) = rest.split_at_mut(stride);
            for x in 0..width {
                let g_x = p.scale * (smooth[x + 2] - smooth[x]);
                let g_y = p.scale * (down[x] + 2.0 * down[x + 1] + down[x + 2]);
                (xx[x], xy[x], yy[x]) = (g_x * g_x, g_x * g_y, g_y * g_y);
            }
            [xx, xy, yy].into_iter().for_each(|row| repeat_last(row, width));
        }
    });
}

fn cases(size: Size) -> Vec<Case> {
    let params = Params { width: size.width, height: size.height, scale: 1.0 / (4.0 * 65535.0) };
    gray_cases(size, Fill::NUMBERS, bytemuck::bytes_of(&params), &[], &[3 * size.stride()], size)
}
