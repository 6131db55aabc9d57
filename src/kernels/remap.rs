//! A picture read bilinearly at the places that a map says, its border replicated.

use super::cases::{Fill, cases as each_fill, planes};
use super::lens::bilinear;
use super::rows::{Split, bands, dimensions, repeat_last};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the two pictures.
    struct Params {
        /// Pixels in a row of the result.
        width: u32,
        /// Rows of the result.
        height: u32,
        /// Pixels in a row of the picture that is read.
        in_width: u32,
        /// Rows of the picture that is read.
        in_height: u32,
    }
}

kernel!(
    "remap" + ["bilinear"],
    reference(Params; picture, map) -> (remapped),
    cases: cases,
    tolerance: Tolerance {
        absolute: 0.0, relative: 0.0, of_largest: 8.0 * f32::EPSILON,
        reason: "two linear mixes of the picture's values, fused or not; the fractions are exact",
    },
);

fn reference(p: &Params, picture: &[f32], map: &[f32], remapped: &mut [f32]) {
    let (width, _, stride) = dimensions(p.width, p.height);
    let shape = dimensions(p.in_width, p.in_height);
    bands(
        remapped,
        &mut [],
        Split::rows_of(stride),
        #[inline(always)]
        |band| {
            for (i, row) in band.out.chunks_exact_mut(stride).enumerate() {
                let (map_x, map_y) = map[2 * (band.y0 + i) * stride..][..2 * stride].split_at(stride);
                for ((out, x), y) in row[..width].iter_mut().zip(map_x).zip(map_y) {
                    *out = bilinear(picture, shape, [*x, *y], |value| value);
                }
                repeat_last(row, width);
            }
        },
    );
}

fn cases(size: Size) -> Vec<Case> {
    let raw = Size::new(size.width.div_ceil(2) + 1, size.height + 3);
    let params =
        Params { width: size.width, height: size.height, in_width: raw.width, in_height: raw.height };
    let mut cases = each_fill(Fill::ALL, bytemuck::bytes_of(&params), &[size.stride()], size, |fill| {
        // Places up to a third of the frame outside it.
        let side = raw.width.max(raw.height) as f32;
        vec![
            planes(raw, 1, fill, [0.0, 65535.0], 7),
            planes(size, 2, Fill::Textured, [-0.3 * side, 1.3 * side], 8),
        ]
    });
    // Every place on a pixel, and places that are none.
    let whole = planes(size, 2, Fill::Textured, [0.0, (raw.width - 1) as f32], 10);
    cases[0].inputs[1] = whole.into_iter().map(f32::round).collect();
    for (place, value) in cases[1].inputs[1].iter_mut().zip([f32::NAN, f32::INFINITY, f32::NEG_INFINITY]) {
        *place = value;
    }
    cases
}
