//! Shading: the gray level and the nearness of each pixel, from the surfaces that its samples hit.
//!
//! Each face that a pixel sees is evaluated once, by its texture at the mean of the samples that see it, weighted by
//! their number. The texture is filtered to the size of a pixel, so that this is its mean over the samples.

use super::octaves::{Places, log2_of, textured, turns, whole};
use super::parallel_rows::{Split, bands, dimensions, repeat_last};
use super::surface_inputs::surface_inputs;
use super::surface_layout::{LANES, Lanes, OFFSETS, RAY, SURFACE_LEN, most, pick};
use super::test_inputs::{Fill, planes};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the image, and its weight.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// Weight of this image in the sum of those of an exposure.
        share: f32,
    }
}

kernel!(
    "shade" + ["samples", "noise", "hash"],
    reference(Params; rays, surfaces, ids, before) -> (gray, nearness),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-7, relative: 3e-5, of_largest: 0.0,
        reason: "nearness keeps a millionth; so do places, of their distance, of which a pixel covers some thousandths and \
                 in two pixels of which the finest octave rises by up to 50 levels: the cases begin with 100",
    },
);

/// Gray level of the sky at the horizon, and the difference straight up.
pub const SKY: [f32; 2] = [170.0, 60.0];
/// The share by which faces that point up are brighter than upright ones, and faces that point down darker.
pub const LIGHT: f32 = 0.15;

fn reference(
    p: &Params,
    rays: &[f32],
    surfaces: &[f32],
    ids: &[f32],
    before: &[f32],
    gray: &mut [f32],
    nearness: &mut [f32],
) {
    let (width, _, stride) = dimensions(p.width, p.height);
    let up = [surfaces[0], surfaces[1], surfaces[2]];
    let records = surfaces[4..].as_chunks::<SURFACE_LEN>().0;
    let split = Split { second_row: stride, dearer: 64, ..Split::rows_of(stride) };
    bands(gray, nearness, split, #[inline(always)] |band| {
        let rows = band.out.chunks_exact_mut(stride).zip(band.second.chunks_exact_mut(stride));
        for (i, (gray, nearness)) in rows.enumerate() {
            let at = (band.y0 + i) * stride;
            let rays = rays[RAY * at..][..RAY * width].as_chunks::<RAY>().0;
            let ids = ids[4 * at..][..4 * width].as_chunks::<4>().0;
            for first in (0..width).step_by(LANES) {
                let lanes = first..width.min(first + LANES);
                let (level, near) = pixels(&rays[lanes.clone()], &ids[lanes.clone()], records, up);
                for (lane, x) in lanes.enumerate() {
                    let shown = rays[x][2] > 0.0;
                    gray[x] = before[at + x] + p.share * pick(shown, level[lane], 0.0);
                    nearness[x] = pick(shown, near[lane], 0.0);
                }
            }
            repeat_last(gray, width);
            repeat_last(nearness, width);
        }
    });
}

/// The faces that neighbouring pixels see. Their axes are those of their surface, in such an order that the last one
/// leads across the face, or along the axis of a mantle.
struct Faces {
    /// In the camera's frame.
    axes: [[Lanes; 3]; 3],
    /// The camera's place along them.
    place: [Lanes; 3],
    /// Half the lengths along them.
    half: [Lanes; 3],
    /// The camera's place in the texture beyond `cells`.
    rest: [Lanes; 3],
    cells: [Lanes; 3],
    /// 1 or −1: on which side the face lies.
    side: Lanes,
    /// 1 for a cylinder's mantle, 2 for its lids, 0 for what has straight edges.
    round: Lanes,
    seed: [u32; LANES],
}

/// Gray levels and nearness of up to [`LANES`] pixels.
#[inline(always)]
fn pixels(
    rays: &[[f32; RAY]],
    ids: &[[f32; 4]],
    records: &[[f32; SURFACE_LEN]],
    up: [f32; 3],
) -> (Lanes, Lanes) {
    let mut ray = [[0.0; LANES]; RAY];
    let mut seen = [[0.0; LANES]; 4];
    for (lane, (values, ids)) in rays.iter().zip(ids).enumerate() {
        ray.iter_mut().zip(values).for_each(|(ray, value)| ray[lane] = *value);
        seen.iter_mut().zip(ids).for_each(|(seen, id)| seen[lane] = *id);
    }
    let mut left = [[1.0; LANES]; 4];
    let (mut sum, mut met, mut any_met) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
    let mut sky = [0.0; LANES];
    let centre = unit(&ray[0], &ray[1]);
    for _ in 0..4 {
        let (mut one, mut share, mut right, mut down) =
            ([0.0; LANES], [0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            one[lane] = pick(left[2][lane] > 0.0, seen[2][lane], seen[3][lane]);
            one[lane] = pick(left[1][lane] > 0.0, seen[1][lane], one[lane]);
            one[lane] = pick(left[0][lane] > 0.0, seen[0][lane], one[lane]);
            for (k, offset) in OFFSETS.into_iter().enumerate() {
                let same = pick(seen[k][lane] == one[lane], left[k][lane], 0.0);
                left[k][lane] -= same;
                share[lane] += same;
                right[lane] += same * offset[0];
                down[lane] += same * offset[1];
            }
        }
        if !share.iter().any(|share| *share > 0.0) {
            break;
        }
        let (mut x, mut y, mut width) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            let (right, down) = (right[lane] / most(share[lane], 1.0), down[lane] / most(share[lane], 1.0));
            x[lane] = ray[0][lane] + ray[4][lane] * right + ray[5][lane] * down;
            y[lane] = ray[1][lane] + ray[6][lane] * right + ray[7][lane] * down;
            width[lane] = pick((one[lane] > 0.0) & (share[lane] > 0.0), ray[2][lane], 0.0);
        }
        let d = unit(&x, &y);
        let mut level: Lanes = std::array::from_fn(|lane| {
            SKY[0] + SKY[1] * (d[0][lane] * up[0] + d[1][lane] * up[1] + d[2][lane] * up[2])
        });
        if one.iter().any(|one| *one > 0.0) {
            let faces = faces(&one, records);
            let of_surface = lit(&faces, &d, up, &width);
            let (distance, within) = centre_met(&faces, &centre);
            for lane in 0..LANES {
                let of_it = (one[lane] > 0.0) & (share[lane] > 0.0);
                level[lane] = pick(one[lane] > 0.0, of_surface[lane], level[lane]);
                met[lane] = most(met[lane], pick(of_it & (within[lane] > 0.0), 1.0 / distance[lane], 0.0));
                any_met[lane] = most(any_met[lane], pick(of_it, 1.0 / distance[lane], 0.0));
            }
        }
        for lane in 0..LANES {
            sky[lane] = pick((share[lane] > 0.0) & (one[lane] == 0.0), 1.0, sky[lane]);
            sum[lane] += 0.25 * share[lane] * level[lane].clamp(0.0, 255.0);
        }
    }
    // The area between the samples is assumed to show what they hit.
    let near = std::array::from_fn(|lane| pick((met[lane] > 0.0) | (sky[lane] > 0.0), met[lane], any_met[lane]));
    (sum, near)
}

#[inline(always)]
fn unit(x: &Lanes, y: &Lanes) -> [Lanes; 3] {
    let z: Lanes = std::array::from_fn(|i| 1.0 / (x[i] * x[i] + y[i] * y[i] + 1.0).sqrt());
    [std::array::from_fn(|i| x[i] * z[i]), std::array::from_fn(|i| y[i] * z[i]), z]
}

#[inline(always)]
fn faces(ids: &Lanes, records: &[[f32; SURFACE_LEN]]) -> Faces {
    let mut faces = Faces {
        axes: [[[0.0; LANES]; 3]; 3],
        place: [[0.0; LANES]; 3],
        half: [[0.0; LANES]; 3],
        rest: [[0.0; LANES]; 3],
        cells: [[0.0; LANES]; 3],
        side: [0.0; LANES],
        round: [0.0; LANES],
        seed: [0; LANES],
    };
    // Neighbours mostly see the same: then one look is enough.
    let alike = ids.iter().all(|id| *id == ids[0]);
    for lane in 0..if alike { 1 } else { LANES } {
        let code = most(ids[lane] - 1.0, 0.0) as u32;
        let (record, face) = (&records[(code / 8) as usize], code % 8);
        let (flat, round) = (record[23] == 1.0, record[23] == 2.0);
        let across = if flat || round { 2 } else { face as usize / 2 };
        for (k, axis) in [(across + 1) % 3, (across + 2) % 3, across].into_iter().enumerate() {
            faces.axes[k].iter_mut().zip(&record[4 * axis..]).for_each(|(lanes, value)| lanes[lane] = *value);
            faces.place[k][lane] = record[4 * axis + 3];
            faces.half[k][lane] = record[12 + axis];
            faces.rest[k][lane] = record[16 + axis];
            faces.cells[k][lane] = record[20 + axis];
        }
        let upper = if round { face == 2 } else { face % 2 == 1 };
        faces.side[lane] = pick(upper, 1.0, -1.0);
        faces.round[lane] = pick(round, pick(face == 0, 1.0, 2.0), 0.0);
        faces.seed[lane] = (8 * record[19] as u32).wrapping_add(face);
    }
    if alike {
        let spread = |lanes: &mut Lanes| *lanes = [lanes[0]; LANES];
        faces.axes.as_flattened_mut().iter_mut().for_each(spread);
        for three in [&mut faces.place, &mut faces.half, &mut faces.rest, &mut faces.cells] {
            three.iter_mut().for_each(spread);
        }
        [&mut faces.side, &mut faces.round].into_iter().for_each(spread);
        faces.seed = [faces.seed[0]; LANES];
    }
    faces
}

/// A direction of the camera's frame along a face's axes.
#[inline(always)]
fn along(faces: &Faces, d: [f32; 3], lane: usize) -> [f32; 3] {
    std::array::from_fn(|k| {
        let axis = &faces.axes[k];
        axis[0][lane] * d[0] + axis[1][lane] * d[1] + axis[2][lane] * d[2]
    })
}

/// Where a ray meets a face, along the face's axes.
struct Met {
    distance: f32,
    l: [f32; 3],
    place: [f32; 3],
    /// 1 if the ray meets the face, and not only its continuation.
    within: f32,
}

#[inline(always)]
fn meet(faces: &Faces, d: &[Lanes; 3], lane: usize) -> Met {
    let l = along(faces, [d[0][lane], d[1][lane], d[2][lane]], lane);
    let o: [f32; 3] = std::array::from_fn(|k| faces.place[k][lane]);
    let half: [f32; 3] = std::array::from_fn(|k| faces.half[k][lane]);
    let (mantle, lid) = (faces.round[lane] == 1.0, faces.round[lane] == 2.0);
    let flat = (faces.side[lane] * half[2] - o[2]) / pick(l[2].abs() < 1e-12, 1e-12, l[2]);
    let a = most(l[0] * l[0] + l[1] * l[1], 1e-24);
    let b = o[0] * l[0] + o[1] * l[1];
    let w = o[0] * l[1] - o[1] * l[0];
    let radius = half[0];
    let square = radius * radius * a - w * w;
    let inside = (o[0] * o[0] + o[1] * o[1] < radius * radius) & (o[2].abs() <= half[2]);
    let root = most(square, 0.0).sqrt();
    let curved = (-b + pick(inside, root, -root)) / a;
    let met = pick(mantle, curved, flat);
    let distance = most(met, 1e-6);
    let place: [f32; 3] = std::array::from_fn(|k| o[k] + distance * l[k]);
    let beyond: [f32; 3] = std::array::from_fn(|k| place[k].abs() - half[k]);
    // What is negative is on the face.
    let off_lid = place[0] * place[0] + place[1] * place[1] - radius * radius;
    let off_flat = pick(lid, off_lid, most(beyond[0], beyond[1]));
    let off = pick(mantle, most(beyond[2], -square), off_flat);
    Met { distance, l, place, within: pick((met > 0.0) & (off <= 0.0), 1.0, 0.0) }
}

/// The distance of each face at the pixels' centres, and 1 where the centres meet it, and not only its continuation.
#[inline(always)]
fn centre_met(faces: &Faces, centre: &[Lanes; 3]) -> (Lanes, Lanes) {
    let (mut distance, mut within) = ([0.0; LANES], [0.0; LANES]);
    for lane in 0..LANES {
        let met = meet(faces, centre, lane);
        (distance[lane], within[lane]) = (met.distance, met.within);
    }
    (distance, within)
}

/// Gray levels of pixels of these widths; of width 0, without texture.
#[inline(always)]
fn lit(faces: &Faces, d: &[Lanes; 3], up: [f32; 3], width: &Lanes) -> Lanes {
    let mut places = Places {
        u: [0.0; LANES],
        v: [0.0; LANES],
        cells_u: [0; LANES],
        cells_v: [0; LANES],
        period: [0.0; LANES],
        seed: faces.seed,
        footprint: [0.0; LANES],
    };
    let mut light = [0.0; LANES];
    for lane in 0..LANES {
        let mantle = faces.round[lane] == 1.0;
        let met = meet(faces, d, lane);
        let radius = faces.half[0][lane];
        let normal = [
            pick(mantle, met.place[0] / radius, 0.0),
            pick(mantle, met.place[1] / radius, 0.0),
            pick(mantle, 0.0, 1.0),
        ];
        let dot = |v: [f32; 3]| normal[0] * v[0] + normal[1] * v[1] + normal[2] * v[2];
        let facing = dot(met.l);
        light[lane] = 1.0 + LIGHT * pick(facing > 0.0, -1.0, 1.0) * dot(along(faces, up, lane));
        let rest: [f32; 3] = std::array::from_fn(|k| faces.rest[k][lane] + met.distance * met.l[k]);
        places.u[lane] = pick(mantle, turns(met.place[0], met.place[1]), rest[0]);
        places.v[lane] = pick(mantle, rest[2], rest[1]);
        places.cells_u[lane] = whole(pick(mantle, 0.0, faces.cells[0][lane]));
        places.cells_v[lane] = whole(pick(mantle, faces.cells[2][lane], faces.cells[1][lane]));
        places.period[lane] = pick(mantle, std::f32::consts::TAU * radius, 0.0);
        let footprint = log2_of(met.distance * width[lane]) - 2.0 / 3.0 * log2_of(most(facing.abs(), 1e-12));
        // Seen from nowhere, the finest octave is too fine.
        places.footprint[lane] = pick(width[lane] > 0.0, footprint, 99.0);
    }
    let texture = textured(&places);
    std::array::from_fn(|lane| light[lane] * texture[lane])
}

fn cases(size: Size) -> Vec<Case> {
    let scene = surface_inputs(size);
    let ids = scene.ids(size, &scene.rays);
    let params = Params { width: size.width, height: size.height, share: 0.5 };
    let before = planes(size, 1, Fill::Textured, [100.0, 228.0], 3);
    let len = size.stride() * size.height as usize;
    vec![Case {
        name: "scene".to_owned(),
        params: bytemuck::bytes_of(&params).to_vec(),
        inputs: vec![scene.rays, scene.surfaces, ids, before],
        outputs: vec![len, len],
        extent: size,
    }]
}
