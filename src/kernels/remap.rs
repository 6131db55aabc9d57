//! A picture read bilinearly at given places. Places outside are read at the border, as if the picture went on there.

use super::cases::{Fill, cases as each_fill, planes};
use super::rows::{Split, bands, dimensions};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the result and of the picture.
    struct Params {
        /// Pixels in a row of the result.
        width: u32,
        /// Rows of the result.
        height: u32,
        /// Pixels in a row of the picture.
        in_width: u32,
        /// Rows of the picture.
        in_height: u32,
    }
}

kernel!(
    "remap" + [],
    reference(Params; picture, map) -> (out),
    cases: cases,
    tolerance: Tolerance {
        absolute: 0.0,
        relative: 0.0,
        of_largest: 8.0 * f32::EPSILON,
        reason: "three linear mixes, fused or not",
    },
);

fn reference(p: &Params, picture: &[f32], map: &[f32], out: &mut [f32]) {
    let (_, _, stride) = dimensions(p.width, p.height);
    let (in_width, in_height, in_stride) = dimensions(p.in_width, p.in_height);
    let last = [(in_width - 1) as f32, (in_height - 1) as f32];
    bands(out, &mut [], Split::rows_of(stride), #[inline(always)] |band| {
        for (i, out) in band.out.chunks_exact_mut(stride).enumerate() {
            let (xs, ys) = map[2 * (band.y0 + i) * stride..][..2 * stride].split_at(stride);
            for ((out, x), y) in out.iter_mut().zip(xs).zip(ys) {
                // Not-a-number compares as false, and is read at the border.
                let held = |v: f32, last: f32| if v >= 0.0 { v.min(last) } else { 0.0 };
                let (x, y) = (held(*x, last[0]), held(*y, last[1]));
                let (left, top) = (x as usize, y as usize);
                let right = (left + 1).min(in_width - 1);
                let bottom = (top + 1).min(in_height - 1);
                let (above, below) = (&picture[top * in_stride..], &picture[bottom * in_stride..]);
                let (fx, fy) = (x - left as f32, y - top as f32);
                *out = mix(mix(above[left], above[right], fx), mix(below[left], below[right], fx), fy);
            }
        }
    });
}

#[inline(always)]
pub(super) fn mix(a: f32, b: f32, share: f32) -> f32 {
    a * (1.0 - share) + b * share
}

fn cases(size: Size) -> Vec<Case> {
    let picture = Size::new(size.width.div_ceil(2) + 1, size.height + 3);
    let params = Params {
        width: size.width,
        height: size.height,
        in_width: picture.width,
        in_height: picture.height,
    };
    // Of a picture that holds what is not a number, places off whole pixels only: a weight of 0 would decide.
    each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &[size.stride()], size, |fill| {
        let places = if fill == Fill::Extreme { [-1e9, 1e9] } else { [-2.0, picture.width as f32 + 2.0] };
        let of_places = if fill == Fill::Textured { Fill::Nan } else { fill };
        vec![planes(picture, 1, fill, [0.0, 255.0], 3), planes(size, 2, of_places, places, 4)]
    })
}
