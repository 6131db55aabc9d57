//! Sums the columns of the structure tensor's three channels over a block's height, mirrored at the border. A block of
//! an even height begins one row further up, as OpenCV's `boxFilter` does.

use super::parallel_rows::{Split, bands, dimensions, reflect_101};
use super::test_inputs::{Fill, cases as each_fill, planes};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the image and of the block.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// Rows of the block, 1 to 64.
        block: u32,
    }
}

kernel!(
    "block_sum" + ["image"],
    reference(Params; tensor) -> (columns),
    cases: cases,
    tolerance: Tolerance {
        absolute: 0.0,
        relative: 0.0, of_largest: 0.0,
        reason: "additions in the same order",
    },
);

fn reference(p: &Params, tensor: &[f32], columns: &mut [f32]) {
    let (_, height, stride) = dimensions(p.width, p.height);
    let row = 3 * stride;
    let half = (p.block / 2) as isize;
    bands(columns, &mut [], Split { dearer: 2, ..Split::rows_of(row) }, #[inline(always)] |band| {
        for (i, out) in band.out.chunks_exact_mut(row).enumerate() {
            let first = (band.y0 + i) as isize - half;
            out.fill(0.0);
            for k in 0..p.block as isize {
                let values = &tensor[reflect_101(first + k, height) * row..][..row];
                out.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
            }
        }
    });
}

fn cases(size: Size) -> Vec<Case> {
    let all = [1, 3, 6].map(|block| {
        let params = Params { width: size.width, height: size.height, block };
        let cases = each_fill(Fill::ALL, bytemuck::bytes_of(&params), &[3 * size.stride()], size, |fill| {
            vec![planes(size, 3, fill, [-1.0, 1.0], 3)]
        });
        cases.into_iter().map(move |case| Case { name: format!("{}, block {block}", case.name), ..case })
    });
    all.into_iter().flatten().collect()
}
