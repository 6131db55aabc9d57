//! Multiplies an image by the certainty of its pixels, and clamps that certainty to 0 to 1.
//!
//! Smoothing and reducing both alike is normalised averaging: the quotient of the two is the average of the known
//! pixels. Knutsson and Westin, Normalized and differential convolution, CVPR 1993. The quotient is never taken here,
//! for the expansion weighs each value by its certainty again.

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
    "premultiply" + ["image"],
    reference(Params; gray, certainty) -> (weighted_gray, clamped_certainty),
    cases: cases,
    tolerance: Tolerance { absolute: 0.0, relative: 0.0, of_largest: 0.0, reason: "one rounded product on both sides" },
);

fn reference(
    p: &Params,
    gray: &[f32],
    certainty: &[f32],
    weighted_gray: &mut [f32],
    clamped_certainty: &mut [f32],
) {
    let (width, _, stride) = dimensions(p.width, p.height);
    let split = Split { second_row: stride, ..Split::rows_of(stride) };
    bands(
        weighted_gray,
        clamped_certainty,
        split,
        #[inline(always)]
        |band| {
            for (i, (weighted, clamped)) in
                band.out.chunks_exact_mut(stride).zip(band.second.chunks_exact_mut(stride)).enumerate()
            {
                let start = (band.y0 + i) * stride;
                for x in 0..width {
                    let (f, c) = (gray[start + x], certainty[start + x]);
                    // NaN compares as false with everything, so it is unknown.
                    let known = c > 0.0 && f.abs() <= 1e30;
                    clamped[x] = if known { c.min(1.0) } else { 0.0 };
                    weighted[x] = if known { clamped[x] * f } else { 0.0 };
                }
                repeat_last(weighted, width);
                repeat_last(clamped, width);
            }
        },
    );
}

fn cases(size: Size) -> Vec<Case> {
    let params = Params { width: size.width, height: size.height };
    let outputs = [size.stride(), size.stride()];
    let mut cases = each_fill(Fill::ALL, bytemuck::bytes_of(&params), &outputs, size, |fill| {
        // Certainties beyond their range are the caller's mistake and must do no harm.
        vec![planes(size, 1, fill, [0.0, 65535.0], 7), planes(size, 1, fill, [-0.5, 1.5], 8)]
    });
    for (value, case) in [f32::INFINITY, f32::NEG_INFINITY, f32::NAN, 1e38].into_iter().zip(&mut cases) {
        // The first pixel of the certainty, and the second of the image where there is one, in every row.
        let stride = size.stride();
        case.inputs[1].iter_mut().step_by(stride).for_each(|c| *c = value);
        case.inputs[0].iter_mut().skip(1).step_by(stride).for_each(|f| *f = value);
    }
    cases
}
