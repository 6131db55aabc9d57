//! The largest value of each row where the mask is over 0, or [`f32::MIN`] where it is nowhere.

use super::parallel_rows::{Split, bands, dimensions};
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
    "row_maximum" + [],
    reference(Params; response, mask) -> (maximum),
    cases: cases,
    tolerance: Tolerance { absolute: 0.0, relative: 0.0, of_largest: 0.0, reason: "values are compared and copied" },
);

fn reference(p: &Params, response: &[f32], mask: &[f32], maximum: &mut [f32]) {
    let (width, _, stride) = dimensions(p.width, p.height);
    bands(maximum, &mut [], Split { dearer: width / 4, ..Split::rows_of(4) }, #[inline(always)] |band| {
        for (i, out) in band.out.chunks_exact_mut(4).enumerate() {
            let start = (band.y0 + i) * stride;
            let values = response[start..][..width].iter().zip(&mask[start..]);
            let allowed = values.filter(|(_, mask)| **mask > 0.0).map(|(value, _)| *value);
            out.fill(allowed.fold(f32::MIN, f32::max));
        }
    });
}

fn cases(size: Size) -> Vec<Case> {
    let params = Params { width: size.width, height: size.height };
    let extent = Size::new(1, size.height);
    each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &[4], extent, |fill| {
        let mut mask = planes(size, 1, Fill::Extreme, [0.0, 1.0], 4);
        // A row without any allowed pixel.
        mask[..size.stride()].fill(0.0);
        vec![planes(size, 1, fill, [-1.0, 1.0], 3), mask]
    })
}
