//! Moves a flow field along itself by one frame: the prediction of the next pair's flow.
//!
//! The flow is taken to stay with what it shows, ∂d/∂t + (d · ∇) d = 0 (Adarve and Mahony, A filter formulation for computing
//! real time optical flow, IEEE RA-L 2016). A pixel reads the flow where its own leads back to (Courant, Isaacson and Rees,
//! On the solution of nonlinear hyperbolic differential equations by finite differences, 1952), with the weights of the
//! quadratic B-spline over 3 × 3 pixels, which smooth it as well. Beyond the border the nearest pixel counts.

use super::parallel_rows::{Split, bands, dimensions, repeat_last};
use super::test_inputs::{Fill, cases as each_fill, planes};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the flow, and the direction of time.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// What multiplies the flow on the way to the place that a pixel reads: −1 for a flow from the earlier frame to the
        /// later one, 1 for one that leads back.
        sense: f32,
    }
}

kernel!(
    "transport" + [],
    reference(Params; flow) -> (moved),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-5,
        relative: 0.0,
        of_largest: 2e-4,
        reason: "a place's fraction has 2⁻¹⁴ px at 641, once along each axis, times the step between two pixels, which is up \
                 to twice the largest; and some roundings of the largest",
    },
);

fn reference(p: &Params, flow: &[f32], moved: &mut [f32]) {
    let (width, height, stride) = dimensions(p.width, p.height);
    let split = Split { dearer: 8, ..Split::rows_of(2 * stride) };
    bands(moved, &mut [], split, #[inline(always)] |band| {
        for (i, rows) in band.out.chunks_exact_mut(2 * stride).enumerate() {
            let y = band.y0 + i;
            let (out_u, out_v) = rows.split_at_mut(stride);
            let (u, v) = flow[2 * y * stride..][..2 * stride].split_at(stride);
            for x in 0..width {
                let (columns, weights_x) = three(x as f32 + p.sense * u[x], width);
                let (lines, weights_y) = three(y as f32 + p.sense * v[x], height);
                let mut sums = [0.0; 2];
                for (line, weight) in lines.into_iter().zip(weights_y) {
                    let (u, v) = flow[2 * line * stride..][..2 * stride].split_at(stride);
                    for (sum, row) in sums.iter_mut().zip([u, v]) {
                        let [a, b, c] = [0, 1, 2].map(|i| weights_x[i] * row[columns[i]]);
                        *sum += weight * (a + b + c);
                    }
                }
                [out_u[x], out_v[x]] = sums;
            }
            repeat_last(out_u, width);
            repeat_last(out_v, width);
        }
    });
}

/// The three samples of a row of `n` around a place, or around the nearest one within the row, and their weights.
#[inline(always)]
fn three(at: f32, n: usize) -> ([usize; 3], [f32; 3]) {
    let at = at.max(0.0).min((n - 1) as f32);
    let nearest = (at + 0.5) as usize;
    let f = at - nearest as f32;
    let index = [nearest.saturating_sub(1), nearest, (nearest + 1).min(n - 1)];
    (index, [0.5 * (0.5 - f) * (0.5 - f), 0.75 - f * f, 0.5 * (0.5 + f) * (0.5 + f)])
}

fn cases(size: Size) -> Vec<Case> {
    let all = [-1.0, 1.0].map(|sense| {
        let params = Params { width: size.width, height: size.height, sense };
        let cases = each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &[2 * size.stride()], size, |fill| {
            vec![planes(size, 2, fill, [-6.0, 6.0], 1)]
        });
        cases.into_iter().map(move |case| Case { name: format!("{}, {sense}", case.name), ..case })
    });
    all.into_iter().flatten().collect()
}
