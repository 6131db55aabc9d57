//! The summary of the cells in each sector of the view.
//!
//! Channels of the result: 0 the share of the sector's cells with enough confidence; 1 to 3 their nearness rate's lower
//! quantile, median and upper quantile; 4 the upper quantile of the divergence where that is positive, and else 0: a
//! signed sum would be the net flux through the sector's border, in which an obstacle inside it cancels; 5 their mean
//! confidence; 6 to 8 their mean spherical flow F, weighted by confidence; 9 to 14 the moment `Σ w n nᵀ` of the normals
//! `n = p × F` (xx, xy, xz, yy, yz, zz), whose smallest eigenvalue belongs to the direction of motion; 15 the mean
//! standard error of the nearness rate. Rates are per frame.
//!
//! Quantiles are values of single cells, by nearest rank, and found from the highest bit to the lowest by counting: the
//! same bits whatever the order of the cells.

use super::bearings::dot;
use super::cells::CHANNELS as CELL_CHANNELS;
use super::looming::cells_case;
use super::parallel_rows::{Split, bands, dimensions, repeat_last};
use super::test_inputs::{Fill, cases as each_fill, planes};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the sectors and of the cells.
    struct Params {
        /// Sectors in a row.
        columns: u32,
        /// Rows of sectors.
        rows: u32,
        /// Cells in a row.
        cell_columns: u32,
        /// Cells of less confidence are left out.
        least_confidence: f32,
        /// Cells of less confidence in every direction are left out of the moments.
        least_both: f32,
        /// The upper quantile's rank, above 0.5 and below 1; the lower one's is 1 less it.
        quantile: f32,
    }
}

kernel!(
    "sectors" + [],
    reference(Params; cells, looming, ranges, members) -> (sectors),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-7,
        relative: 2e-5, of_largest: 0.0,
        reason: "means of some tens of values; quantiles are copied, and differ only as the values do: not at all",
    },
);

/// Channels of the result.
pub const CHANNELS: usize = 16;

fn reference(
    p: &Params,
    cells: &[f32],
    looming: &[f32],
    ranges: &[f32],
    members: &[f32],
    sectors: &mut [f32],
) {
    let (columns, _, stride) = dimensions(p.columns, p.rows);
    let (cell_columns, _, cell_stride) = dimensions(p.cell_columns, 1);
    let ranges = ranges.as_chunks::<2>().0;
    let longest = ranges.iter().fold(0.0, |longest: f32, range| longest.max(range[1])) as usize;
    let split = Split { scratch: 2 * longest, ..Split::rows_of(CHANNELS * stride) };
    bands(sectors, &mut [], split, #[inline(always)] |band| {
        for (i, out) in band.out.chunks_exact_mut(CHANNELS * stride).enumerate() {
            let row = band.y0 + i;
            for column in 0..columns {
                let [first, count] = ranges[row * columns + column].map(|value| value as usize);
                let (rates, divergences) = band.scratch.split_at_mut(longest);
                let mut sums = [0.0f32; 11];
                let mut valid = 0;
                for member in &members[first..first + count] {
                    let cell = *member as usize;
                    let (y, x) = (cell / cell_columns, cell % cell_columns);
                    let of_cells = |channel: usize| cells[(CELL_CHANNELS * y + channel) * cell_stride + x];
                    let of_looming = |channel: usize| looming[(4 * y + channel) * cell_stride + x];
                    let w = of_looming(3);
                    if !(w >= p.least_confidence) {
                        continue;
                    }
                    (rates[valid], divergences[valid]) = (of_looming(0), of_looming(1).max(0.0));
                    valid += 1;
                    let (px, py) = (of_cells(1), of_cells(2));
                    let scale = 1.0 / dot([px, py, 1.0], [px, py, 1.0]).sqrt();
                    let sight = [px * scale, py * scale, scale];
                    let rate = [of_cells(3), of_cells(4), 0.0];
                    let along = dot(sight, rate);
                    let f: [f32; 3] = std::array::from_fn(|k| (rate[k] - sight[k] * along) * sight[2]);
                    let n = cross(sight, f);
                    let terms = [
                        1.0, f[0], f[1], f[2],
                        n[0] * n[0], n[0] * n[1], n[0] * n[2], n[1] * n[1], n[1] * n[2], n[2] * n[2],
                        of_looming(2),
                    ];
                    let (along, every) = (of_cells(0), of_cells(5));
                    let both = if every >= p.least_both { w * (every / along.max(1e-6)).min(1.0) } else { 0.0 };
                    for (k, (sum, term)) in sums.iter_mut().zip(terms).enumerate() {
                        *sum += if (4..10).contains(&k) { both } else { w } * term;
                    }
                }
                let mut set = |channel: usize, value: f32| out[channel * stride + column] = value;
                set(0, valid as f32 / count.max(1) as f32);
                rates[..valid].sort_unstable_by(f32::total_cmp);
                divergences[..valid].sort_unstable_by(f32::total_cmp);
                let low = (valid.max(1) - 1) as f32;
                let ranks = [1.0 - p.quantile, 0.5, p.quantile].map(|q| (low * q + 0.5).floor() as usize);
                for (channel, rank) in (1..).zip(ranks) {
                    set(channel, if valid > 0 { rates[rank] } else { 0.0 });
                }
                set(4, if valid > 0 { divergences[ranks[2]] } else { 0.0 });
                let share = 1.0 / sums[0].max(1e-20);
                set(5, sums[0] / valid.max(1) as f32);
                (0..3).for_each(|k| set(6 + k, sums[1 + k] * share));
                (0..6).for_each(|k| set(9 + k, sums[4 + k]));
                set(15, sums[10] * share);
            }
            out.chunks_exact_mut(stride).for_each(|row| repeat_last(row, columns));
        }
    });
}

#[inline(always)]
fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn cases(size: Size) -> Vec<Case> {
    let cells = Size::new(size.width.div_ceil(4), size.height.div_ceil(4));
    let extent = Size::new(cells.width.div_ceil(5), cells.height.div_ceil(6));
    // Sectors of up to 30 cells, the last of them empty.
    let mut ranges = Vec::new();
    let mut members = Vec::new();
    for row in 0..extent.height {
        for column in 0..extent.width {
            let first = members.len();
            if (column, row) != (extent.width - 1, extent.height - 1) || extent.pixels() == 1 {
                for y in (6 * row..6 * row + 6).filter(|y| *y < cells.height) {
                    let x = (5 * column..5 * column + 5).filter(|x| *x < cells.width);
                    members.extend(x.map(|x| (y * cells.width + x) as f32));
                }
            }
            ranges.extend([first as f32, (members.len() - first) as f32]);
        }
    }
    let params = Params {
        columns: extent.width,
        rows: extent.height,
        cell_columns: cells.width,
        least_confidence: 0.1,
        least_both: 0.15,
        quantile: 0.8,
    };
    let fills = [Fill::Flat, Fill::Textured];
    each_fill(&fills, bytemuck::bytes_of(&params), &[CHANNELS * extent.stride()], extent, |fill| {
        let mut looming = planes(cells, 4, fill, [-1.0, 1.0], 5);
        // Confidence is not negative; some cells are below the limit, none is near it.
        for rows in looming.chunks_exact_mut(4 * cells.stride()) {
            for confidence in &mut rows[3 * cells.stride()..] {
                *confidence = if *confidence < -0.2 { 0.0 } else { 0.3 + 0.5 * confidence.abs() };
            }
        }
        vec![cells_case(cells, fill, 9), looming, ranges.clone(), members.clone()]
    })
}
