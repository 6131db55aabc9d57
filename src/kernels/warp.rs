//! Samples the second image where the flow so far points, and the visibility of each place: the second image's
//! certainty, and 0 outside it.

use super::parallel_rows::{Split, bands, dimensions, repeat_last};
use super::test_inputs::{Fill, cases as each_fill, planes};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the images.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
    }
}

kernel!(
    "warp" + [],
    reference(Params; second, certainty, flow) -> (warped, shown),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-6,
        relative: 0.0,
        of_largest: 1.3e-4,
        reason: "a place's fraction has 2⁻¹⁴ px at 641, once along each axis, times the step between two pixels; and some \
                 roundings of the largest",
    },
);

fn reference(
    p: &Params,
    second: &[f32],
    certainty: &[f32],
    flow: &[f32],
    warped: &mut [f32],
    shown: &mut [f32],
) {
    let (width, height, stride) = dimensions(p.width, p.height);
    let split = Split { second_row: stride, dearer: 8, ..Split::rows_of(stride) };
    bands(warped, shown, split, #[inline(always)] |band| {
        let rows = band.out.chunks_exact_mut(stride).zip(band.second.chunks_exact_mut(stride));
        for (i, (warped, shown)) in rows.enumerate() {
            let y = band.y0 + i;
            let (u, v) = flow[2 * y * stride..][..2 * stride].split_at(stride);
            for x in 0..width {
                let (at_x, at_y) = (x as f32 + u[x], y as f32 + v[x]);
                let inside = at_x >= 0.0
                    && at_y >= 0.0
                    && at_x <= (width - 1) as f32
                    && at_y <= (height - 1) as f32;
                [warped[x], shown[x]] = match inside {
                    true => between(second, certainty, [at_x, at_y], [width, height, stride]),
                    false => [0.0; 2],
                };
            }
            repeat_last(warped, width);
            repeat_last(shown, width);
        }
    });
}

/// Both planes, sampled bilinearly at a place inside the image.
#[inline(always)]
fn between(
    second: &[f32],
    certainty: &[f32],
    [at_x, at_y]: [f32; 2],
    [width, height, stride]: [usize; 3],
) -> [f32; 2] {
    let (left, above) = (at_x as usize, at_y as usize);
    let (f_x, f_y) = (at_x - left as f32, at_y - above as f32);
    let (right, below) = ((left + 1).min(width - 1), (above + 1).min(height - 1));
    let places = [
        (above * stride + left, (1.0 - f_x) * (1.0 - f_y)),
        (above * stride + right, f_x * (1.0 - f_y)),
        (below * stride + left, (1.0 - f_x) * f_y),
        (below * stride + right, f_x * f_y),
    ];
    [second, certainty].map(|plane| {
        let [a, b, c, d] = places.map(|(at, weight)| weight * plane[at]);
        a + b + c + d
    })
}

fn cases(size: Size) -> Vec<Case> {
    let params = Params { width: size.width, height: size.height };
    let rows = [size.stride(), size.stride()];
    each_fill(Fill::ALL, bytemuck::bytes_of(&params), &rows, size, |fill| {
        // Flows of 0 keep whole places, where a wrong border shows; a flow of 10¹² is far outside.
        let flow = if fill == Fill::Extreme { [0.0, 1e12] } else { [-6.0, 6.0] };
        vec![
            planes(size, 1, fill, [0.0, 255.0], 1),
            planes(size, 1, Fill::Textured, [0.0, 1.0], 2),
            planes(size, 2, fill, flow, 3),
        ]
    })
}
