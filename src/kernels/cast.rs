//! Ray casting: the first surface that each of a pixel's four samples hits, of those that its tile can see.
//!
//! A sample's number is 0 for the sky, and else 1 + 8 · surface + face: of a box twice the axis across the face and 1
//! more on its positive side, of a cylinder 0 for the mantle, 1 and 2 for the lids, 0 else. A tile's surfaces are
//! listed nearest first, boxes and then cylinders, so that the search may stop at the first that is further away than
//! all hits.

use super::parallel_rows::{Split, bands, dimensions};
use super::surface_inputs::surface_inputs;
use super::surface_layout::{LANES, Lanes, OFFSETS, RAY, SURFACE_LEN, TILE, least, most, pick};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the image and its tiles.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// Tiles in a row.
        tiles: u32,
    }
}

kernel!(
    "cast" + ["samples"],
    reference(Params; rays, surfaces, tiles, members) -> (ids),
    cases: cases,
    tolerance: Tolerance {
        absolute: 0.0, relative: 0.0, of_largest: 0.0,
        reason: "whole numbers; no ray of the cases passes an edge by less than 1e-4 of its length",
    },
);

const FAR: f32 = 1e30;

/// Unit rays of one sample of neighbouring pixels, and their hits so far.
struct Sample {
    x: Lanes,
    y: Lanes,
    z: Lanes,
    distance: Lanes,
    id: Lanes,
}

fn reference(p: &Params, rays: &[f32], surfaces: &[f32], tiles: &[f32], members: &[f32], ids: &mut [f32]) {
    let (width, _, stride) = dimensions(p.width, p.height);
    let (tiles, records) = (tiles.as_chunks::<4>().0, surfaces[4..].as_chunks::<SURFACE_LEN>().0);
    bands(ids, &mut [], Split { dearer: 64, ..Split::rows_of(4 * stride) }, #[inline(always)] |band| {
        for (i, row) in band.out.chunks_exact_mut(4 * stride).enumerate() {
            let y = band.y0 + i;
            let rays = rays[RAY * y * stride..][..RAY * width].as_chunks::<RAY>().0;
            for (tile_x, out) in row.chunks_mut(4 * LANES).enumerate() {
                let first = tile_x * LANES;
                let mut samples = OFFSETS.map(|offset| sample(&rays[first..width.min(first + LANES)], offset));
                let tile = tiles[y / TILE[1] * p.tiles as usize + tile_x].map(|value| value as usize);
                for member in &members[tile[0]..tile[0] + tile[1]] {
                    let (index, record) = (*member, &records[*member as usize]);
                    if hidden(&samples, record) {
                        break;
                    }
                    samples.iter_mut().for_each(|sample| cuboid(sample, record, 8.0 * index));
                }
                for member in &members[tile[2]..tile[2] + tile[3]] {
                    let (index, record) = (*member, &records[*member as usize]);
                    if hidden(&samples, record) {
                        break;
                    }
                    samples.iter_mut().for_each(|sample| cylinder(sample, record, 8.0 * index));
                }
                for (lane, out) in out.chunks_exact_mut(4).enumerate() {
                    // The surplus repeats the last pixel, as its rays do.
                    let lane = lane.min(width - first - 1);
                    out.iter_mut().zip(&samples).for_each(|(out, sample)| *out = sample.id[lane]);
                }
            }
        }
    });
}

#[inline(always)]
fn sample(rays: &[[f32; RAY]], [right, down]: [f32; 2]) -> Sample {
    let mut sample = Sample {
        x: [0.0; LANES], y: [0.0; LANES], z: [1.0; LANES], distance: [FAR; LANES], id: [0.0; LANES],
    };
    for (lane, ray) in rays.iter().enumerate() {
        let x = ray[0] + ray[4] * right + ray[5] * down;
        let y = ray[1] + ray[6] * right + ray[7] * down;
        let z = 1.0 / (x * x + y * y + 1.0).sqrt();
        (sample.x[lane], sample.y[lane], sample.z[lane]) = (x * z, y * z, z);
    }
    sample
}

/// Whether all surfaces that follow are as far away as the hits, or further.
#[inline(always)]
fn hidden(samples: &[Sample; 4], record: &[f32; SURFACE_LEN]) -> bool {
    let open = |lane: usize| samples.iter().any(|sample| sample.distance[lane] >= record[15]);
    // Counted, because a sum of whole numbers compiles to vectors.
    (0..LANES).map(|lane| u32::from(open(lane))).sum::<u32>() == 0
}

/// The ray along an axis. Nothing is quite parallel to anything.
#[inline(always)]
fn along(sample: &Sample, record: &[f32; SURFACE_LEN], axis: usize, lane: usize) -> f32 {
    let row = &record[4 * axis..4 * axis + 3];
    let l = row[0] * sample.x[lane] + row[1] * sample.y[lane] + row[2] * sample.z[lane];
    pick(l.abs() < 1e-12, 1e-12, l)
}

#[inline(always)]
fn cuboid(sample: &mut Sample, record: &[f32; SURFACE_LEN], base: f32) {
    let (o, half) = ([record[3], record[7], record[11]], [record[12], record[13], record[14]]);
    // What has no height has one face.
    let flat = half[2] == 0.0;
    for lane in 0..LANES {
        let l: [f32; 3] = std::array::from_fn(|axis| along(sample, record, axis, lane));
        let inverse = l.map(|l| 1.0 / l);
        let middle: [f32; 3] = std::array::from_fn(|axis| -o[axis] * inverse[axis]);
        let reach: [f32; 3] = std::array::from_fn(|axis| half[axis] * inverse[axis].abs());
        let near: [f32; 3] = std::array::from_fn(|axis| middle[axis] - reach[axis]);
        let far: [f32; 3] = std::array::from_fn(|axis| middle[axis] + reach[axis]);
        let (enter, leave) = (most(most(near[0], near[1]), near[2]), least(least(far[0], far[1]), far[2]));
        // From the inside the face behind is seen.
        let outside = enter > 0.0;
        let distance = pick(outside, enter, leave);
        let hit = (enter <= leave) & (leave > 0.0) & (distance < sample.distance[lane]);
        let on_x = distance == pick(outside, near[0], far[0]);
        let on_y = distance == pick(outside, near[1], far[1]);
        let across = pick(on_x, l[0], pick(on_y, l[1], l[2]));
        let axis = pick(on_x, 0.0, pick(on_y, 2.0, 4.0));
        let face = pick(flat, 0.0, axis + pick((across > 0.0) != outside, 1.0, 0.0));
        sample.id[lane] = pick(hit, base + face + 1.0, sample.id[lane]);
        sample.distance[lane] = pick(hit, distance, sample.distance[lane]);
    }
}

#[inline(always)]
fn cylinder(sample: &mut Sample, record: &[f32; SURFACE_LEN], base: f32) {
    let (o, radius, half) = ([record[3], record[7], record[11]], record[12], record[14]);
    for lane in 0..LANES {
        let l: [f32; 3] = std::array::from_fn(|axis| along(sample, record, axis, lane));
        let a = l[0] * l[0] + l[1] * l[1];
        let b = o[0] * l[0] + o[1] * l[1];
        // Moment of the ray about the axis: no two large numbers are subtracted.
        let w = o[0] * l[1] - o[1] * l[0];
        let square = radius * radius * a - w * w;
        let root = most(square, 0.0).sqrt();
        let (inverse_a, inverse_z) = (1.0 / a, 1.0 / l[2]);
        let (middle, reach) = (-o[2] * inverse_z, half * inverse_z.abs());
        let (near, far) = ((-b - root) * inverse_a, (-b + root) * inverse_a);
        let (enter, leave) = (most(near, middle - reach), least(far, middle + reach));
        let outside = enter > 0.0;
        let distance = pick(outside, enter, leave);
        let hit = (square >= 0.0) & (enter <= leave) & (leave > 0.0) & (distance < sample.distance[lane]);
        let mantle = distance == pick(outside, near, far);
        let face = pick(mantle, 0.0, pick((l[2] > 0.0) != outside, 2.0, 1.0));
        sample.id[lane] = pick(hit, base + face + 1.0, sample.id[lane]);
        sample.distance[lane] = pick(hit, distance, sample.distance[lane]);
    }
}

fn cases(size: Size) -> Vec<Case> {
    let scene = surface_inputs(size);
    let [across, _] = scene.tiles;
    let params = Params { width: size.width, height: size.height, tiles: across as u32 };
    vec![Case {
        name: "scene".to_owned(),
        params: bytemuck::bytes_of(&params).to_vec(),
        inputs: vec![scene.rays, scene.surfaces, scene.lists, scene.members],
        outputs: vec![4 * size.stride() * size.height as usize],
        extent: size,
    }]
}

/// The reference's hits, for the cases of the next kernel.
pub(super) fn cast(size: Size, tiles: usize, inputs: [&[f32]; 4]) -> Vec<f32> {
    let mut ids = vec![0.0; 4 * size.stride() * size.height as usize];
    let params = Params { width: size.width, height: size.height, tiles: tiles as u32 };
    let [rays, surfaces, tiles, members] = inputs;
    reference(&params, rays, surfaces, tiles, members, &mut ids);
    ids
}
