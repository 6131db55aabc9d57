//! Each pixel's normal equations for its displacement, weighted by how certain the expansions of both frames are.
//!
//! As [`super::matrices`], with the equations weighted by the certainty of the first frame's pixel times that of the place
//! in the second frame. Where the second frame has no pixel there, that counts as certain as the first's: equations of
//! inside and outside then keep their proportion when all certainty is halved. The second frame is read by
//! normalised interpolation, each of the four pixels around a place by its bilinear weight times its certainty, so that
//! those without an expansion do not draw it towards zero.
//!
//! Farnebäck, Two-frame motion estimation based on polynomial expansion, SCIA 2003, section 3; Knutsson and Westin,
//! Normalized and differential convolution, CVPR 1993.

use glam::{BVec4A, UVec4, Vec4};

use super::cases::{Fill, cases as each_fill, planes, quads};
use super::matrices::{Expansions, border_weight, equations_of, fours, transpose};
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
    "certain_matrices" + ["image", "equations"],
    reference(
        Params; quad_0, cross_term_0, certainty_0, quad_1, cross_term_1, certainty_1, flow
    ) -> (equations),
    cases: cases,
    tolerance: Tolerance {
        absolute: 8e-3,
        relative: 1e-4,
        reason: "as for the equations without certainty: a place's fraction has 2⁻¹⁴ px at 641, the expansions differ by \
                 up to 40 from pixel to pixel in these cases, and h sums products of two of them and of the flow; twice \
                 that, for the weight of the place has the same error again",
    },
);

/// Equations of less certainty are left out, for their expansion is a quotient of two numbers near zero.
const LEAST_CERTAINTY: f32 = 1e-6;

#[allow(clippy::too_many_arguments, reason = "one for each buffer, as in the shader")]
fn reference(
    p: &Params,
    quad_0: &[f32],
    cross_term_0: &[f32],
    certainty_0: &[f32],
    quad_1: &[f32],
    cross_term_1: &[f32],
    certainty_1: &[f32],
    flow: &[f32],
    equations: &mut [f32],
) {
    let (width, height, stride) = dimensions(p.width, p.height);
    let second = Second {
        quad: fours(quad_1),
        cross_term: cross_term_1,
        certainty: certainty_1,
        width,
        height,
        stride,
    };
    let split = Split { scratch: stride, ..Split::rows_of(5 * stride) };
    bands(
        equations,
        &mut [],
        split,
        #[inline(always)]
        |band| {
            for (x, weight) in band.scratch.iter_mut().enumerate() {
                *weight = border_weight(x.min(width - 1), width);
            }
            for (i, rows) in band.out.chunks_exact_mut(5 * stride).enumerate() {
                let y = band.y0 + i;
                let border_y = border_weight(y, height);
                let (u, v) = fours(&flow[2 * y * stride..][..2 * stride]).split_at(stride / 4);
                let quad_0 = &fours(quad_0)[y * stride..][..stride];
                let [cross_term_0, certainty_0] =
                    [cross_term_0, certainty_0].map(|plane| &fours(plane)[y * stride / 4..][..stride / 4]);
                let out = rows.as_chunks_mut::<4>().0;
                for four in 0..stride / 4 {
                    let x = (UVec4::new(0, 1, 2, 3) + 4 * four as u32).min(UVec4::splat(p.width - 1));
                    let d = [u[four], v[four]].map(Vec4::from_array);
                    let (second, certainty_1) = second.at(x.as_vec4() + d[0], d[1] + y as f32);
                    let first = Expansions {
                        quad: transpose([0, 1, 2, 3].map(|i| Vec4::from_array(quad_0[4 * four + i]))),
                        cross_term: Vec4::from_array(cross_term_0[four]),
                    };
                    let border = border_y * Vec4::from_array(fours(band.scratch)[four]);
                    let certainty_0 = Vec4::from_array(certainty_0[four]);
                let certainty = certainty_0 * Vec4::select(second.1, certainty_1, certainty_0);
                    let known = certainty.cmpgt(Vec4::splat(LEAST_CERTAINTY));
                    for (channel, values) in equations_of(&first, &second, d, border).into_iter().enumerate()
                    {
                        out[channel * (stride / 4) + four] =
                            Vec4::select(known, certainty * values, Vec4::ZERO).to_array();
                    }
                }
            }
        },
    );
}

/// The second frame's expansion and its certainty, to be read between pixels.
struct Second<'a> {
    quad: &'a [[f32; 4]],
    cross_term: &'a [f32],
    certainty: &'a [f32],
    width: usize,
    height: usize,
    stride: usize,
}

impl Second<'_> {
    /// The expansions at four places, at which of them there are four pixels around the place, and how certain they are.
    ///
    /// Elsewhere they are numbers without meaning.
    #[inline(always)]
    fn at(&self, x: Vec4, y: Vec4) -> ((Expansions, BVec4A), Vec4) {
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
        let mut cross_terms = Vec4::ZERO;
        let mut certainties = Vec4::ZERO;
        for i in 0..4 {
            let first = first[i] as usize;
            let (right, below) = if inside.test(i) { (1, self.stride) } else { (0, 0) };
            let places = [first, first + right, first + below, first + below + right];
            let [a, b, c, d] = places.map(|at| Vec4::from_array(self.quad[at]));
            let w = weights[i] * Vec4::from_array(places.map(|at| self.certainty[at]));
            let sum = w.dot(Vec4::ONE);
            quads[i] = (a * w.x + b * w.y + c * w.z + d * w.w) / sum;
            cross_terms[i] = Vec4::from_array(places.map(|at| self.cross_term[at])).dot(w) / sum;
            certainties[i] = sum;
        }
        let expansions = Expansions { quad: transpose(quads), cross_term: cross_terms };
        ((expansions, inside), certainties)
    }
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
            planes(size, 1, fill, [0.0, 1.0], 6),
            quads(size, fill, ranges, 3),
            planes(size, 1, fill, [-4.0, 4.0], 4),
            planes(size, 1, fill, [0.0, 1.0], 7),
            planes(size, 2, fill, [near, far], 5),
        ]
    })
}
