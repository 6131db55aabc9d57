//! Two red-black sweeps of over-relaxation on the equations of [`super::links`]: all pixels of even x + y, then all odd ones,
//! twice.
//!
//! Successive over-relaxation (Young, Iterative methods for solving partial difference equations of elliptic type, 1954): a
//! pixel goes ω times the way to the flow that its equations ask for while its neighbours stay. As the neighbours of an even
//! pixel are odd, the order within a colour does not matter. The shader does all of it on tiles, each with a rim of four
//! pixels, from which nothing reaches a tile's own pixels in four half sweeps.

use super::links::definite;
use super::parallel_rows::{Split, bands, dimensions, repeat_last};
use super::test_inputs::{Fill, cases as each_fill, planes};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the image, and the relaxation.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// ω, in (0, 2).
        omega: f32,
    }
}

kernel!(
    "sweep" + [],
    reference(Params; system, link, flow) -> (relaxed),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-6,
        relative: 0.0,
        of_largest: 2e-5,
        reason: "each half sweep adds some ten roundings of the largest, and with ω near 2 multiplies those before by up to \
                 three",
    },
);

/// Sweeps per run.
pub const SWEEPS: u32 = 2;
/// Half sweeps per run, which is how far a pixel's influence reaches.
const HALF_SWEEPS: usize = 2 * SWEEPS as usize;

fn reference(p: &Params, system: &[f32], link: &[f32], flow: &[f32], relaxed: &mut [f32]) {
    let (width, height, stride) = dimensions(p.width, p.height);
    // Rows of a band and of its rim, each with a value before and behind, and four rows of room.
    let padded = stride + 2;
    let split = Split { row: 2 * stride, fewest_rows: 64, ..Split::default() };
    let split = Split { scratch: 2 * padded * (split.most_rows(height) + 2 * HALF_SWEEPS) + 3 * stride + 1, ..split };
    bands(relaxed, &mut [], split, #[inline(always)] |band| {
        let rows = band.out.len() / (2 * stride);
        let first = band.y0.saturating_sub(HALF_SWEEPS);
        let end = (band.y0 + rows + HALF_SWEEPS).min(height);
        let (room, flows) = band.scratch.split_at_mut(3 * stride + 1);
        // ω for every other column; from the second one on it is that of the other colour.
        for (x, omega) in room[2 * stride..].iter_mut().enumerate() {
            *omega = if x % 2 == 0 { p.omega } else { 0.0 };
        }
        for (y, flows) in (first..end).zip(flows.chunks_exact_mut(2 * padded)) {
            for (channel, row) in flows.chunks_exact_mut(padded).enumerate() {
                row[0] = 0.0;
                row[1..=width].copy_from_slice(&flow[(2 * y + channel) * stride..][..width]);
                row[width + 1..].fill(0.0);
            }
        }
        for half in 0..HALF_SWEEPS {
            // The rim shrinks by a row with each half sweep, except where the image ends.
            let from = if first == 0 { 0 } else { first + half + 1 };
            let to = if end == height { height } else { end - half - 1 };
            for y in from..to {
                row_of_colour(y, half, [system, link], [first, height, width, stride], flows, room);
            }
        }
        for (i, rows) in band.out.chunks_exact_mut(2 * stride).enumerate() {
            let flows = &flows[2 * padded * (band.y0 + i - first)..][..2 * padded];
            for (row, flow) in rows.chunks_exact_mut(stride).zip(flows.chunks_exact(padded)) {
                row[..width].copy_from_slice(&flow[1..=width]);
                repeat_last(row, width);
            }
        }
    });
}

/// Relaxes the pixels of row `y` whose x + y has the parity of `half`. The other ones are computed with them, so that
/// neighbours are processed alike, and thrown away.
#[inline(always)]
fn row_of_colour(
    y: usize,
    half: usize,
    [system, link]: [&[f32]; 2],
    [first, height, width, stride]: [usize; 4],
    flows: &mut [f32],
    room: &mut [f32],
) {
    let padded = stride + 2;
    let of_row = |y: usize, channel: usize| (2 * (y - first) + channel) * padded;
    let right = &link[2 * y * stride..][..width];
    let down = &link[(2 * y + 1) * stride..][..width];
    // There is no link across the border; then any row will do.
    let (above, below) = (if y > first { y - 1 } else { y }, if y + 1 < height { y + 1 } else { y });
    let up = match y.checked_sub(1) {
        Some(above) => &link[(2 * above + 1) * stride..][..width],
        None => &link[(2 * height - 1) * stride..][..width],
    };
    let [xx, xy, yy, c_x, c_y] = [0, 1, 2, 3, 4].map(|channel| &system[(5 * y + channel) * stride..][..width]);
    for (channel, c) in [c_x, c_y].into_iter().enumerate() {
        let pulled = &mut room[channel * stride..][..width];
        let row = |y: usize| &flows[of_row(y, channel)..][..padded];
        let (here, above, below) = (row(y), &row(above)[1..=width], &row(below)[1..=width]);
        let (before, next) = (&here[..width], &here[2..][..width]);
        pulled[0] = c[0] + right[0] * next[0] + down[0] * below[0] + up[0] * above[0];
        for x in 1..width {
            pulled[x] =
                c[x] + right[x] * next[x] + right[x - 1] * before[x] + down[x] * below[x] + up[x] * above[x];
        }
    }
    let [pulled_x, pulled_y] = [0, 1].map(|channel| &room[channel * stride..][..width]);
    let omegas = &room[2 * stride + ((y + half) & 1)..][..width];
    let (rows_before, rows) = flows.split_at_mut(of_row(y, 1));
    let u = &mut rows_before[of_row(y, 0) + 1..][..width];
    let v = &mut rows[1..][..width];
    for x in 0..width {
        let (omega, a, b) = (omegas[x], pulled_x[x], pulled_y[x]);
        u[x] += omega * (xx[x] * a + xy[x] * b - u[x]);
        v[x] += omega * (xy[x] * a + yy[x] * b - v[x]);
    }
}

fn cases(size: Size) -> Vec<Case> {
    let params = Params { width: size.width, height: size.height, omega: 1.95 };
    each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &[2 * size.stride()], size, |fill| {
        let flow = planes(size, 2, fill, [-6.0, 6.0], 2);
        let shape = super::links::Params { width: size.width, height: size.height };
        let inputs =
            [definite(size, 1), flow.clone(), planes(size, 1, fill, [0.5, 20.0], 3), planes(size, 4, fill, [-0.5, 0.5], 4)];
        let inputs: Vec<&[f32]> = inputs.iter().map(Vec::as_slice).collect();
        let plane = size.stride() * size.height as usize;
        let (mut system, mut link) = (vec![0.0; 5 * plane], vec![0.0; 2 * plane]);
        let outputs: &mut [&mut [f32]] = &mut [&mut system, &mut link];
        (super::links::KERNEL.reference)(bytemuck::bytes_of(&shape), &inputs, outputs);
        vec![system, link, flow]
    })
}
