//! The local maxima of a corner response: its value where none of the eight neighbours is larger and the mask allows a
//! corner, and 0 elsewhere, as at the image's border.

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
    "local_maxima" + [],
    reference(Params; response, mask) -> (maxima),
    cases: cases,
    tolerance: Tolerance { absolute: 0.0, relative: 0.0, of_largest: 0.0, reason: "values are compared and copied" },
);

fn reference(p: &Params, response: &[f32], mask: &[f32], maxima: &mut [f32]) {
    let (width, height, stride) = dimensions(p.width, p.height);
    bands(maxima, &mut [], Split { dearer: 2, ..Split::rows_of(stride) }, #[inline(always)] |band| {
        for (i, out) in band.out.chunks_exact_mut(stride).enumerate() {
            let y = band.y0 + i;
            out.fill(0.0);
            if y == 0 || y + 1 >= height {
                continue;
            }
            let rows = [y - 1, y, y + 1].map(|y| &response[y * stride..][..width]);
            for x in 1..width.saturating_sub(1) {
                let largest = rows.iter().flat_map(|row| &row[x - 1..x + 2]).fold(f32::NEG_INFINITY, |a, b| a.max(*b));
                if rows[1][x] >= largest && mask[y * stride + x] > 0.0 {
                    out[x] = rows[1][x];
                }
            }
            repeat_last(out, width);
        }
    });
}

fn cases(size: Size) -> Vec<Case> {
    let params = Params { width: size.width, height: size.height };
    each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &[size.stride()], size, |fill| {
        vec![planes(size, 1, fill, [-1.0, 1.0], 3), planes(size, 1, Fill::Extreme, [0.0, 1.0], 4)]
    })
}
