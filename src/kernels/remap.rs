//! Samples an image bilinearly at the places of a map; its border is replicated.

use super::lens::clamp_to_frame;
use super::parallel_rows::{Split, bands, dimensions, repeat_last};
use super::test_inputs::{Fill, cases as each_fill, planes};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the two images.
    struct Params {
        /// Pixels in a row of the result.
        width: u32,
        /// Rows of the result.
        height: u32,
        /// Pixels in a row of the sampled image.
        in_width: u32,
        /// Rows of the sampled image.
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
                for x0 in (0..width).step_by(BLOCK) {
                    let part = x0..(x0 + BLOCK).min(width);
                    read(&mut row[part.clone()], picture, shape, [&map_x[part.clone()], &map_y[part]]);
                }
                repeat_last(row, width);
            }
        },
    );
}

/// Number of pixels per block.
const BLOCK: usize = 32;

/// Samples the image at up to [`BLOCK`] places. In three passes over a whole block, so that the compiler vectorizes
/// everything but the loads, whose addresses depend on the places.
#[inline(always)]
fn read(
    out: &mut [f32],
    picture: &[f32],
    (width, height, stride): (usize, usize, usize),
    places: [&[f32]; 2],
) {
    let (mut x, mut y) = ([0.0; BLOCK], [0.0; BLOCK]);
    x[..out.len()].copy_from_slice(places[0]);
    y[..out.len()].copy_from_slice(places[1]);
    let last = [width as u32 - 1, height as u32 - 1];
    let (mut first, mut right, mut below) = ([0; BLOCK], [0; BLOCK], [0; BLOCK]);
    for i in 0..BLOCK {
        (x[i], y[i]) = (clamp_to_frame(x[i], last[0] as f32), clamp_to_frame(y[i], last[1] as f32));
        // Clamped to the image, so that nothing is lost.
        let (left, above) = (x[i] as i32 as u32, y[i] as i32 as u32);
        (x[i], y[i]) = (x[i] - left as f32, y[i] - above as f32);
        first[i] = above * stride as u32 + left;
        right[i] = u32::from(left < last[0]);
        below[i] = if above < last[1] { stride as u32 } else { 0 };
    }
    let mut corners = [[0.0; BLOCK]; 4];
    for i in 0..out.len() {
        let [at, right, below] = [first[i], right[i], below[i]].map(|index| index as usize);
        for (corner, at) in corners.iter_mut().zip([at, at + right, at + below, at + below + right]) {
            corner[i] = picture[at];
        }
    }
    let mut read = [0.0; BLOCK];
    for i in 0..BLOCK {
        let mix = |a: f32, b: f32, share: f32| a * (1.0 - share) + b * share;
        let [a, b, c, d] = [0, 1, 2, 3].map(|k: usize| corners[k][i]);
        read[i] = mix(mix(a, b, x[i]), mix(c, d, x[i]), y[i]);
    }
    out.copy_from_slice(&read[..out.len()]);
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
