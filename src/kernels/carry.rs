//! Draws a flow towards the previous pair's, and keeps the result for the next pair.
//!
//! What moves by d now was at x − d one pair ago, and moved there by m, the flow that was found then (of a flow that leads
//! back, at x + d). d becomes d + k (m − d), with k = weight / (1 + |m − d|² / τ²), which averages noise over time and lets go
//! where the motion changes: the weight of a Geman–McClure estimator's kind (Black and Anandan, Robust dynamic motion
//! estimation over time, CVPR 1991). Without a previous flow, which has zeros in its third channel, and where the place is
//! outside, d stays.

use super::parallel_rows::{Split, bands, dimensions, repeat_last};
use super::test_inputs::{Fill, cases as each_fill, planes};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the flow, the direction of time, and the weight of the previous flow.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// What multiplies the flow on the way to the place in the previous one: −1 for a flow from the earlier frame to the
        /// later one, 1 for one that leads back.
        sense: f32,
        /// The weight of the previous flow where it equals the new one, 0 to 1.
        weight: f32,
        /// 1/τ²: the inverse of the squared difference at which the weight is half of that.
        inverse: f32,
    }
}

kernel!(
    "carry" + [],
    reference(Params; flow, previous) -> (drawn, kept),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-5,
        relative: 0.0,
        of_largest: 2e-4,
        reason: "a place's fraction has 2⁻¹⁴ px at 641, once along each axis, times the step between two pixels, which is up \
                 to twice the largest; the weight changes by less than the difference itself",
    },
);

fn reference(p: &Params, flow: &[f32], previous: &[f32], drawn: &mut [f32], kept: &mut [f32]) {
    let (width, height, stride) = dimensions(p.width, p.height);
    let split = Split { second_row: 3 * stride, dearer: 4, ..Split::rows_of(2 * stride) };
    bands(drawn, kept, split, #[inline(always)] |band| {
        let rows = band.out.chunks_exact_mut(2 * stride).zip(band.second.chunks_exact_mut(3 * stride));
        for (i, (rows, kept)) in rows.enumerate() {
            let y = band.y0 + i;
            let (out_u, out_v) = rows.split_at_mut(stride);
            let (u, v) = flow[2 * y * stride..][..2 * stride].split_at(stride);
            let has_previous = &previous[(3 * y + 2) * stride..][..stride];
            for x in 0..width {
                let d = [u[x], v[x]];
                let place = [x as f32 + p.sense * d[0], y as f32 + p.sense * d[1]];
                let inside = (0.0..=(width - 1) as f32).contains(&place[0])
                    & (0.0..=(height - 1) as f32).contains(&place[1]);
                [out_u[x], out_v[x]] = if inside && has_previous[x] > 0.0 {
                    let m = bilinear(previous, [width, height, stride], place);
                    let change = [m[0] - d[0], m[1] - d[1]];
                    let far = change[0] * change[0] + change[1] * change[1];
                    let k = p.weight / (1.0 + far * p.inverse);
                    if far <= 1e30 { [d[0] + k * change[0], d[1] + k * change[1]] } else { d }
                } else {
                    d
                };
            }
            repeat_last(out_u, width);
            repeat_last(out_v, width);
            kept[..stride].copy_from_slice(out_u);
            kept[stride..2 * stride].copy_from_slice(out_v);
            kept[2 * stride..].fill(1.0);
        }
    });
}

/// The previous flow at a place inside.
#[inline(always)]
fn bilinear(previous: &[f32], [width, height, stride]: [usize; 3], [x, y]: [f32; 2]) -> [f32; 2] {
    let (left, above) = (x as usize, y as usize);
    let (right, below) = ((left + 1).min(width - 1), (above + 1).min(height - 1));
    let (fx, fy) = (x - left as f32, y - above as f32);
    [0, 1].map(|channel| {
        let row = |y: usize| &previous[(3 * y + channel) * stride..][..stride];
        let along = |row: &[f32]| (1.0 - fx) * row[left] + fx * row[right];
        (1.0 - fy) * along(row(above)) + fy * along(row(below))
    })
}

fn cases(size: Size) -> Vec<Case> {
    let all = [("forward", -1.0, 1.0), ("backward", 1.0, 1.0), ("none", -1.0, 0.0)];
    let all = all.map(|(name, sense, present)| {
        let params = Params { width: size.width, height: size.height, sense, weight: 0.5, inverse: 0.25 };
        let rows = [2 * size.stride(), 3 * size.stride()];
        let cases = each_fill(Fill::ALL, bytemuck::bytes_of(&params), &rows, size, |fill| {
            // Flows of 0 keep whole places, where a wrong border shows.
            let far = if fill == Fill::Extreme { [0.0, 1e12] } else { [-3.0, 3.0] };
            let mut previous = planes(size, 3, fill, [-3.0, 3.0], 2);
            for row in previous.chunks_exact_mut(size.stride()).skip(2).step_by(3) {
                row.fill(present);
            }
            vec![planes(size, 2, fill, far, 1), previous]
        });
        cases.into_iter().map(move |case| Case { name: format!("{}, {name}", case.name), ..case })
    });
    all.into_iter().flatten().collect()
}
