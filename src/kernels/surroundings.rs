//! The geometric mean of a plane and of what is around each of its pixels, which [`super::block_mean`] gives for blocks:
//! between the blocks' centres it is read bilinearly.
//!
//! Both are means of values from 0 to 1, and so is the result.

use super::block_mean::{RING, blocks_of};
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
    "surroundings" + [],
    reference(Params; near, blocks) -> (mean),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-15,
        relative: 1e-5,
        of_largest: 0.0,
        reason: "two linear mixes with exact fractions of values that are not negative, a product, and a root, which GPUs round \
                 to some units",
    },
);

fn reference(p: &Params, near: &[f32], blocks: &[f32], mean: &mut [f32]) {
    let (width, _, stride) = dimensions(p.width, p.height);
    let in_stride = blocks_of(Size::new(p.width, p.height)).stride();
    let split = Split { scratch: in_stride, dearer: 2, ..Split::rows_of(stride) };
    bands(mean, &mut [], split, #[inline(always)] |band| {
        for (i, out) in band.out.chunks_exact_mut(stride).enumerate() {
            let y = band.y0 + i;
            let (above, fraction) = place(y);
            let (above, below) = blocks[above * in_stride..][..2 * in_stride].split_at(in_stride);
            for ((mixed, above), below) in band.scratch.iter_mut().zip(above).zip(below) {
                *mixed = (1.0 - fraction) * above + fraction * below;
            }
            let near = &near[y * stride..][..width];
            for x in 0..width {
                let (left, fraction) = place(x);
                let around = (1.0 - fraction) * band.scratch[left] + fraction * band.scratch[left + 1];
                out[x] = (near[x] * around).sqrt();
            }
            repeat_last(out, width);
        }
    });
}

/// The block whose centre is at or before a pixel, and how far the pixel is on the way to the next.
#[inline(always)]
fn place(pixel: usize) -> (usize, f32) {
    // In eighths of a block, of which a pixel has two: the centre of the first block within the ring is pixel 1.5.
    let eighths = 2 * pixel + 8 * RING - 3;
    (eighths / 8, (eighths % 8) as f32 / 8.0)
}

fn cases(size: Size) -> Vec<Case> {
    let params = Params { width: size.width, height: size.height };
    each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &[size.stride()], size, |fill| {
        vec![planes(size, 1, fill, [0.0, 1.0], 1), planes(blocks_of(size), 1, fill, [0.0, 1.0], 2)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_lies_between_the_blocks_around_it() {
        // The first block within the ring has the pixels 0 to 3, so its centre is at 1.5.
        assert_eq!(place(0), (RING - 1, 0.625));
        assert_eq!(place(1), (RING - 1, 0.875));
        assert_eq!(place(2), (RING, 0.125));
        assert_eq!(place(5), (RING, 0.875));
        assert_eq!(place(6), (RING + 1, 0.125));
    }
}
