//! The weight with which each pixel's flow is held to its neighbours': low where the flow's slopes differ from the expected
//! ones, and at edges of the image.
//!
//! That is the weight of a total variation of the flow's deviation from its expected slopes, 1 / √(‖∇d − t‖² + ε²) (Rudin,
//! Osher and Fatemi, Physica D 1992; expected slopes after Bredies, Kunisch and Pock, Total generalized variation, SIAM J.
//! Imaging Sciences 2010), times what an edge of the image takes off.

use super::expansion_pair::fours;
use super::parallel_rows::{Split, bands, dimensions, repeat_last};
use super::slope_weights::{four_rows, slopes_of_row};
use super::test_inputs::{Fill, cases as each_fill, planes, quads};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the image, and the weights' form.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// α: the weight of smoothness against that of the equations, above 0.
        alpha: f32,
        /// β: the share of the weight that is left at the steepest edge of the image, 0 to 1.
        beta: f32,
        /// 1 / τ²: the inverse square of the image's slope, in gray levels per pixel, at which an edge takes half.
        edge: f32,
        /// ε²: the squared deviation of the slopes up to which the weight is nearly constant, above 0.
        robust: f32,
    }
}

kernel!(
    "smoothness" + ["slopes"],
    reference(Params; flow, slope, quad) -> (smooth_weight),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-6,
        relative: 2e-4,
        of_largest: 1e-6,
        reason: "a slope of the flow is a difference, of which expected slopes are taken off: of 2 px some 10⁻⁷ px are left, \
                 which a deviation of ε, .005, has a thousand times",
    },
);

fn reference(p: &Params, flow: &[f32], slope: &[f32], quad: &[f32], smooth_weight: &mut [f32]) {
    let (width, height, stride) = dimensions(p.width, p.height);
    let quad = fours(quad);
    let split = Split { scratch: 4 * stride, dearer: 4, ..Split::rows_of(stride) };
    bands(smooth_weight, &mut [], split, #[inline(always)] |band| {
        for (i, row) in band.out.chunks_exact_mut(stride).enumerate() {
            let y = band.y0 + i;
            slopes_of_row(flow, y, [width, height, stride], band.scratch);
            let [ux, uy, vx, vy] = four_rows(band.scratch, 0, stride).map(|row| &row[..width]);
            let [tux, tuy, tvx, tvy] = four_rows(slope, y, stride).map(|row| &row[..width]);
            let (quad, out) = (&quad[y * stride..][..width], &mut row[..width]);
            for x in 0..width {
                let [b_x, b_y, ..] = quad[x];
                let edge = p.beta + (1.0 - p.beta) / (1.0 + (b_x * b_x + b_y * b_y) * p.edge);
                let [p0, p1, p2, p3] = [ux[x] - tux[x], uy[x] - tuy[x], vx[x] - tvx[x], vy[x] - tvy[x]];
                out[x] = p.alpha * edge / (p0 * p0 + p1 * p1 + p2 * p2 + p3 * p3 + p.robust).sqrt();
            }
            repeat_last(row, width);
        }
    });
}

fn cases(size: Size) -> Vec<Case> {
    let params = Params {
        width: size.width,
        height: size.height,
        alpha: 1.5,
        beta: 0.1,
        edge: 1.0 / 225.0,
        robust: 25e-6,
    };
    let ranges = [[-20.0, 20.0], [-20.0, 20.0], [-4.0, 4.0], [-4.0, 4.0]];
    let mut cases = each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &[size.stride()], size, |fill| {
        vec![
            planes(size, 2, fill, [-2.0, 2.0], 1),
            planes(size, 4, fill, [-0.5, 0.5], 2),
            quads(size, fill, ranges, 3),
        ]
    });
    // A flow with just the expected slopes, where ε decides.
    let mut expected = cases[0].clone();
    expected.name = "expected".to_owned();
    expected.inputs[1].fill(0.0);
    cases.push(expected);
    cases
}
