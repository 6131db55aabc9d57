//! Each pixel's equations for its displacement from the image gradients in x, y and time.
//!
//! Lucas and Kanade, An iterative image registration technique, IJCAI 1981: `Σ ∇I ∇Iᵀ d = Σ ∇I (∇I · d₀ − I_t)`, where
//! d₀ is the flow so far and I_t the remaining difference in time. The gradients in x and y are Sobel's kernels over 8,
//! that in time is the mean difference of 3 × 3 pixels, over 9: with these factors they are derivatives, in gray levels
//! per pixel and per frame. A pixel's weight is the least share of its neighbourhood that both images show.

use super::parallel_rows::{Split, bands, dimensions, repeat_last};
use super::test_inputs::{Fill, cases as each_fill, planes};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the images, and the kind of output.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// 0: the last two channels are the right-hand sides. 1: they are the square of I_t and the share that both
        /// images show, for the confidence.
        residual: u32,
    }
}

kernel!(
    "gradient_equations" + [],
    reference(Params; first, certainty, warped, shown, flow) -> (equations),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-5,
        relative: 1e-5,
        // The largest is a square of differences, so the largest square of a gray level is its measure.
        of_largest: 1e-5,
        reason: "products of two differences that may cancel: some ten roundings of the square of the largest gray level",
    },
);

fn reference(
    p: &Params,
    first: &[f32],
    certainty: &[f32],
    warped: &[f32],
    shown: &[f32],
    flow: &[f32],
    equations: &mut [f32],
) {
    let (width, height, stride) = dimensions(p.width, p.height);
    let split = Split { dearer: 2, ..Split::rows_of(5 * stride) };
    bands(equations, &mut [], split, #[inline(always)] |band| {
        for (i, channels) in band.out.chunks_exact_mut(5 * stride).enumerate() {
            let y = band.y0 + i;
            let rows = [y.saturating_sub(1), y, (y + 1).min(height - 1)].map(|row| row * stride);
            for x in 0..width {
                let columns = [x.saturating_sub(1), x, (x + 1).min(width - 1)];
                let nine = |f: &dyn Fn(usize) -> f32| rows.map(|row| columns.map(|column| f(row + column)));
                let [above, middle, below] = nine(&|at| first[at]);
                let i_x =
                    0.125 * ((above[2] - above[0]) + 2.0 * (middle[2] - middle[0]) + (below[2] - below[0]));
                let i_y =
                    0.125 * ((below[0] - above[0]) + 2.0 * (below[1] - above[1]) + (below[2] - above[2]));
                let [above, middle, below] = nine(&|at| warped[at] - first[at]);
                let [a, b, c] = [0, 1, 2].map(|k| above[k] + middle[k] + below[k]);
                let i_t = (1.0 / 9.0) * (a + b + c);
                let share = nine(&|at| certainty[at] * shown[at]).into_iter().flatten().fold(f32::INFINITY, f32::min);
                let (g_x, g_y, t) = (share * i_x, share * i_y, share * i_t);
                let (u, v) = (flow[2 * y * stride + x], flow[(2 * y + 1) * stride + x]);
                let right = g_x * u + g_y * v - t;
                let rest = if p.residual == 1 { [t * t, share] } else { [g_x * right, g_y * right] };
                let values = [g_x * g_x, g_x * g_y, g_y * g_y, rest[0], rest[1]];
                let known = values.iter().map(|value| value.abs()).sum::<f32>() <= 1e30;
                for (channel, value) in channels.chunks_exact_mut(stride).zip(values) {
                    channel[x] = if known { value } else { 0.0 };
                }
            }
            channels.chunks_exact_mut(stride).for_each(|row| repeat_last(row, width));
        }
    });
}

fn cases(size: Size) -> Vec<Case> {
    let all = [0, 1].map(|residual| {
        let params = Params { width: size.width, height: size.height, residual };
        let cases = each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &[5 * size.stride()], size, |fill| {
            vec![
                planes(size, 1, fill, [0.0, 255.0], 1),
                planes(size, 1, Fill::Textured, [0.0, 1.0], 2),
                planes(size, 1, fill, [0.0, 255.0], 3),
                planes(size, 1, Fill::Extreme, [0.0, 1.0], 4),
                planes(size, 2, fill, [-6.0, 6.0], 5),
            ]
        });
        cases.into_iter().map(move |case| Case { name: format!("{}, residual {residual}", case.name), ..case })
    });
    all.into_iter().flatten().collect()
}
