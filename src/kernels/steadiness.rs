//! The agreement of each pixel, less where the flow bends: times 1 / √(1 + |Δd|² / τ²), where Δ is the Laplacian and τ = 0.1 px.
//!
//! Where nothing but noise is seen, the flow follows the noise and is made of small blots. A flow that is right bends at
//! the borders of things, where it errs most, and hardly between them. At the image's border a direction without two
//! neighbours adds nothing.

use super::parallel_rows::{Split, bands, dimensions, repeat_last};
use super::test_inputs::{Fill, cases as each_fill, planes};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the image.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
    }
}

kernel!(
    "steadiness" + [],
    reference(Params; agreement, flow) -> (steady),
    cases: cases,
    tolerance: Tolerance {
        absolute: 4e-5,
        relative: 1e-5,
        of_largest: 0.0,
        reason: "a Laplacian is a difference of displacements up to 6 px, with roundings of 10⁻⁶ px, of which the result takes \
                 up to four times as much per px",
    },
);

/// 1 / τ², in px⁻².
const BEND: f32 = 100.0;

fn reference(p: &Params, agreement: &[f32], flow: &[f32], steady: &mut [f32]) {
    let (width, height, stride) = dimensions(p.width, p.height);
    bands(steady, &mut [], Split { dearer: 4, ..Split::rows_of(stride) }, #[inline(always)] |band| {
        for (i, out) in band.out.chunks_exact_mut(stride).enumerate() {
            let y = band.y0 + i;
            let row = |y: usize, channel: usize| &flow[(2 * y + channel) * stride..][..width];
            // Its own row in place of a missing one: the weight below takes both off.
            let (above, below) = (y.saturating_sub(1), (y + 1).min(height - 1));
            let upright = if below - above == 2 { 1.0 } else { 0.0 };
            let rows = [0, 1].map(|channel| [row(above, channel), row(y, channel), row(below, channel)]);
            let agreement = &agreement[y * stride..][..width];
            let bend = |x: usize, sideways: f32| {
                let [u, v] = rows.map(|[above, here, below]| {
                    let (left, right) = (here[x.saturating_sub(1)], here[(x + 1).min(width - 1)]);
                    let twice = 2.0 * here[x];
                    sideways * (left + right - twice) + upright * (above[x] + below[x] - twice)
                });
                u * u + v * v
            };
            out[0] = damped(agreement[0], bend(0, 0.0));
            for x in 1..width.max(2) - 1 {
                out[x] = damped(agreement[x], bend(x, 1.0));
            }
            out[width - 1] = damped(agreement[width - 1], bend(width - 1, 0.0));
            repeat_last(out, width);
        }
    });
}

#[inline(always)]
fn damped(agreement: f32, squared_bend: f32) -> f32 {
    agreement / (1.0 + BEND * squared_bend).sqrt()
}

fn cases(size: Size) -> Vec<Case> {
    let params = Params { width: size.width, height: size.height };
    let mut cases = each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &[size.stride()], size, |fill| {
        vec![planes(size, 1, fill, [0.0, 1.0], 1), planes(size, 2, fill, [-6.0, 6.0], 2)]
    });
    // Bends of about τ, where the result depends on them most.
    let mut slight = cases[1].clone();
    slight.name = "slight".to_owned();
    slight.inputs[1] = planes(size, 2, Fill::Textured, [-0.05, 0.05], 2);
    cases.push(slight);
    cases
}
