//! Looming of each cell: the nearness rate and the divergence of the flow on the view sphere.
//!
//! **Divergence**: the rates of a window of cells are fitted affinely by least squares, each cell weighted by its
//! confidence. With its slopes, and the rate (ẋ, ẏ) it has at the cell, the divergence of the spherical flow on the
//! unit sphere is `∂ẋ/∂x + ∂ẏ/∂y − 3 (x ẋ + y ẏ) / (1 + x² + y²)` in coordinates of the pinhole's plane. Its error is
//! of second order in the window's width. It is unknown where half of the window's cells are missing.
//!
//! **Nearness rate** N, per frame: the inverse of the time to contact along the bearing in frames. With the direction
//! of motion v̂ the rate is `N g` with `g = √(1 + x² + y²) (v̂_z (x, y) − (v̂_x, v̂_y))`. Two estimates are blended by
//! their inverse variances: the ratio of the flow to g, which is accurate far from v̂; and the ratio of the flow's
//! growth across the window to that of g, which is accurate near v̂, where neither v̂'s error nor the surface's slant
//! matters.

use super::bearings::rows;
use super::cells::CHANNELS as CELL_CHANNELS;
use super::parallel_rows::{Split, bands, dimensions, repeat_last};
use super::spherical_flow::motion_case;
use super::test_inputs::{Fill, Random, cases as each_fill, planes};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the cells and of the windows.
    struct Params {
        /// Cells in a row.
        columns: u32,
        /// Rows of cells.
        rows: u32,
        /// Radius of the divergence's window in cells, at most 16.
        radius: u32,
        /// Radius of the nearness rate's window in cells, at most as large.
        inner: u32,
        /// Distance of neighbouring cells' centres in the pinhole's plane.
        pitch: [f32; 2],
        /// The first cell's centre in that plane.
        origin: [f32; 2],
        /// Standard error of the rate of a cell with confidence 1, per frame, in the pinhole's plane.
        noise: f32,
        /// Cells of less confidence are left out.
        least_confidence: f32,
    }
}

kernel!(
    "looming" + [],
    reference(Params; cells, motion) -> (looming),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-5,
        relative: 1e-4, of_largest: 0.0,
        reason: "variances of places and rates are differences of means of squares, and slopes are their quotients: of \
                 seven digits about three are lost, of divergences up to 0.2",
    },
);

/// A vector of the pinhole's plane.
type Pair = [f32; 2];

#[inline(always)]
fn dot([a, b]: Pair, [c, d]: Pair) -> f32 {
    a * c + b * d
}

/// The sums over a window's cells.
#[derive(Default)]
struct Sums {
    count: f32,
    weight: f32,
    place: Pair,
    rate: Pair,
    spread: [f32; 3],
    slope_x: Pair,
    slope_y: Pair,
    square: f32,
    ideal: Pair,
    ideal_square: f32,
    ideal_rate: f32,
}

impl Sums {
    #[inline(always)]
    fn add(&mut self, w: f32, x: Pair, r: Pair, g: Pair) {
        self.count += if w > 0.0 { 1.0 } else { 0.0 };
        self.weight += w;
        self.spread[0] += w * (x[0] * x[0]);
        self.spread[1] += w * (x[0] * x[1]);
        self.spread[2] += w * (x[1] * x[1]);
        for i in 0..2 {
            self.place[i] += w * x[i];
            self.rate[i] += w * r[i];
            self.slope_x[i] += w * x[0] * r[i];
            self.slope_y[i] += w * x[1] * r[i];
            self.ideal[i] += w * g[i];
        }
        self.square += w * dot(r, r);
        self.ideal_square += w * dot(g, g);
        self.ideal_rate += w * dot(g, r);
    }
}

fn reference(p: &Params, cells: &[f32], motion: &[f32], looming: &mut [f32]) {
    let (columns, height, stride) = dimensions(p.columns, p.rows);
    let [v_x, v_y, v_z, v_error] = rows(motion)[3];
    let (radius, inner) = (p.radius as isize, p.inner as isize);
    let side = (2 * radius + 1) as f32;
    bands(looming, &mut [], Split { dearer: 16, ..Split::rows_of(4 * stride) }, #[inline(always)] |band| {
        for (i, out) in band.out.chunks_exact_mut(4 * stride).enumerate() {
            let row = (band.y0 + i) as isize;
            for column in 0..columns as isize {
                let origin = [
                    p.origin[0] + column as f32 * p.pitch[0],
                    p.origin[1] + row as f32 * p.pitch[1],
                ];
                let (mut all, mut near) = (Sums::default(), Sums::default());
                for y in (row - radius).max(0)..(row + radius + 1).min(height as isize) {
                    for x in (column - radius).max(0)..(column + radius + 1).min(columns as isize) {
                        let at = CELL_CHANNELS * y as usize * stride + x as usize;
                        let confidence = cells[at];
                        if !(confidence >= p.least_confidence) {
                            continue;
                        }
                        let [px, py, rx, ry] = [1, 2, 3, 4].map(|k| cells[at + k * stride]);
                        let n = (1.0 + px * px + py * py).sqrt();
                        let g = [n * (v_z * px - v_x), n * (v_z * py - v_y)];
                        let place = [px - origin[0], py - origin[1]];
                        all.add(confidence, place, [rx, ry], g);
                        if (x - column).abs() <= inner && (y - row).abs() <= inner {
                            near.add(confidence, place, [rx, ry], g);
                        }
                    }
                }
                let values = fit(p, &all, &near, origin, v_error, side * side);
                for (channel, value) in values.into_iter().enumerate() {
                    out[channel * stride + column as usize] = value;
                }
            }
            out.chunks_exact_mut(stride).for_each(|row| repeat_last(row, columns));
        }
    });
}

/// Nearness rate, divergence, the former's standard error, and confidence.
#[inline(always)]
fn fit(p: &Params, all: &Sums, near: &Sums, origin: Pair, v_error: f32, cells: f32) -> [f32; 4] {
    let share = 1.0 / all.weight.max(1e-20);
    let mean = |v: Pair| [v[0] * share, v[1] * share];
    let (place, rate, ideal) = (mean(all.place), mean(all.rate), mean(all.ideal));
    let c_xx = all.spread[0] * share - place[0] * place[0];
    let c_xy = all.spread[1] * share - place[0] * place[1];
    let c_yy = all.spread[2] * share - place[1] * place[1];
    let determinant = c_xx * c_yy - c_xy * c_xy;
    let cell_area = p.pitch[0] * p.pitch[1];
    let enough =
        2.0 * all.count >= cells && determinant > 0.05 * cell_area * cell_area && near.weight > 0.0;
    if !enough {
        return [0.0; 4];
    }
    let c_x: Pair = std::array::from_fn(|i| all.slope_x[i] * share - place[0] * rate[i]);
    let c_y: Pair = std::array::from_fn(|i| all.slope_y[i] * share - place[1] * rate[i]);
    let inverse = 1.0 / determinant.max(1e-30);
    let by_x: Pair = std::array::from_fn(|i| (c_yy * c_x[i] - c_xy * c_y[i]) * inverse);
    let by_y: Pair = std::array::from_fn(|i| (c_xx * c_y[i] - c_xy * c_x[i]) * inverse);
    let here: Pair = std::array::from_fn(|i| rate[i] - place[0] * by_x[i] - place[1] * by_y[i]);
    let n_square = 1.0 + dot(origin, origin);
    let divergence = by_x[0] + by_y[1] - 3.0 * dot(origin, here) / n_square;

    // The residual of the affine motion is the noise of the rates, and edges in depth.
    let left = all.square * share - dot(rate, rate) - dot(by_x, c_x) - dot(by_y, c_y);
    let variance = p.noise * p.noise + 0.5 * left.max(0.0);
    // From the flow's length relative to its distance from the direction of motion: accurate far from it.
    let far = near.ideal_rate / near.ideal_square.max(1e-20);
    let far_noise = variance / near.ideal_square.max(1e-20);
    // From its growth within the window: accurate near it, where the surface's slant does not matter.
    let growth_square = (all.ideal_square - all.weight * dot(ideal, ideal)).max(1e-20);
    let growth = (all.ideal_rate - all.weight * dot(ideal, rate)) / growth_square;
    let growth_noise = variance / growth_square;
    let first = (far * growth_noise + growth * far_noise) / (far_noise + growth_noise);
    let sine_square = near.ideal_square / near.weight.max(1e-20) / n_square;
    let doubt = v_error * v_error / sine_square.max(1e-12);
    let far_variance = far_noise + first * first * doubt;
    let growth_variance = growth_noise + first * first * sine_square;
    let total = far_variance + growth_variance;
    let nearness_rate = (far * growth_variance + growth * far_variance) / total.max(1e-30);
    let error = (far_variance * growth_variance / total.max(1e-30)).sqrt();
    [nearness_rate, divergence, error, all.weight / cells]
}

/// Cells of a rough world ahead, 0.1 apart, as [`cells`](super::cells) outputs them.
pub(super) fn cells_case(size: Size, fill: Fill, seed: u32) -> Vec<f32> {
    let stride = size.stride();
    let mut random = Random::new(seed);
    let mut values = planes(size, CELL_CHANNELS, Fill::Flat, [0.0, 0.0], seed);
    for (y, rows) in values.chunks_exact_mut(CELL_CHANNELS * stride).enumerate() {
        for x in 0..stride {
            let place = [x, y].map(|i| 0.02 * (i as f32 - 12.0) + 0.004 * random.next());
            let depth = 0.05 * if fill == Fill::Flat { 1.0 } else { 0.5 + random.next() };
            let confidence = match fill {
                Fill::Flat => 1.0,
                // Some below what counts, but none near the limit: a rounding must not decide.
                _ if random.next() < 0.3 => 0.01,
                _ => 0.2 + 0.8 * random.next(),
            };
            let every = if fill == Fill::Flat { 1.0 } else { [1.0, 0.05, 0.8][(3.0 * random.next()) as usize % 3] };
            let of_x = x.min(size.width as usize - 1);
            let from = if of_x == x { None } else { Some(of_x) };
            for (channel, value) in
                [confidence, place[0], place[1], depth * place[0], depth * place[1], confidence * every]
                    .into_iter()
                    .enumerate()
            {
                rows[channel * stride + x] = match from {
                    None => value,
                    Some(last) => rows[channel * stride + last],
                };
            }
        }
    }
    values
}

fn cases(size: Size) -> Vec<Case> {
    let extent = Size::new(size.width.div_ceil(4), size.height.div_ceil(4));
    let params = Params {
        columns: extent.width,
        rows: extent.height,
        radius: 2,
        inner: 1,
        pitch: [0.02, 0.02],
        origin: [-0.24, -0.24],
        noise: 1e-4,
        least_confidence: 0.1,
    };
    each_fill(
        &[Fill::Flat, Fill::Textured],
        bytemuck::bytes_of(&params),
        &[4 * extent.stride()],
        extent,
        |fill| vec![cells_case(extent, fill, 9), motion_case()],
    )
}
