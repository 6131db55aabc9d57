//! The mean of a plane over each block of 4 × 4 pixels, and around these blocks a ring of zeros, four wide: what is outside
//! the image counts as nothing in an average over what follows.
//!
//! Where the image ends within a block its last pixel is repeated. The block at (i, j) of the result has the pixels from
//! (4 i − 16, 4 j − 16) on.

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
    "block_mean" + [],
    reference(Params; plane) -> (blocks),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-30,
        relative: 4e-6,
        of_largest: 0.0,
        reason: "a sum of sixteen values that are not negative: a rounding each, fused or not",
    },
);

/// Pixels of a block's side.
const SIDE: usize = 4;
/// Blocks of zeros before the first block and after the last, along both axes.
pub(super) const RING: usize = 4;

/// The size of the result: the blocks, and the ring around them.
pub fn blocks_of(size: Size) -> Size {
    let count = |pixels: u32| pixels.div_ceil(SIDE as u32) + 2 * RING as u32;
    Size::new(count(size.width), count(size.height))
}

fn reference(p: &Params, plane: &[f32], blocks: &mut [f32]) {
    let (width, height, stride) = dimensions(p.width, p.height);
    let all = blocks_of(Size::new(p.width, p.height));
    let (columns, rows) = (all.width as usize, all.height as usize);
    let out_stride = all.stride();
    bands(blocks, &mut [], Split { dearer: 8, ..Split::rows_of(out_stride) }, #[inline(always)] |band| {
        for (i, out) in band.out.chunks_exact_mut(out_stride).enumerate() {
            out.fill(0.0);
            let j = band.y0 + i;
            if j < RING || j + RING >= rows {
                continue;
            }
            let line = |k: usize| &plane[(SIDE * (j - RING) + k).min(height - 1) * stride..][..width];
            let lines = [0, 1, 2, 3].map(line);
            for column in RING..columns - RING {
                let mut sum = 0.0;
                for line in lines {
                    for k in 0..SIDE {
                        sum += line[(SIDE * (column - RING) + k).min(width - 1)];
                    }
                }
                out[column] = sum * (1.0 / (SIDE * SIDE) as f32);
            }
            repeat_last(out, columns);
        }
    });
}

fn cases(size: Size) -> Vec<Case> {
    let params = Params { width: size.width, height: size.height };
    let all = blocks_of(size);
    each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &[all.stride()], all, |fill| {
        vec![planes(size, 1, fill, [0.0, 1.0], 1)]
    })
}
