//! Each pixel's normal equations for its displacement, with the second frame read where the flow so far points.
//!
//! Farnebäck, Two-frame motion estimation based on polynomial expansion, SCIA 2003, section 3; the border's weights and
//! what happens outside the picture are OpenCV's.

use glam::{BVec4A, Mat4, UVec4, Vec4};

use super::cases::{Fill, cases as each_fill, planes, quads};
use super::rows::{Split, bands, dimensions};
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
    let second = Second { quad: fours(quad_1), cross_term: cross_term_1, width, height, stride };
    let split = Split { scratch: stride, ..Split::rows_of(5 * stride) };
    bands(equations, &mut [], split, #[inline(always)] |band| {
        for (x, weight) in band.scratch.iter_mut().enumerate() {
            *weight = border_weight(x.min(width - 1), width);
        }
        for (i, rows) in band.out.chunks_exact_mut(5 * stride).enumerate() {
            let y = band.y0 + i;
            let weight_y = border_weight(y, height);
            let (u, v) = fours(&flow[2 * y * stride..][..2 * stride]).split_at(stride / 4);
            let quad_0 = &fours(quad_0)[y * stride..][..stride];
            let cross_term_0 = &fours(cross_term_0)[y * stride / 4..][..stride / 4];
            let out = rows.as_chunks_mut::<4>().0;
            for four in 0..stride / 4 {
                let x = UVec4::new(0, 1, 2, 3) + 4 * four as u32;
                let d = [u[four], v[four]].map(Vec4::from_array);
                let second = second.at(x.min(UVec4::splat(p.width - 1)).as_vec4() + d[0], d[1] + y as f32);
                let quads = &quad_0[4 * four..][..4];
                let first = Expansions {
                    quad: transpose([0, 1, 2, 3].map(|i| Vec4::from_array(quads[i]))),
                    cross_term: Vec4::from_array(cross_term_0[four]),
                };
                let weight = weight_y * Vec4::from_array(fours(band.scratch)[four]);
                for (channel, values) in equations_of(&first, &second, d, weight).into_iter().enumerate() {
                    out[channel * (stride / 4) + four] = values.to_array();
                }
            }
        }
    });
}

#[inline(always)]
pub(super) fn fours(values: &[f32]) -> &[[f32; 4]] {
    values.as_chunks().0
}

#[inline(always)]
pub(super) fn transpose([a, b, c, d]: [Vec4; 4]) -> [Vec4; 4] {
    let turned = Mat4::from_cols(a, b, c, d).transpose();
    [turned.x_axis, turned.y_axis, turned.z_axis, turned.w_axis]
}

/// The expansions of four pixels.
pub(super) struct Expansions {
    /// b_x, b_y, A_xx, A_yy, each of four pixels.
    pub(super) quad: [Vec4; 4],
    /// 2 A_xy.
    pub(super) cross_term: Vec4,
}

/// Of four pixels, G = AᵀA and h = AᵀΔb with Δb = −½ (b2 − b1) + A d and A the mean of both: channels xx, xy, yy, x, y.
///
/// Where the second frame has no expansion, the first one's stands alone and says nothing of motion: b2 = b1 = 0.
#[inline(always)]
pub(super) fn equations_of(first: &Expansions, second: &(Expansions, BVec4A), d: [Vec4; 2], weight: Vec4) -> [Vec4; 5] {
    let (second, inside) = second;
    let or = |both: Vec4, alone: Vec4| Vec4::select(*inside, both, alone);
    let half = |c: usize| or(0.5 * (first.quad[c] - second.quad[c]), 0.5 * first.quad[c]);
    let mean = |c: usize| or(0.5 * (first.quad[c] + second.quad[c]), first.quad[c]);
    let (b_x, b_y, a_xx, a_yy) = (half(0), half(1), mean(2), mean(3));
    let a_xy = or(0.25 * (first.cross_term + second.cross_term), 0.5 * first.cross_term);
    let b_x = weight * (b_x + a_xx * d[0] + a_xy * d[1]);
    let b_y = weight * (b_y + a_xy * d[0] + a_yy * d[1]);
    let (a_xx, a_xy, a_yy) = (weight * a_xx, weight * a_xy, weight * a_yy);
    let g = [a_xx * a_xx + a_xy * a_xy, (a_xx + a_yy) * a_xy, a_yy * a_yy + a_xy * a_xy];
    let h = [a_xx * b_x + a_xy * b_y, a_xy * b_x + a_yy * b_y];
    // Equations that overflowed or were never numbers say nothing; zeros keep that from spreading.
    let size = g[0].abs() + g[1].abs() + g[2].abs() + h[0].abs() + h[1].abs();
    let known = size.cmple(Vec4::splat(1e30));
    [g[0], g[1], g[2], h[0], h[1]].map(|value| Vec4::select(known, value, Vec4::ZERO))
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
    /// The expansions at four places, and at which of them there are four pixels around the place. Elsewhere the
    /// expansion is numbers without meaning.
    #[inline(always)]
    fn at(&self, x: Vec4, y: Vec4) -> (Expansions, BVec4A) {
        let within = |at: Vec4, n: usize| at.cmpge(Vec4::ZERO) & at.cmplt(Vec4::splat((n - 1) as f32));
        // A place that is not a number is not inside either.
        let inside = within(x, self.width) & within(y, self.height);
        let (x, y) = (Vec4::select(inside, x, Vec4::ZERO), Vec4::select(inside, y, Vec4::ZERO));
        let (left, above) = (x.as_uvec4(), y.as_uvec4());
        let (fx, fy) = (x - left.as_vec4(), y - above.as_vec4());
        let (gx, gy) = (1.0 - fx, 1.0 - fy);
        let weights = transpose([gx * gy, fx * gy, gx * fy, fx * fy]);
        let first = above * self.stride as u32 + left;
        let mut quads = [Vec4::ZERO; 4];
        let mut cross_terms = [0.0; 4];
        for i in 0..4 {
            let first = first[i] as usize;
            let (right, below) = if inside.test(i) { (1, self.stride) } else { (0, 0) };
            let places = [first, first + right, first + below, first + below + right];
            let [a, b, c, d] = places.map(|at| Vec4::from_array(self.quad[at]));
            let w = weights[i];
            quads[i] = a * w.x + b * w.y + c * w.z + d * w.w;
            cross_terms[i] = Vec4::from_array(places.map(|at| self.cross_term[at])).dot(w);
        }
        (Expansions { quad: transpose(quads), cross_term: Vec4::from_array(cross_terms) }, inside)
    }
}

/// How much pixels near the border count: 0.14, 0.14, 0.4472, 0.4472, 0.4472, then 1.
#[inline(always)]
pub(super) fn border_weight(i: usize, n: usize) -> f32 {
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
