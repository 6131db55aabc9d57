//! Flow on the view sphere: the derotated motion of each pixel's bearing since the previous frame.
//!
//! The two bearings are those of the pixel and of the place to which the flow leads back, rotated into the current
//! camera's frame. The flow has the direction of their chord and the length of the arc between them: it is tangent to
//! the sphere half-way, and agrees with the rate `−ρ (v − p pᵀv)` at mid-time to second order in the time between the
//! frames, where the rate at either end agrees to first order only.

use super::bearings::{Pinhole, rows};
use super::parallel_rows::{Split, bands, dimensions, repeat_last};
use super::test_inputs::{Fill, cases as each_fill, planes};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the image, and the ideal pinhole that took it.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// Pixels of a focal length, to the right and down.
        focal: [f32; 2],
        /// Where the axis meets the image.
        centre: [f32; 2],
    }
}

kernel!(
    "spherical_flow" + ["sphere", "turn"],
    reference(Params; flow, motion) -> (spherical_flow),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-6,
        relative: 1e-5, of_largest: 0.0,
        reason: "some twenty roundings of numbers up to 4, far off the axis",
    },
);

fn reference(p: &Params, flow: &[f32], motion: &[f32], spherical_flow: &mut [f32]) {
    let (width, _, stride) = dimensions(p.width, p.height);
    let motion = rows(motion);
    let pinhole = Pinhole { focal: p.focal, centre: p.centre };
    bands(spherical_flow, &mut [], Split::rows_of(3 * stride), #[inline(always)] |band| {
        for (i, rows) in band.out.chunks_exact_mut(3 * stride).enumerate() {
            let y = band.y0 + i;
            let (u, v) = flow[2 * y * stride..][..2 * stride].split_at(stride);
            for x in 0..width {
                let (seen, _) = pinhole.midpoint_flow(&motion, [x as f32, y as f32], [u[x], v[x]]);
                for (channel, value) in seen.flow.into_iter().enumerate() {
                    rows[channel * stride + x] = value;
                }
            }
            rows.chunks_exact_mut(stride).for_each(|row| repeat_last(row, width));
        }
    });
}

/// A small rotation about all axes and a direction of motion beside the camera's axis.
pub(super) fn motion_case() -> Vec<f32> {
    vec![
        -2e-4, 0.015, -0.011, 0.0, -0.015, -3e-4, 0.02, 0.0, 0.011, -0.02, -4e-4, 0.0, 0.1, -0.06, 0.993, 0.03,
    ]
}

fn cases(size: Size) -> Vec<Case> {
    let (width, height) = (size.width as f32, size.height as f32);
    // A view of 150 degrees, and its axis off the middle.
    let focal = [0.134 * width, 0.15 * height];
    let params =
        Params { width: size.width, height: size.height, focal, centre: [0.52 * width, 0.47 * height] };
    each_fill(Fill::ALL, bytemuck::bytes_of(&params), &[3 * size.stride()], size, |fill| {
        let range = if fill == Fill::Extreme { [0.0, 1e12] } else { [-0.05 * width, 0.05 * width] };
        vec![planes(size, 2, fill, range, 3), motion_case()]
    })
}
