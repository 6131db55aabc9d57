//! Each pixel's normal equations for its displacement, with the second frame read where the flow so far points.
//!
//! Farnebäck, Two-frame motion estimation based on polynomial expansion, SCIA 2003, section 3; the border's weights and
//! what happens outside the picture are OpenCV's.

use super::cases::{Fill, cases as each_fill, planes, quads};
use super::rows::{Split, bands, dimensions, repeat_last};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the picture.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
    }
}

kernel!(
    "matrices" + ["image", "equations"],
    reference(Params; quad_0, cross_term_0, quad_1, cross_term_1, flow) -> (equations),
    cases: cases,
    tolerance: Tolerance {
        absolute: 4e-3,
        relative: 1e-4,
        reason: "a place's fraction has 2⁻¹⁴ px at 641; the expansions differ by up to 40 from pixel to pixel in these \
                 cases, and h sums products of two of them and of the flow",
    },
);

/// Pixels worked on side by side.
const LANES: usize = 16;

/// The model of [`LANES`] pixels: the mean of A, and half the difference of b, before the flow so far is added.
#[derive(Default)]
struct Models {
    b_x: [f32; LANES],
    b_y: [f32; LANES],
    a_xx: [f32; LANES],
    a_yy: [f32; LANES],
    a_xy: [f32; LANES],
}

fn reference(
    p: &Params,
    quad_0: &[f32],
    cross_term_0: &[f32],
    quad_1: &[f32],
    cross_term_1: &[f32],
    flow: &[f32],
    equations: &mut [f32],
) {
    let (width, height, stride) = dimensions(p.width, p.height);
    let second = Second { quad: quad_1.as_chunks().0, cross_term: cross_term_1, width, height, stride };
    let quad_0 = quad_0.as_chunks::<4>().0;
    bands(equations, &mut [], Split::rows_of(5 * stride), #[inline(always)] |band| {
        for (i, rows) in band.out.chunks_exact_mut(5 * stride).enumerate() {
            let y = band.y0 + i;
            let quad_0 = &quad_0[y * stride..][..width];
            let cross_term_0 = &cross_term_0[y * stride..][..width];
            let (u, v) = flow[2 * y * stride..][..2 * stride].split_at(stride);
            let weight_y = border_weight(y, height);
            for x0 in (0..width).step_by(LANES) {
                let count = LANES.min(width - x0);
                let mut models = Models::default();
                let mut d = [[0.0; LANES]; 2];
                let mut weights = [0.0; LANES];
                d[0][..count].copy_from_slice(&u[x0..x0 + count]);
                d[1][..count].copy_from_slice(&v[x0..x0 + count]);
                for i in 0..count {
                    let x = x0 + i;
                    let at = [x as f32 + d[0][i], y as f32 + d[1][i]];
                    models.set(i, &quad_0[x], cross_term_0[x], second.at(at));
                    weights[i] = weight_y * border_weight(x, width);
                }
                for (channel, values) in models.equations(&d, &weights).iter().enumerate() {
                    rows[channel * stride + x0..][..count].copy_from_slice(&values[..count]);
                }
            }
            for channel in rows.chunks_exact_mut(stride) {
                repeat_last(channel, width);
            }
        }
    });
}

impl Models {
    /// The model of one pixel: where the second frame has no expansion, the first one's stands alone and says nothing
    /// of motion.
    #[inline(always)]
    fn set(&mut self, i: usize, quad_0: &[f32; 4], cross_term_0: f32, second: Option<([f32; 4], f32)>) {
        let (quad, cross_term) = match second {
            Some((quad_1, cross_term_1)) => {
                let sign = [-1.0, -1.0, 1.0, 1.0];
                let half = |c: usize| 0.5 * (quad_0[c] + sign[c] * quad_1[c]);
                ([half(0), half(1), half(2), half(3)], 0.25 * (cross_term_0 + cross_term_1))
            }
            None => ([0.5 * quad_0[0], 0.5 * quad_0[1], quad_0[2], quad_0[3]], 0.5 * cross_term_0),
        };
        [self.b_x[i], self.b_y[i], self.a_xx[i], self.a_yy[i]] = quad;
        self.a_xy[i] = cross_term;
    }

    /// G = AᵀA and h = AᵀΔb with Δb = b + A d: channels xx, xy, yy, x, y.
    #[inline(always)]
    fn equations(&self, d: &[[f32; LANES]; 2], weights: &[f32; LANES]) -> [[f32; LANES]; 5] {
        let mut out = [[0.0; LANES]; 5];
        for i in 0..LANES {
            let (a_xx, a_xy, a_yy) = (self.a_xx[i], self.a_xy[i], self.a_yy[i]);
            let b_x = self.b_x[i] + a_xx * d[0][i] + a_xy * d[1][i];
            let b_y = self.b_y[i] + a_xy * d[0][i] + a_yy * d[1][i];
            let w = weights[i];
            let (a_xx, a_xy, a_yy, b_x, b_y) = (w * a_xx, w * a_xy, w * a_yy, w * b_x, w * b_y);
            let g = [a_xx * a_xx + a_xy * a_xy, (a_xx + a_yy) * a_xy, a_yy * a_yy + a_xy * a_xy];
            let h = [a_xx * b_x + a_xy * b_y, a_xy * b_x + a_yy * b_y];
            let all = [g[0], g[1], g[2], h[0], h[1]];
            // Equations that overflowed or were never numbers say nothing; zeros keep that from spreading.
            let known = all.iter().fold(true, |known, value| known & (value.abs() <= 1e30));
            for (channel, value) in all.into_iter().enumerate() {
                out[channel][i] = if known { value } else { 0.0 };
            }
        }
        out
    }
}

/// The second frame's expansion, to be read between pixels.
struct Second<'a> {
    quad: &'a [[f32; 4]],
    cross_term: &'a [f32],
    width: usize,
    height: usize,
    stride: usize,
}

impl Second<'_> {
    /// The expansion at a place between four pixels, or nothing where there are not four around it.
    #[inline(always)]
    fn at(&self, [x, y]: [f32; 2]) -> Option<([f32; 4], f32)> {
        let inside = x >= 0.0 && y >= 0.0 && x < (self.width - 1) as f32 && y < (self.height - 1) as f32;
        if !inside {
            return None;
        }
        let (left, above) = (x as usize, y as usize);
        let (fx, fy) = (x - left as f32, y - above as f32);
        let weights = [(1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy];
        let i = above * self.stride + left;
        let (quad_above, quad_below) = (&self.quad[i..i + 2], &self.quad[i + self.stride..][..2]);
        let quads = [&quad_above[0], &quad_above[1], &quad_below[0], &quad_below[1]];
        let mut quad = [0.0; 4];
        for (q, w) in quads.into_iter().zip(weights) {
            for c in 0..4 {
                quad[c] += w * q[c];
            }
        }
        let (above, below) = (&self.cross_term[i..i + 2], &self.cross_term[i + self.stride..][..2]);
        let cross_term =
            weights[0] * above[0] + weights[1] * above[1] + weights[2] * below[0] + weights[3] * below[1];
        Some((quad, cross_term))
    }
}

/// How much pixels near the border count: 0.14, 0.14, 0.4472, 0.4472, 0.4472, then 1.
#[inline(always)]
fn border_weight(i: usize, n: usize) -> f32 {
    let step = |distance: usize| match distance {
        0 | 1 => 0.14,
        2..=4 => 0.4472,
        _ => 1.0,
    };
    step(i) * step(n - 1 - i)
}

fn cases(size: Size) -> Vec<Case> {
    let params = Params { width: size.width, height: size.height };
    let ranges = [[-20.0, 20.0], [-20.0, 20.0], [-4.0, 4.0], [-4.0, 4.0]];
    each_fill(Fill::ALL, bytemuck::bytes_of(&params), &[5 * size.stride()], size, |fill| {
        let far = if fill == Fill::Extreme { 1e12 } else { 6.0 };
        // Flows of 0 keep whole places, where a wrong border shows; a flow of 10¹² is far outside.
        let near = if fill == Fill::Extreme { 0.0 } else { -6.0 };
        vec![
            quads(size, fill, ranges, 1),
            planes(size, 1, fill, [-4.0, 4.0], 2),
            quads(size, fill, ranges, 3),
            planes(size, 1, fill, [-4.0, 4.0], 4),
            planes(size, 2, fill, [near, far], 5),
        ]
    })
}
