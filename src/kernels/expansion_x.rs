//! Polynomial expansion, horizontal half: the column moments are summed with the applicability times 1, x and x², and
//! give the least-squares solution `f ≈ xᵀA x + bᵀx + c`, of which A and b are kept.
//!
//! Farnebäck, Two-frame motion estimation based on polynomial expansion, SCIA 2003, section 2, with the separable
//! Gaussian applicability of his thesis (2002).

use super::expansion_y::power;
use super::parallel_rows::{Band, Split, bands, dimensions, extend_row, repeat_last, weighted_sum};
use super::tables;
use super::test_inputs::{Fill, cases as each_fill, planes};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the image, of the neighbourhood, and the inverse normal matrix.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// The neighbourhood has `2 radius + 1` columns.
        radius: u32,
        /// Element (x, x) of the inverse normal matrix.
        inv_x: f32,
        /// Element (1, x²).
        inv_1_xx: f32,
        /// Element (x², x²).
        inv_xx: f32,
        /// Element (xy, xy).
        inv_xy: f32,
    }
}

kernel!(
    "expansion_x" + ["image", "window"],
    reference(Params; moments, applicability) -> (quad, cross_term),
    cases: cases,
    tolerance: Tolerance {
        absolute: 0.0,
        relative: 1e-5,
        of_largest: 2e-5,
        reason: "A_xx is a difference of sums as large as the brightness: some tens of roundings of it",
    },
);

impl Params {
    /// The parameters for an image of this size and an applicability of this radius.
    pub fn new(size: Size, radius: u32, applicability: &tables::Applicability) -> Self {
        let tables::Applicability { inv_x, inv_1_xx, inv_xx, inv_xy, .. } = *applicability;
        Self { width: size.width, height: size.height, radius, inv_x, inv_1_xx, inv_xx, inv_xy }
    }
}

fn reference(p: &Params, moments: &[f32], applicability: &[f32], quad: &mut [f32], cross_term: &mut [f32]) {
    let (width, _, stride) = dimensions(p.width, p.height);
    let radius = p.radius as usize;
    let taps = 2 * radius + 1;
    let extended = width + 2 * radius;
    let scratch = 3 * taps + 3 * extended + 6 * width;
    let split = Split { second_row: stride, scratch, ..Split::rows_of(4 * stride) };
    bands(quad, cross_term, split, #[inline(always)] |band| {
        let Band { y0, out, second, scratch, .. } = band;
        let (weights, scratch) = scratch.split_at_mut(3 * taps);
        let (columns, sums) = scratch.split_at_mut(3 * extended);
        for (n, weights) in weights.chunks_exact_mut(taps).enumerate() {
            power(applicability, radius.next_multiple_of(4) - radius, n, weights);
        }
        let [g, xg, xxg] = [0, 1, 2].map(|n| &weights[n * taps..][..taps]);
        for (i, (quad, cross_term)) in out.chunks_exact_mut(4 * stride).zip(second.chunks_exact_mut(stride)).enumerate() {
            for (channel, extended) in columns.chunks_exact_mut(extended).enumerate() {
                extend_row(extended, &moments[(3 * (y0 + i) + channel) * stride..], width, radius);
            }
            let [f, fy, fyy] = [0, 1, 2].map(|channel| &columns[channel * extended..][..extended]);
            let terms = [(f, g), (f, xg), (f, xxg), (fy, g), (fy, xg), (fyy, g)];
            for (sum, (row, weights)) in sums.chunks_exact_mut(width).zip(terms) {
                weighted_sum(sum, weights, |k| &row[k..][..width]);
            }
            solve(p, sums, width, quad, cross_term);
        }
    });
}

/// From a row of moments to a row of expansions.
#[inline(always)]
fn solve(p: &Params, sums: &[f32], width: usize, quad: &mut [f32], cross_term: &mut [f32]) {
    let [m_1, m_x, m_xx, m_y, m_xy, m_yy] = [0, 1, 2, 3, 4, 5].map(|i| &sums[i * width..][..width]);
    let (quad, _) = quad.as_chunks_mut::<4>();
    for x in 0..width {
        quad[x] = [
            p.inv_x * m_x[x],
            p.inv_x * m_y[x],
            p.inv_1_xx * m_1[x] + p.inv_xx * m_xx[x],
            p.inv_1_xx * m_1[x] + p.inv_xx * m_yy[x],
        ];
        cross_term[x] = p.inv_xy * m_xy[x];
    }
    let last = quad[width - 1];
    quad[width..].fill(last);
    repeat_last(cross_term, width);
}

fn cases(size: Size) -> Vec<Case> {
    let applicability = tables::applicability(5, 1.2);
    let params = Params::new(size, 5, &applicability);
    each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &[4 * size.stride(), size.stride()], size, |fill| {
        vec![planes(size, 3, fill, [0.0, 255.0], 3), tables::applicability_from(&applicability.weights, 8)]
    })
}
