//! The flow that the camera's rotation alone causes, as an initial flow for the search.

use super::bearings::{Pinhole, rows};
use super::parallel_rows::{Split, bands, dimensions, repeat_last};
use super::spherical_flow::motion_case;
use super::test_inputs::{Fill, cases as each_fill};
pub use super::spherical_flow::Params;
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel};

kernel!(
    "rotational_flow" + ["turn"],
    reference(Params; motion) -> (flow),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-3,
        relative: 1e-5, of_largest: 0.0,
        reason: "ten roundings of places up to 640 px from the axis",
    },
);

fn reference(p: &Params, motion: &[f32], flow: &mut [f32]) {
    let (width, _, stride) = dimensions(p.width, p.height);
    let motion = rows(motion);
    let pinhole = Pinhole { focal: p.focal, centre: p.centre };
    bands(flow, &mut [], Split::rows_of(2 * stride), #[inline(always)] |band| {
        for (i, rows) in band.out.chunks_exact_mut(2 * stride).enumerate() {
            let y = (band.y0 + i) as f32;
            let (u, v) = rows.split_at_mut(stride);
            for x in 0..width {
                [u[x], v[x]] = pinhole.turn(&motion, [x as f32, y]);
            }
            repeat_last(u, width);
            repeat_last(v, width);
        }
    });
}

fn cases(size: Size) -> Vec<Case> {
    let (width, height) = (size.width as f32, size.height as f32);
    let focal = [0.6 * width, 0.7 * height];
    let params =
        Params { width: size.width, height: size.height, focal, centre: [0.52 * width, 0.47 * height] };
    each_fill(&[Fill::Flat], bytemuck::bytes_of(&params), &[2 * size.stride()], size, |_| vec![motion_case()])
}
