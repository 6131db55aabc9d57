//! Rows of the five channels averaged by a symmetric window, and the displacement that solves the averaged equations.
//!
//! Farnebäck, Two-frame motion estimation based on polynomial expansion, SCIA 2003, section 3. The determinant is kept
//! off zero by 10⁻³, as OpenCV does. What overflow leaves without a value counts as no motion, so that it cannot spread.

use super::cases::{Fill, Random, cases as each_fill};
use super::rows::{Band, Split, bands, dimensions, extend_row, repeat_last, weighted_sum};
use super::tables;
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the picture and of the window.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// The window has `2 radius + 1` columns.
        radius: u32,
    }
}

kernel!(
    "solve" + ["image", "window", "average"],
    reference(Params; columns, window) -> (flow),
    cases: cases,
    tolerance: Tolerance {
        absolute: 2e-4,
        relative: 2e-4, of_largest: 0.0,
        reason: "the determinant of averaged equations cancels: with eigenvalues in a ratio of up to some hundred, \
                 some hundred roundings of each product",
    },
);

fn reference(p: &Params, columns: &[f32], window: &[f32], flow: &mut [f32]) {
    let (width, _, stride) = dimensions(p.width, p.height);
    average(p, columns, window, flow, 2, #[inline(always)] |[g_xx, g_xy, g_yy, h_x, h_y], rows| {
        let (u, v) = rows.split_at_mut(stride);
        for x in 0..width {
            let scale = 1.0 / (g_xx[x] * g_yy[x] - g_xy[x] * g_xy[x] + 1e-3);
            u[x] = known((g_yy[x] * h_x[x] - g_xy[x] * h_y[x]) * scale);
            v[x] = known((g_xx[x] * h_y[x] - g_xy[x] * h_x[x]) * scale);
        }
    });
}

/// Averages rows of five channels by the window and hands them to `f` with the row of the result that they belong to.
#[inline(always)]
pub(super) fn average(
    p: &Params,
    columns: &[f32],
    window: &[f32],
    result: &mut [f32],
    channels: usize,
    f: impl Fn([&[f32]; 5], &mut [f32]) + Sync,
) {
    let (width, _, stride) = dimensions(p.width, p.height);
    let radius = p.radius as usize;
    let padding = radius.next_multiple_of(4) - radius;
    let window = &window[padding..][..2 * radius + 1];
    let extended = width + 2 * radius;
    let split = Split { scratch: extended + 5 * width, ..Split::rows_of(channels * stride) };
    bands(result, &mut [], split, #[inline(always)] |band| {
        let Band { y0, out, scratch, .. } = band;
        let (extended, sums) = scratch.split_at_mut(extended);
        for (i, rows) in out.chunks_exact_mut(channels * stride).enumerate() {
            for (channel, sum) in sums.chunks_exact_mut(width).enumerate() {
                extend_row(extended, &columns[(5 * (y0 + i) + channel) * stride..], width, radius);
                weighted_sum(sum, window, |k| &extended[k..][..width]);
            }
            f([0, 1, 2, 3, 4].map(|channel| &sums[channel * width..][..width]), rows);
            for row in rows.chunks_exact_mut(stride) {
                repeat_last(row, width);
            }
        }
    });
}

#[inline(always)]
fn known(d: f32) -> f32 {
    if d.abs() <= 1e9 { d } else { 0.0 }
}

/// Equations of a model whose two eigenvalues lie between the given bounds, for some displacement up to 8 px.
fn cases(size: Size) -> Vec<Case> {
    let params = Params { width: size.width, height: size.height, radius: 6 };
    let window = tables::window_from(&tables::window(13, false), 8);
    let mut cases = each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &[2 * size.stride()], size, |fill| {
        vec![equations(size, fill), window.clone()]
    });
    // Determinants near the 10⁻³ that keeps them off zero, where it decides the displacement; and products that
    // overflow though the equations themselves do not.
    for (name, factor) in [("weak", 0.01), ("overflowing", 1e25)] {
        let scaled = equations(size, Fill::Textured).iter().map(|value| factor * value).collect();
        let (params, outputs) = (bytemuck::bytes_of(&params).to_vec(), vec![2 * size.stride() * size.height as usize]);
        cases.push(Case { name: name.to_owned(), params, inputs: vec![scaled, window.clone()], outputs, extent: size });
    }
    cases
}

pub(super) fn equations(size: Size, fill: Fill) -> Vec<f32> {
    let mut random = Random::new(23);
    let stride = size.stride();
    let mut values = vec![0.0; 5 * stride * size.height as usize];
    for row in values.chunks_exact_mut(5 * stride) {
        for x in 0..size.width as usize {
            let [angle, p, q, u, v] = [(); 5].map(|()| random.next());
            let (sin, cos) = (angle * std::f32::consts::TAU).sin_cos();
            let (p, q) = match fill {
                Fill::Flat => (0.0, 0.0),
                Fill::Extreme if p < 0.5 => (1e6, 1e6),
                Fill::Extreme => (1.0, 2.0),
                _ => (1.0 + 9.0 * p, 1.0 + 9.0 * q),
            };
            let (xx, xy, yy) = (p * cos * cos + q * sin * sin, (p - q) * sin * cos, p * sin * sin + q * cos * cos);
            let (u, v) = (16.0 * u - 8.0, 16.0 * v - 8.0);
            let pixel = [xx, xy, yy, xx * u + xy * v, xy * u + yy * v];
            for (channel, value) in pixel.into_iter().enumerate() {
                row[channel * stride + x] = value;
            }
        }
        for channel in row.chunks_exact_mut(stride) {
            repeat_last(channel, size.width as usize);
        }
    }
    values
}
