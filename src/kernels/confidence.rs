//! The confidence of each pixel's flow: rows of the evidence, already averaged along columns, are averaged, and their
//! predicted standard error is mapped to 0 to 1.
//!
//! The equations `A d = Δb` of a window's pixels determine d by least squares. The residual of Δb under the estimated
//! flow is their noise, of variance r. The least eigenvalue λ of the mean of AᵀA is the curvature in the worst
//! determined direction. So the error in that direction has a standard deviation of about `σ = √((r + 0.001) / λ)`
//! pixels, where 0.001 stands for the rounding to whole gray levels. The confidence is `0.25 / (0.25 + σ)`, times the
//! share of the window that both frames show: 1 where the flow is certain, ½ at σ = ¼ pixel, 0 without any texture.

use super::solve::{average, equations};
use super::test_inputs::{Fill, cases as each_fill};
pub use super::solve::Params;
use super::tables;
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel};

const NOISE: f32 = 0.001;
const HALF: f32 = 0.25;
const SMALLEST: f32 = 1e-6;

kernel!(
    "confidence" + ["image", "window", "average", "confidence"],
    reference(Params; columns, window) -> (confidence),
    cases: cases,
    tolerance: Tolerance {
        absolute: 2e-3,
        relative: 0.0, of_largest: 0.0,
        reason: "the least eigenvalue is a difference: with eigenvalues in a ratio of some hundred it keeps four digits, \
                 and where all are 0 its rounding stands beside 10⁻⁶",
    },
);

fn reference(p: &Params, columns: &[f32], window: &[f32], confidence: &mut [f32]) {
    let width = p.width as usize;
    average(p, columns, window, confidence, 1, #[inline(always)] |_, averages, row| {
        for x in 0..width {
            row[x] = confidence_of(averages.map(|average| average[x]));
        }
    });
}

/// The confidence of evidence: the mean of AᵀA (xx, xy, yy), the mean square of the residual of Δb, and the share that
/// both frames show.
#[inline(always)]
pub(super) fn confidence_of([g_xx, g_xy, g_yy, rest, coverage]: [f32; 5]) -> f32 {
    let half_difference = 0.5 * (g_xx - g_yy);
    let root = (half_difference * half_difference + g_xy * g_xy).sqrt();
    let weakest = 0.5 * (g_xx + g_yy) - root;
    let error = ((rest + NOISE) / weakest.max(SMALLEST)).sqrt();
    coverage.clamp(0.0, 1.0) * HALF / (HALF + error)
}

/// The confidence of that evidence along a direction e, of any length but 0.
#[inline(always)]
pub(super) fn confidence_along([g_xx, g_xy, g_yy, rest, coverage]: [f32; 5], e: [f32; 2]) -> f32 {
    // Keeps the inverse bounded where the texture has one direction, or none.
    let ridge = 1e-3 * (g_xx + g_yy) + SMALLEST;
    let (xx, yy) = (g_xx + ridge, g_yy + ridge);
    let spread = (e[0] * e[0] * yy - 2.0 * e[0] * e[1] * g_xy + e[1] * e[1] * xx)
        / ((e[0] * e[0] + e[1] * e[1]) * (xx * yy - g_xy * g_xy));
    let error = ((rest + NOISE) * spread).sqrt();
    coverage.clamp(0.0, 1.0) * HALF / (HALF + error)
}

/// The equations of `solve`, whose right-hand sides stand in, made positive, for residual and coverage.
fn cases(size: Size) -> Vec<Case> {
    let params = Params { width: size.width, height: size.height, radius: 6 };
    each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &[size.stride()], size, |fill| {
        let mut evidence = equations(size, fill);
        for rows in evidence.chunks_exact_mut(5 * size.stride()) {
            for value in &mut rows[3 * size.stride()..] {
                *value = value.abs().min(10.0) * 0.1;
            }
        }
        vec![evidence, tables::window_from(&tables::window(13, false), 8)]
    })
}
