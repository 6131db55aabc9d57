//! Averages columns of five channels by a symmetric window: the vertical half of the neighbourhood's sum.
//!
//! The equations are never NaN: [`normal_equations`](super::normal_equations) guarantees it.

use super::parallel_rows::{Split, bands, clamp_index, dimensions, weighted_sum};
use super::tables;
use super::test_inputs::{Fill, cases as each_fill, planes};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the image and of the window.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// The window has `2 radius + 1` rows.
        radius: u32,
    }
}

kernel!(
    "window_y" + ["image"],
    reference(Params; equations, window) -> (columns),
    cases: cases,
    tolerance: Tolerance {
        absolute: 0.0,
        relative: 4.0 * f32::EPSILON,
        of_largest: 16.0 * f32::EPSILON,
        reason: "a mean of values of either sign, fused or not: some roundings of the largest",
    },
    variants: { wide: { WORKGROUP_X = 64 }, square: { WORKGROUP_X = 8, WORKGROUP_Y = 8 } },
);

fn reference(p: &Params, equations: &[f32], window: &[f32], columns: &mut [f32]) {
    let (_, height, stride) = dimensions(p.width, p.height);
    let radius = p.radius as isize;
    let window = &window[..2 * p.radius as usize + 1];
    // A band is processed in strips of columns, so narrow that the rows under the window stay in the nearest cache.
    const STRIP: usize = 512;
    bands(columns, &mut [], Split::rows_of(5 * stride), #[inline(always)] |band| {
        for x0 in (0..5 * stride).step_by(STRIP) {
            // The five channels of a row lie side by side and are averaged alike.
            let strip = x0..(5 * stride).min(x0 + STRIP);
            for (i, rows) in band.out.chunks_exact_mut(5 * stride).enumerate() {
                let first = (band.y0 + i) as isize - radius;
                weighted_sum(&mut rows[strip.clone()], window, |k| {
                    &equations[clamp_index(first + k as isize, height) * 5 * stride..][strip.clone()]
                });
            }
        }
    });
}

fn cases(size: Size) -> Vec<Case> {
    let params = Params { width: size.width, height: size.height, radius: 6 };
    each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &[5 * size.stride()], size, |fill| {
        vec![planes(size, 5, fill, [-100.0, 100.0], 11), tables::window_from(&tables::window(13, true), 6)]
    })
}
