//! A robust mean of the flow around each pixel, over pixels that look like it and whose flow fits: the non-local step.
//!
//! Samples lie on a square grid around the pixel. Each one's flow is carried to the pixel along the slopes expected there, and
//! counts by its nearness, by how nearly it has the pixel's gray level, and by how well its own flow fits. The mean is
//! that of an L1 norm, found by reweighting a few times (Sun, Roth and Black, Secrets of optical flow estimation, CVPR 2010,
//! section 4, whose weighted median this stands for).

use super::parallel_rows::{Split, bands, dimensions, repeat_last};
use super::slope_weights::four_rows;
use super::test_inputs::{Fill, cases as each_fill, planes};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the image and of the grid of samples, and the weights' form.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// The grid has `2 radius + 1` samples along each axis; 1 to 3.
        radius: u32,
        /// The distance of neighbouring samples, in pixels.
        spacing: u32,
        /// How often the mean is reweighted, 1 to 8.
        rounds: u32,
        /// −log₂ e / (2 σ²), where σ is the standard deviation of the weight of nearness, in pixels.
        nearness: f32,
        /// 1 / τ²: the inverse square of the difference of gray levels at which a sample counts half.
        tone: f32,
        /// ε²: the squared difference of displacements up to which the norm is that of squares, in square pixels.
        robust: f32,
    }
}

kernel!(
    "nonlocal" + ["exponential"],
    reference(Params; flow, slope, image, weight) -> (mean),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-5,
        relative: 0.0,
        of_largest: 1e-5,
        reason: "means of 25 displacements with positive weights, each weight some ten roundings off",
    },
);

/// Pixels processed together: few enough that their samples stay in the nearest cache.
const BLOCK: usize = 64;
/// The most samples.
const MOST: usize = 49;
/// How often the pixel itself counts.
const OWN: f32 = 2.0;

type Block = [f32; BLOCK];

fn reference(p: &Params, flow: &[f32], slope: &[f32], image: &[f32], weight: &[f32], mean: &mut [f32]) {
    let (width, height, stride) = dimensions(p.width, p.height);
    let samples = samples(p);
    let split = Split { dearer: 32, ..Split::rows_of(2 * stride) };
    bands(mean, &mut [], split, #[inline(always)] |band| {
        // Weights and displacements of each sample, for a block of pixels.
        let mut weights = [[0.0; BLOCK]; MOST];
        let mut us = [[0.0; BLOCK]; MOST];
        let mut vs = [[0.0; BLOCK]; MOST];
        let mut room = [[0.0; BLOCK]; 4];
        for (i, rows) in band.out.chunks_exact_mut(2 * stride).enumerate() {
            let y = band.y0 + i;
            let slopes = four_rows(slope, y, stride);
            let own = &image[y * stride..][..stride];
            for x0 in (0..width).step_by(BLOCK) {
                let count = BLOCK.min(width - x0);
                let slopes = slopes.map(|slope| block(slope, x0, count));
                let gray = block(own, x0, count);
                for (n, &[dx, dy, near]) in samples.iter().enumerate() {
                    let sample = [&mut weights[n], &mut us[n], &mut vs[n]];
                    let row = y as isize + dy as isize;
                    if !(0..height as isize).contains(&row) {
                        sample.into_iter().for_each(|block| block.fill(0.0));
                        continue;
                    }
                    let (row, at) = (row as usize, x0 as isize + dx as isize);
                    let [room_u, room_v, room_tone, room_fit] = &mut room;
                    let u = sampled(&flow[2 * row * stride..][..width], at, room_u);
                    let v = sampled(&flow[(2 * row + 1) * stride..][..width], at, room_v);
                    let tone = sampled(&image[row * stride..][..width], at, room_tone);
                    let fit = sampled(&weight[row * stride..][..width], at, room_fit);
                    let [weights, us, vs] = sample;
                    for i in 0..BLOCK {
                        let off = tone[i] - gray[i];
                        weights[i] = fit[i] * near / (1.0 + off * off * p.tone);
                        us[i] = u[i] - (slopes[0][i] * dx + slopes[1][i] * dy);
                        vs[i] = v[i] - (slopes[2][i] * dx + slopes[3][i] * dy);
                    }
                }
                let (u, v) = rows.split_at_mut(stride);
                let [found_u, found_v] = robust_mean(p, &samples, [&weights, &us, &vs], {
                    let of = |channel: usize| block(&flow[(2 * y + channel) * stride..], x0, count);
                    [of(0), of(1)]
                });
                u[x0..][..count].copy_from_slice(&found_u[..count]);
                v[x0..][..count].copy_from_slice(&found_v[..count]);
            }
            rows.chunks_exact_mut(stride).for_each(|row| repeat_last(row, width));
        }
    });
}

/// The mean of the samples of a block of pixels under an L1 norm, beginning with each pixel's own flow.
#[inline(always)]
fn robust_mean(
    p: &Params,
    samples: &[[f32; 3]],
    [weights, us, vs]: [&[Block; MOST]; 3],
    [mut u, mut v]: [Block; 2],
) -> [Block; 2] {
    for _ in 0..p.rounds {
        let (mut sum, mut sum_u, mut sum_v) = ([0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK]);
        for n in 0..samples.len() {
            for i in 0..BLOCK {
                let (d_u, d_v) = (us[n][i] - u[i], vs[n][i] - v[i]);
                let w = weights[n][i] / (d_u * d_u + d_v * d_v + p.robust).sqrt();
                sum[i] += w;
                sum_u[i] += w * us[n][i];
                sum_v[i] += w * vs[n][i];
            }
        }
        for i in 0..BLOCK {
            let inverse = 1.0 / sum[i];
            (u[i], v[i]) = (sum_u[i] * inverse, sum_v[i] * inverse);
        }
    }
    [u, v]
}

/// The samples: their distances along x and y in pixels, and the weight of their nearness, which counts the pixel itself
/// [`OWN`] times. Row by row, as in the shader.
fn samples(p: &Params) -> Vec<[f32; 3]> {
    let reach = p.radius as i32;
    let spacing = p.spacing as f32;
    let mut samples = Vec::new();
    for j in -reach..=reach {
        for i in -reach..=reach {
            let (dx, dy) = (spacing * i as f32, spacing * j as f32);
            let near = super::fit_weight::power_of_two(p.nearness * (dx * dx + dy * dy));
            samples.push([dx, dy, if (i, j) == (0, 0) { OWN } else { near }]);
        }
    }
    samples
}

/// The block of a row from column `x0` on, of which `count` values are valid; zeros after them.
#[inline(always)]
fn block(row: &[f32], x0: usize, count: usize) -> Block {
    let mut values = [0.0; BLOCK];
    values[..count].copy_from_slice(&row[x0..][..count]);
    values
}

/// The block of a row from column `at` on, which may be outside the row; zeros there, so that samples outside have no weight.
#[inline(always)]
fn sampled<'a>(row: &'a [f32], at: isize, room: &'a mut Block) -> &'a Block {
    if let Ok(at) = usize::try_from(at)
        && let Some(block) = row.get(at..).and_then(<[f32]>::first_chunk)
    {
        return block;
    }
    let within = |column: isize| (column - at).clamp(0, BLOCK as isize) as usize;
    let (from, to) = (within(0), within(row.len() as isize));
    room.fill(0.0);
    if from < to {
        room[from..to].copy_from_slice(&row[(at + from as isize) as usize..][..to - from]);
    }
    room
}

fn cases(size: Size) -> Vec<Case> {
    let all = [(2, 3), (3, 2)].map(|(radius, spacing)| {
        let params = Params {
            width: size.width,
            height: size.height,
            radius,
            spacing,
            rounds: 3,
            nearness: -std::f32::consts::LOG2_E / (2.0 * 81.0),
            tone: 1.0 / 400.0,
            robust: 0.0025,
        };
        let cases = each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &[2 * size.stride()], size, |fill| {
            vec![
                planes(size, 2, fill, [-6.0, 6.0], 1),
                planes(size, 4, fill, [-0.1, 0.1], 2),
                planes(size, 1, fill, [0.0, 255.0], 3),
                planes(size, 1, fill, [0.001, 1.0], 4),
            ]
        });
        cases.into_iter().map(move |case| Case { name: format!("{}, radius {radius}", case.name), ..case })
    });
    all.into_iter().flatten().collect()
}
