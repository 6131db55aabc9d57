//! Polynomial expansion by normalised convolution, horizontal half: all moments of the certainty c with the
//! applicability g, and the least-squares solution `f ≈ xᵀA x + bᵀx + c`, of which A and b are kept.
//!
//! The solution minimises Σ g c (f − model)². Farnebäck, Two-frame motion estimation based on polynomial expansion,
//! SCIA 2003, section 2, with the separable Gaussian applicability of his thesis (2002). Its certainty is Σ g c.
//!
//! Where too little is known around a pixel, A, b and the certainty are 0. The criterion is each pivot of the
//! elimination against its diagonal element: the share of a term that the terms before it do not explain. With a
//! certainty of 1 that is at least ⅓. At the edge of a mask it is some 0.3, one pixel into the mask 0.09 and two pixels
//! 0.02 (radius 5, sigma 1.2), and the noise of b grows by 2, 5 and 12. Nothing is taken from under a share of 0.05,
//! which holds the growth of rounding under twentyfold, and the certainty fades in above it, so that nothing hangs on a
//! pivot's last digit.

use glam::{Mat4, Vec4};

use super::expansion_pair::fours;
use super::normalized_expansion_y::{self as normalized_y, CHANNELS, masked, powers};
use super::parallel_rows::{Band, Split, bands_of_three, dimensions, extend_row, repeat_last, weighted_sum};
use super::tables;
use super::test_inputs::{Fill, cases as each_fill};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the image and of the neighbourhood, and the conditions on it.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// The neighbourhood has `2 radius + 1` columns.
        radius: u32,
        /// The smallest share of each term that the terms before it may leave unexplained.
        min_share: f32,
        /// The least certainty of the whole neighbourhood, Σ g c.
        least_certainty: f32,
        /// The weight of columns outside the image: 1 repeats the border, 0 leaves them out.
        outside: f32,
    }
}

kernel!(
    "normalized_expansion_x" + ["image", "window", "least_squares"],
    reference(Params; moments, applicability) -> (quad, cross_term, expansion_certainty),
    cases: cases,
    tolerance: Tolerance {
        absolute: 0.0,
        relative: 1e-4,
        of_largest: 4e-5,
        reason: "as for the plain expansion, some tens of roundings of sums as large as the brightness; a pivot of a \
                 twentieth of its diagonal multiplies them by up to twenty",
    },
);

/// See the module's description.
const MIN_SHARE: f32 = 0.05;
/// Less is the far end of the applicability: a millionth of the neighbourhood.
const LEAST_CERTAINTY: f32 = 1e-6;

impl Params {
    /// The parameters for an image of this size, an applicability of this radius, and this weight of columns outside.
    pub fn new(size: Size, radius: u32, outside: f32) -> Self {
        let Size { width, height } = size;
        Self { width, height, radius, min_share: MIN_SHARE, least_certainty: LEAST_CERTAINTY, outside }
    }
}

/// Exponents of x and y in the basis 1, x, y, x², y², xy.
const BASIS: [[usize; 2]; 6] = [[0, 0], [1, 0], [0, 1], [2, 0], [0, 2], [1, 1]];
/// Sums of a pixel: 15 moments of the certainty and 6 of the image times it.
const SUMS: usize = 21;

/// The power of x and the channel of each sum: x from 0 to 4 for y⁰, to 3 for y¹ and so on, then those of the image.
const fn terms() -> [[usize; 2]; SUMS] {
    let mut terms = [[0; 2]; SUMS];
    let mut n = 0;
    let mut channel = 0;
    while channel < CHANNELS {
        let powers = if channel < 5 { 5 - channel } else { 8 - channel };
        let mut x = 0;
        while x < powers {
            terms[n] = [x, channel];
            n += 1;
            x += 1;
        }
        channel += 1;
    }
    terms
}

/// Where Σ xⁱ yʲ g c stands among the sums.
const MOMENT: [usize; 5] = [0, 5, 9, 12, 14];
/// Where Σ xⁱ yʲ g c f stands among the sums.
const PRODUCT: [usize; 3] = [15, 18, 20];

fn reference(
    p: &Params,
    moments: &[f32],
    applicability: &[f32],
    quad: &mut [f32],
    cross_term: &mut [f32],
    expansion_certainty: &mut [f32],
) {
    let (width, _, stride) = dimensions(p.width, p.height);
    let radius = p.radius as usize;
    let taps = 2 * radius + 1;
    let extended = stride + 2 * radius;
    let scratch = 5 * taps + CHANNELS * extended + SUMS * stride;
    let split = Split { second_row: stride, third_row: stride, scratch, ..Split::rows_of(4 * stride) };
    bands_of_three(
        [quad, cross_term, expansion_certainty],
        split,
        #[inline(always)]
        |band| {
            let Band { y0, out, second, third, scratch } = band;
            let (weights, scratch) = scratch.split_at_mut(5 * taps);
            let (columns, sums) = scratch.split_at_mut(CHANNELS * extended);
            powers(applicability, radius.next_multiple_of(4) - radius, radius, weights);
            let rows = out.chunks_exact_mut(4 * stride).zip(second.chunks_exact_mut(stride));
            for (i, ((quad, cross_term), certainty)) in rows.zip(third.chunks_exact_mut(stride)).enumerate() {
                for (channel, extended) in columns.chunks_exact_mut(extended).enumerate() {
                    extend_row(extended, &moments[(CHANNELS * (y0 + i) + channel) * stride..], width, radius);
                    extended[..radius].iter_mut().for_each(|value| *value *= p.outside);
                    extended[radius + width..].iter_mut().for_each(|value| *value *= p.outside);
                }
                for (sum, [power, channel]) in sums.chunks_exact_mut(stride).zip(terms()) {
                    let row = &columns[channel * extended..][..extended];
                    weighted_sum(sum, &weights[power * taps..][..taps], |k| &row[k..][..stride]);
                }
                for four in 0..stride / 4 {
                    let sum = |n: usize| Vec4::from_array(fours(sums)[n * (stride / 4) + four]);
                    let ([b_x, b_y, a_xx, a_yy, a_xy], known) = solve(p, sum);
                    for (x, pixel) in transpose([b_x, b_y, a_xx, a_yy]).into_iter().enumerate() {
                        quad[4 * (4 * four + x)..][..4].copy_from_slice(&pixel.to_array());
                    }
                    cross_term[4 * four..][..4].copy_from_slice(&a_xy.to_array());
                    certainty[4 * four..][..4].copy_from_slice(&known.to_array());
                }
                let pixels = quad.as_chunks_mut::<4>().0;
                let last = pixels[width - 1];
                pixels[width..].fill(last);
                repeat_last(cross_term, width);
                repeat_last(certainty, width);
            }
        },
    );
}

/// b_x, b_y, A_xx, A_yy, 2 A_xy and the certainty of four pixels, from their sums.
///
/// Elimination without square roots (LDLᵀ). Rounding is not worse for coordinates in pixels than for scaled ones:
/// scaling an unknown scales its row, its column and its pivot alike.
#[inline(always)]
#[allow(clippy::needless_range_loop, reason = "rows and columns of a matrix, numbered as in the textbook")]
fn solve(p: &Params, sum: impl Fn(usize) -> Vec4) -> ([Vec4; 5], Vec4) {
    let mut normal = [[Vec4::ZERO; 6]; 6];
    let mut right = [Vec4::ZERO; 6];
    for (i, [x, y]) in BASIS.into_iter().enumerate() {
        for (j, [other_x, other_y]) in BASIS.into_iter().enumerate() {
            normal[i][j] = sum(MOMENT[y + other_y] + x + other_x);
        }
        right[i] = sum(PRODUCT[y] + x);
    }
    let diagonal: [Vec4; 6] = std::array::from_fn(|k| normal[k][k]);
    let mut determined = diagonal[0].cmpgt(Vec4::splat(p.least_certainty));
    let mut share = Vec4::ONE;
    let mut factor = [[Vec4::ZERO; 6]; 6];
    for k in 0..6 {
        let pivot = normal[k][k];
        // A NaN pivot compares as false.
        determined &= pivot.cmpgt(p.min_share * diagonal[k]);
        share = share.min(pivot / diagonal[k]);
        for i in k + 1..6 {
            factor[i][k] = normal[i][k] / pivot;
            for j in k + 1..=i {
                normal[i][j] -= factor[i][k] * normal[j][k];
            }
            right[i] -= factor[i][k] * right[k];
        }
    }
    let mut solution = [Vec4::ZERO; 6];
    for k in (1..6).rev() {
        solution[k] = right[k] / normal[k][k];
        for i in k + 1..6 {
            solution[k] -= factor[i][k] * solution[i];
        }
    }
    let or_none = |value: Vec4| Vec4::select(determined, value, Vec4::ZERO);
    let fade = (share / p.min_share - 1.0).min(Vec4::ONE);
    let [_, expansion @ ..] = solution;
    (expansion.map(or_none), or_none(diagonal[0] * fade))
}

#[inline(always)]
fn transpose([a, b, c, d]: [Vec4; 4]) -> [Vec4; 4] {
    let turned = Mat4::from_cols(a, b, c, d).transpose();
    [turned.x_axis, turned.y_axis, turned.z_axis, turned.w_axis]
}

fn cases(size: Size) -> Vec<Case> {
    let all = [("repeated", 1.0), ("left out", 0.0)].map(|(name, outside)| {
        let cases = cases_of(size, outside);
        cases.into_iter().map(move |case| Case { name: format!("{}, border {name}", case.name), ..case })
    });
    all.into_iter().flatten().collect()
}

fn cases_of(size: Size, outside: f32) -> Vec<Case> {
    let params = Params::new(size, 5, outside);
    let applicability = tables::applicability(5, 1.2);
    let outputs = [4 * size.stride(), size.stride(), size.stride()];
    each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &outputs, size, |fill| {
        // Sums that no image has would make normal matrices that are not positive definite.
        let [weighted, certainty] = masked(size, fill);
        let weights = tables::applicability_from(&applicability.weights, 5);
        let mut moments = vec![0.0; CHANNELS * size.stride() * size.height as usize];
        let params = normalized_y::Params { width: size.width, height: size.height, radius: 5, outside };
        (normalized_y::KERNEL.reference)(
            bytemuck::bytes_of(&params),
            &[&weighted, &certainty, &weights],
            &mut [&mut moments],
        );
        vec![moments, tables::applicability_from(&applicability.weights, 8)]
    })
}
