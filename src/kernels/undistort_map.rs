//! The map of undistortion: the place of each pixel of an ideal, rotated image in the raw one, and the certainty there.
//!
//! Undistortion and derotation in one: [`super::remap`] samples the raw image once at these places.
//!
//! The certainty is the mask read between pixels, with nothing outside the frame. It falls to 0 over the pixel around
//! the frame, and over the last hundredth of r² within which the lens is one to one: a certainty with steps would leave
//! it to rounding on which side of them a place lies, and no bound could hold between two executors. A direction that
//! the raw image does not show has a certainty of 0 and some place in the frame.

use super::bearings::{rows, turned};
use super::lens::{bilinear, clamp_to_frame, distort};
use super::parallel_rows::{Split, bands, dimensions, repeat_last};
use super::test_inputs::{Fill, planes};
use crate::camera::{Camera, Lens, world_from_body};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

/// The part of r² over which the certainty falls to 0.
const FADE: f64 = 0.01;

params! {
    /// The two cameras.
    struct Params {
        /// Pixels in a row of the result.
        width: u32,
        /// Rows of the result.
        height: u32,
        /// Pixels in a row of the raw image.
        in_width: u32,
        /// Rows of the raw image.
        in_height: u32,
        /// Focal lengths of the result's pinhole.
        out_focal: [f32; 2],
        /// Its principal point.
        out_centre: [f32; 2],
        /// Focal lengths of the raw camera.
        raw_focal: [f32; 2],
        /// Its principal point.
        raw_centre: [f32; 2],
        /// k1 k2 p1 p2 of its lens.
        lens_a: [f32; 4],
        /// k3 k4 k5 k6 of its lens.
        lens_b: [f32; 4],
        /// The r² up to which the lens is one to one, and one over the part of it where the certainty falls.
        limit: [f32; 2],
        /// The centre of the raw image.
        middle: [f32; 2],
        /// Pixels within its border over which the certainty grows to the mask's.
        margin: [f32; 2],
        /// 0 if the mask is 1 everywhere and need not be read.
        masked: u32,
        /// Nothing: the struct's size is a multiple of 16.
        padding: u32,
    }
}

impl Params {
    /// The map from an ideal camera to the raw one. The lens of `out` is ignored: an ideal camera has none.
    ///
    /// It computes the radius up to which the lens is one to one, which takes a tenth of a millisecond.
    pub fn new(out: &Camera, raw: &Camera) -> Self {
        let pair = |[a, b]: [f64; 2]| [a as f32, b as f32];
        let [k1, k2, p1, p2, k3, k4, k5, k6] = raw.lens.coefficients.map(|c| c as f32);
        let limit = raw.lens.radius_limit().powi(2);
        let middle = |side: u32| 0.5 * (f64::from(side) - 1.0);
        Self {
            width: out.size.width,
            height: out.size.height,
            in_width: raw.size.width,
            in_height: raw.size.height,
            out_focal: pair([out.f_u, out.f_v]),
            out_centre: pair([out.u_0, out.v_0]),
            raw_focal: pair([raw.f_u, raw.f_v]),
            raw_centre: pair([raw.u_0, raw.v_0]),
            lens_a: [k1, k2, p1, p2],
            lens_b: [k3, k4, k5, k6],
            limit: pair([limit, 1.0 / (FADE * limit)]),
            middle: pair([middle(raw.size.width), middle(raw.size.height)]),
            margin: [0.0; 2],
            masked: 1,
            padding: 0,
        }
    }

    /// The same with a certainty that grows over this many pixels within the raw image's border.
    pub fn with_margin(self, margin_px: f32) -> Self {
        Self { margin: [margin_px; 2], ..self }
    }

    /// The same where the mask is 1 everywhere, and not read.
    pub fn without_mask(self) -> Self {
        Self { masked: 0, ..self }
    }
}

/// The `motion` input: the rows of the rotation that turns a ray of the result into the raw camera's frame, less the
/// identity, and a fourth row that is not used here.
pub fn motion(raw_from_out: &glam::DMat3) -> Vec<f32> {
    let less = *raw_from_out - glam::DMat3::IDENTITY;
    let row = |i: usize| less.row(i).extend(0.0).as_vec4().to_array();
    [row(0), row(1), row(2), [0.0; 4]].concat()
}

kernel!(
    "undistort_map" + ["lens", "bilinear", "turn"],
    reference(Params; motion, mask) -> (map, certainty),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-3, relative: 0.0, of_largest: 4.0 * f32::EPSILON,
        reason: "some twenty roundings of rays of length 1, times focal lengths up to 600 px and up to 4 by the lens; the \
                 certainty changes by as much, as the mask's slope is 1 a pixel at most",
    },
);

fn reference(p: &Params, motion: &[f32], mask: &[f32], map: &mut [f32], certainty: &mut [f32]) {
    let (width, _, stride) = dimensions(p.width, p.height);
    let raw = dimensions(p.in_width, p.in_height);
    let motion = rows(motion);
    let last = [p.in_width - 1, p.in_height - 1].map(|side| side as f32);
    let split = Split { second_row: stride, ..Split::rows_of(2 * stride) };
    bands(
        map,
        certainty,
        split,
        #[inline(always)]
        |band| {
            let rows =
                band.out.chunks_exact_mut(2 * stride).zip(band.second.chunks_exact_mut(stride)).enumerate();
            for (i, (map, certainty)) in rows {
                let (map_x, map_y) = map.split_at_mut(stride);
                let y = ((band.y0 + i) as f32 - p.out_centre[1]) / p.out_focal[1];
                for x0 in (0..width).step_by(BLOCK) {
                    // Whole blocks, so that the compiler vectorizes them.
                    let mut blocks = [[0.0; BLOCK]; 3];
                    #[allow(clippy::needless_range_loop, reason = "three arrays are filled at once")]
                    for i in 0..BLOCK {
                        let x = ((x0 + i) as f32 - p.out_centre[0]) / p.out_focal[0];
                        [blocks[0][i], blocks[1][i], blocks[2][i]] = locate(p, &motion, last, [x, y]);
                    }
                    let count = (width - x0).min(BLOCK);
                    for (row, block) in [&mut *map_x, &mut *map_y, &mut *certainty].into_iter().zip(&blocks) {
                        row[x0..x0 + count].copy_from_slice(&block[..count]);
                    }
                }
                if p.masked != 0 {
                    for ((certainty, x), y) in certainty.iter_mut().zip(&*map_x).zip(&*map_y).take(width) {
                        *certainty *= bilinear(mask, raw, [*x, *y], clamp_unit);
                    }
                }
                repeat_last(map_x, width);
                repeat_last(map_y, width);
                repeat_last(certainty, width);
            }
        },
    );
}

/// Number of pixels per block.
const BLOCK: usize = 32;

/// The place in the raw frame of a place in the result's plane, and its visibility, 0 to 1. Both sides of every choice
/// are computed: branches would prevent vectorization.
#[inline(always)]
fn locate(p: &Params, motion: &[[f32; 4]; 4], last: [f32; 2], [x, y]: [f32; 2]) -> [f32; 3] {
    let (place, share) = ideal(p, turned(motion, [x, y, 1.0]));
    let [x_d, y_d] = distort(place, p.lens_a, p.lens_b);
    let [u, v] = near(p, [p.raw_focal[0] * x_d + p.raw_centre[0], p.raw_focal[1] * y_d + p.raw_centre[1]]);
    let covered = |place: f32, i: usize| {
        let within = place.min(last[i] - place);
        ((within + 1.0) / (p.margin[i] + 1.0)).clamp(0.0, 1.0)
    };
    [clamp_to_frame(u, last[0]), clamp_to_frame(v, last[1]), share * covered(u, 0) * covered(v, 1)]
}

/// The place at which an ideal pinhole shows a ray, and its visibility, 0 to 1. A ray that the lens does not show is
/// put on the circle where that begins, so that rounding does not make it jump.
#[inline(always)]
fn ideal(p: &Params, [x, y, z]: [f32; 3]) -> ([f32; 2], f32) {
    let [limit, fall] = p.limit;
    let across = x * x + y * y;
    let shown = (z > 0.0) & (across < limit * z * z);
    let inverse = if shown { z } else { 1.0 };
    let [in_x, in_y] = [x / inverse, y / inverse];
    let share = ((limit - (in_x * in_x + in_y * in_y)) * fall).clamp(0.0, 1.0);
    let known = (across > 1e-30) & (across < 1e30);
    let scale = (limit / if known { across } else { 1.0 }).sqrt();
    let [on_x, on_y] = if known { [x * scale, y * scale] } else { [0.0; 2] };
    if shown { ([in_x, in_y], share) } else { ([on_x, on_y], 0.0) }
}

/// A place more than a pixel outside the frame is moved towards its centre until it is one pixel outside. Clamping each
/// coordinate by itself would leave one of them to rounding where the other is far outside.
#[inline(always)]
fn near(p: &Params, [u, v]: [f32; 2]) -> [f32; 2] {
    let [c_u, c_v] = p.middle;
    let (d_u, d_v) = (u - c_u, v - c_v);
    let most = (d_u.abs() / (c_u + 1.0)).max(d_v.abs() / (c_v + 1.0));
    let outside = most > 1.0;
    let times = if outside { most } else { 1.0 };
    let drawn = [c_u + d_u / times, c_v + d_v / times];
    [if outside { drawn[0] } else { u }, if outside { drawn[1] } else { v }]
}

/// A value clamped to the range 0 to 1. NaN becomes 0.
#[inline(always)]
fn clamp_unit(value: f32) -> f32 {
    if value > 0.0 { value.min(1.0) } else { 0.0 }
}

fn cases(size: Size) -> Vec<Case> {
    let raw_size = Size::new(size.width + 2, size.height.div_ceil(2) + 1);
    let camera = |size: Size, focal: f64, coefficients: &[f64]| {
        let mut lens = Lens::NONE;
        lens.coefficients[..coefficients.len()].copy_from_slice(coefficients);
        let [width, height] = [size.width, size.height].map(f64::from);
        Camera {
            size,
            f_u: focal * width,
            f_v: 1.03 * focal * width,
            u_0: 0.51 * width - 0.4,
            v_0: 0.47 * height - 0.3,
            lens,
        }
    };
    let rational = [0.25, 0.01, -3e-4, 8e-4, 0.002, 0.6, 0.08, 0.006];
    // It folds at 44°, inside the view.
    let folding = [-0.3, -0.02, 2e-3, -1e-3, -0.01];
    let mild = [-0.28, 0.07, 2e-3, -1e-3];
    [
        ("mild", camera(raw_size, 0.8, &mild), 0.7, [0.0, 0.0, 0.0], Fill::Textured),
        ("rational, turned", camera(raw_size, 0.5, &rational), 0.45, [0.2, -0.3, 0.5], Fill::Extreme),
        ("folding", camera(raw_size, 0.4, &folding), 0.3, [0.02, 0.01, -0.03], Fill::Textured),
        // Every place lies on a pixel, the outermost ones on the frame's border.
        ("nothing to do", camera(size, 0.7, &[]), 0.7, [0.0, 0.0, 0.0], Fill::Textured),
        ("half of it behind", camera(raw_size, 0.6, &mild), 0.4, [0.1, 1.5, 0.0], Fill::Nan),
        ("no rotation at all", camera(raw_size, 0.6, &mild), 0.4, [f64::NAN, 0.0, 0.0], Fill::Flat),
    ]
    .into_iter()
    .map(|(name, raw, focal, [roll, pitch, yaw], fill)| {
        let margin_px = if fill == Fill::Textured { 3.0 } else { 0.0 };
        let params = Params::new(&camera(size, focal, &[]), &raw).with_margin(margin_px);
        let rotation = world_from_body(roll, pitch, yaw);
        // Beyond their range, which is the caller's mistake and must do no harm.
        let mask = planes(raw.size, 1, fill, [-0.1, 1.1], 9);
        let row = size.stride() * size.height as usize;
        Case {
            name: name.to_owned(),
            params: bytemuck::bytes_of(&params).to_vec(),
            inputs: vec![motion(&rotation), mask],
            outputs: vec![2 * row, row],
            extent: size,
        }
    })
    .collect()
}
