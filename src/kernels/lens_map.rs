//! Where in the raw frame each pixel of an ideal, turned camera is to be read, and how far that can be trusted.
//!
//! The pixel's ray, turned by `motion`, goes through the raw camera's lens (Brown 1971; the rational form is OpenCV's):
//! `q = (1 + k1 r² + k2 r⁴ + k3 r⁶) / (1 + k4 r² + k5 r⁴ + k6 r⁶)`, `x' = x q + 2 p1 x y + p2 (r² + 2x²)`,
//! `y' = y q + p1 (r² + 2y²) + 2 p2 x y`. What is behind the camera, where the lens folds, and outside the frame is not
//! trusted at all; trust grows over a margin within the frame's border.

use super::cases::{Fill, cases as each_fill, planes};
use super::remap::mix;
use super::rows::{Split, bands, dimensions, repeat_last};
use super::sighting::{Pinhole, rows};
use super::tangent::motion_case;
use crate::camera::{Camera, Lens};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// The ideal camera, and the camera that takes the frames.
    struct Params {
        /// Pixels in a row of the ideal picture.
        width: u32,
        /// Rows of the ideal picture.
        height: u32,
        /// Pixels in a row of the raw frame.
        in_width: u32,
        /// Rows of the raw frame.
        in_height: u32,
        /// Pixels of the ideal camera's focal length, to the right and down.
        focal: [f32; 2],
        /// Where its axis meets the picture.
        centre: [f32; 2],
        /// Pixels of the raw camera's focal length.
        in_focal: [f32; 2],
        /// Where its axis meets the frame.
        in_centre: [f32; 2],
        /// k1 k2 p1 p2.
        lens_a: [f32; 4],
        /// k3 k4 k5 k6.
        lens_b: [f32; 4],
        /// Up to what distance from the axis, in focal lengths and squared, the lens is one to one.
        limit: f32,
        /// Pixels from the frame's border over which trust grows to 1.
        margin: f32,
        /// Nothing: a struct's size is a multiple of 16.
        padding: [f32; 2],
    }
}

kernel!(
    "lens_map" + ["lens", "turn"],
    reference(Params; motion, mask) -> (map, certainty),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-3,
        relative: 4e-6, of_largest: 0.0,
        reason: "some twenty roundings of places up to 641 px, whose unit in the last place is 6e-5; a certainty changes \
                 by no more than a place does in pixels",
    },
);

impl Params {
    /// Of pictures that `ideal`, a camera without a lens, would take of what `raw` sees.
    pub fn new(ideal: &Camera, raw: &Camera, margin_px: f32) -> Self {
        let [k1, k2, p1, p2, k3, k4, k5, k6] = raw.lens.coefficients.map(|k| k as f32);
        let limit = raw.lens.radius_limit();
        Self {
            width: ideal.size.width,
            height: ideal.size.height,
            in_width: raw.size.width,
            in_height: raw.size.height,
            focal: [ideal.f_u as f32, ideal.f_v as f32],
            centre: [ideal.u_0 as f32, ideal.v_0 as f32],
            in_focal: [raw.f_u as f32, raw.f_v as f32],
            in_centre: [raw.u_0 as f32, raw.v_0 as f32],
            lens_a: [k1, k2, p1, p2],
            lens_b: [k3, k4, k5, k6],
            // A lens without limit ends where f32 could not hold its polynomials any more.
            limit: (limit * limit).min(1e8) as f32,
            margin: margin_px,
            padding: [0.0; 2],
        }
    }

    #[inline(always)]
    fn distort(&self, [x, y]: [f32; 2]) -> [f32; 2] {
        let ([k1, k2, p1, p2], [k3, k4, k5, k6]) = (self.lens_a, self.lens_b);
        let r2 = x * x + y * y;
        let q = (1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1.0 + r2 * (k4 + r2 * (k5 + r2 * k6)));
        let xy = 2.0 * x * y;
        [
            q * x + (p1 * xy + p2 * (r2 + 2.0 * x * x)),
            q * y + (p1 * (r2 + 2.0 * y * y) + p2 * xy),
        ]
    }
}

fn reference(p: &Params, motion: &[f32], mask: &[f32], map: &mut [f32], certainty: &mut [f32]) {
    let (width, _, stride) = dimensions(p.width, p.height);
    let motion = rows(motion);
    let pinhole = Pinhole { focal: p.focal, centre: p.centre };
    let last = [(p.in_width - 1) as f32, (p.in_height - 1) as f32];
    let split = Split { second_row: stride, ..Split::rows_of(2 * stride) };
    bands(map, certainty, split, #[inline(always)] |band| {
        let rows = band.out.chunks_exact_mut(2 * stride).zip(band.second.chunks_exact_mut(stride));
        for (i, (map, certainty)) in rows.enumerate() {
            let (xs, ys) = map.split_at_mut(stride);
            for x in 0..width {
                let ray = pinhole.turned_ray(&motion, [x as f32, (band.y0 + i) as f32]);
                let ideal = [ray[0] / ray[2].max(1e-3), ray[1] / ray[2].max(1e-3)];
                let lies = ray[2] > 1e-3 && ideal[0] * ideal[0] + ideal[1] * ideal[1] < p.limit;
                let distorted = p.distort(if lies { ideal } else { [0.0; 2] });
                let place: [f32; 2] = std::array::from_fn(|k| p.in_focal[k] * distorted[k] + p.in_centre[k]);
                // A pixel reaches half a pixel beyond its centre.
                let within = (place[0].min(last[0] - place[0])).min(place[1].min(last[1] - place[1])) + 0.5;
                let share = (within / p.margin.max(0.5)).clamp(0.0, 1.0);
                let held: [f32; 2] = std::array::from_fn(|k| place[k].clamp(0.0, last[k]));
                (xs[x], ys[x]) = (held[0], held[1]);
                let trusted = (share * masked(p, mask, held)).clamp(0.0, 1.0);
                certainty[x] = if lies { trusted } else { 0.0 };
            }
            [xs, ys, certainty].into_iter().for_each(|row| repeat_last(row, width));
        }
    });
}

/// The mask between its pixels.
#[inline(always)]
fn masked(p: &Params, mask: &[f32], [x, y]: [f32; 2]) -> f32 {
    let (width, height, stride) = dimensions(p.in_width, p.in_height);
    let (left, top) = (x as usize, y as usize);
    let right = (left + 1).min(width - 1);
    let (above, below) = (&mask[top * stride..], &mask[(top + 1).min(height - 1) * stride..]);
    let (fx, fy) = (x - left as f32, y - top as f32);
    mix(mix(above[left], above[right], fx), mix(below[left], below[right], fx), fy)
}

fn cases(size: Size) -> Vec<Case> {
    let raw_size = Size::new(size.width + 2, size.height.div_ceil(2) + 1);
    let [width, height] = [f64::from(size.width), f64::from(size.height)];
    let lenses: [(&str, [f64; 8]); 3] = [
        ("mild", [-0.28, 0.07, 2e-4, 2e-5, 0.0, 0.0, 0.0, 0.0]),
        ("rational", [1.7, 0.6, -2e-4, 3e-4, 0.02, 2.0, 1.1, 0.13]),
        // It folds within the view.
        ("folding", [-0.5, 0.02, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
    ];
    let case = |(name, coefficients): (&str, [f64; 8])| {
        let camera = |size: Size, focal: f64, lens: Lens| Camera {
            size,
            f_u: focal * f64::from(size.width),
            f_v: focal * f64::from(size.height),
            u_0: 0.51 * f64::from(size.width),
            v_0: 0.47 * f64::from(size.height),
            lens,
        };
        let lens = Lens { coefficients };
        let ideal = camera(size, 0.4, Lens::NONE);
        let params = Params::new(&ideal, &camera(raw_size, 0.43 + 1e-4 * (width + height), lens), 4.0);
        let outputs = [2 * size.stride(), size.stride()];
        let mut cases = each_fill(&[Fill::Textured], bytemuck::bytes_of(&params), &outputs, size, |_| {
            // Smooth, so that a rounding of the place makes none that is larger.
            let mask = planes(raw_size, 1, Fill::Flat, [0.0, 1.2], 3);
            vec![motion_case(), mask]
        });
        cases.iter_mut().for_each(|case| case.name = name.to_owned());
        cases
    };
    lenses.into_iter().flat_map(case).collect()
}
