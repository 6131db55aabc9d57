//! The slopes of the flow, each pixel's weighted by how near they are to the slopes expected there.
//!
//! Averaged by a window, and divided by the averaged weight ([`super::expected_slope`]), they are a mean of the slopes
//! around a pixel that keeps the edges of the motion. Channels of the result: the weight, and the weight times ∂u/∂x, ∂u/∂y,
//! ∂v/∂x and ∂v/∂y.

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
        /// The squared difference from the expected slopes at which the weight is ½, above 0.
        spread: f32,
    }
}

kernel!(
    "slope_weights" + ["slopes"],
    reference(Params; flow, slope) -> (weighted),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-6,
        relative: 4e-6,
        of_largest: 1e-6,
        reason: "differences of displacements, squared, and a quotient: some ten roundings of the largest",
    },
);

fn reference(p: &Params, flow: &[f32], slope: &[f32], weighted: &mut [f32]) {
    let (width, height, stride) = dimensions(p.width, p.height);
    let split = Split { scratch: 4 * stride, ..Split::rows_of(5 * stride) };
    bands(weighted, &mut [], split, #[inline(always)] |band| {
        for (i, rows) in band.out.chunks_exact_mut(5 * stride).enumerate() {
            let y = band.y0 + i;
            slopes_of_row(flow, y, [width, height, stride], band.scratch);
            let mut channels = rows.chunks_exact_mut(stride).map(|row| &mut row[..width]);
            let [Some(weight), Some(a), Some(b), Some(c), Some(d)] = [(); 5].map(|()| channels.next()) else {
                unreachable!("there are five channels");
            };
            let [ux, uy, vx, vy] = four_rows(band.scratch, 0, stride).map(|row| &row[..width]);
            let [tux, tuy, tvx, tvy] = four_rows(slope, y, stride).map(|row| &row[..width]);
            for x in 0..width {
                let [p0, p1, p2, p3] = [ux[x] - tux[x], uy[x] - tuy[x], vx[x] - tvx[x], vy[x] - tvy[x]];
                let w = p.spread / (p.spread + (p0 * p0 + p1 * p1 + p2 * p2 + p3 * p3));
                weight[x] = w;
                (a[x], b[x], c[x], d[x]) = (w * ux[x], w * uy[x], w * vx[x], w * vy[x]);
            }
            rows.chunks_exact_mut(stride).for_each(|row| repeat_last(row, width));
        }
    });
}

/// The four channels of row `y` of an image.
#[inline(always)]
pub(super) fn four_rows(image: &[f32], y: usize, stride: usize) -> [&[f32]; 4] {
    [0, 1, 2, 3].map(|channel| &image[(4 * y + channel) * stride..][..stride])
}

/// The slopes of a flow in row `y`, in pixels per pixel: ∂u/∂x, ∂u/∂y, ∂v/∂x, ∂v/∂y, each a row of `out`. They are central
/// differences, one-sided at the border, and 0 across an image one pixel wide or high.
#[inline(always)]
pub(super) fn slopes_of_row(
    flow: &[f32],
    y: usize,
    [width, height, stride]: [usize; 3],
    out: &mut [f32],
) {
    let row = |y: usize, channel: usize| &flow[(2 * y + channel) * stride..][..stride];
    let (above, below) = (y.saturating_sub(1), (y + 1).min(height - 1));
    let of_rows = if below - above == 2 { 0.5 } else { 1.0 };
    for channel in 0..2 {
        let (here, above, below) = (row(y, channel), row(above, channel), row(below, channel));
        let (along_x, along_y) = out[2 * channel * stride..][..2 * stride].split_at_mut(stride);
        if width > 2 {
            let inner = here[..width - 2].iter().zip(&here[2..width]);
            for (slope, (left, right)) in along_x[1..].iter_mut().zip(inner) {
                *slope = 0.5 * (right - left);
            }
        }
        let last = width - 1;
        along_x[0] = here[1.min(last)] - here[0];
        along_x[last] = here[last] - here[last.saturating_sub(1)];
        for ((slope, above), below) in along_y.iter_mut().zip(above).zip(below) {
            *slope = of_rows * (below - above);
        }
    }
}

fn cases(size: Size) -> Vec<Case> {
    let params = Params { width: size.width, height: size.height, spread: 0.04 };
    each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &[5 * size.stride()], size, |fill| {
        vec![planes(size, 2, fill, [-2.0, 2.0], 1), planes(size, 4, fill, [-0.5, 0.5], 2)]
    })
}
