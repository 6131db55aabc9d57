//! A synthetic scene for the kernels that render surfaces.

use super::cast::cast;
use super::surface_layout::{Kind, RAY, SurfaceRecord, TILE};
use super::test_inputs::Random;
use crate::frame::Size;

/// No ray of the scene passes an edge by less than this share of its length, to the side or along it.
const MARGIN: f32 = 1e-4;

/// The buffers of a scene.
pub(super) struct SurfaceInputs {
    pub(super) rays: Vec<f32>,
    pub(super) surfaces: Vec<f32>,
    pub(super) lists: Vec<f32>,
    pub(super) members: Vec<f32>,
    /// Tiles across and down.
    pub(super) tiles: [usize; 2],
}

impl SurfaceInputs {
    /// The samples' numbers.
    pub(super) fn ids(&self, size: Size, rays: &[f32]) -> Vec<f32> {
        cast(size, self.tiles[0], [rays, &self.surfaces, &self.lists, &self.members])
    }
}

/// The scene is computed for an image of 5 × 5 tiles, and larger ones repeat it.
const PERIOD: [usize; 2] = [5 * TILE[0], 5 * TILE[1]];

/// Ground, walls, boxes and cylinders, in all directions.
pub(super) fn surface_inputs(size: Size) -> SurfaceInputs {
    let block = block();
    let tiles = [(size.width as usize).div_ceil(TILE[0]), (size.height as usize).div_ceil(TILE[1])];
    let (lists, rays) = (block.lists.as_chunks::<4>().0, block.rays.as_chunks::<RAY>().0);
    let list = |i: usize| lists[i / tiles[0] % 5 * 5 + i % tiles[0] % 5];
    let ray = |i: usize| {
        let (x, y) = ((i % size.stride()).min(size.width as usize - 1), i / size.stride());
        rays[y % PERIOD[1] * PERIOD[0] + x % PERIOD[0]]
    };
    SurfaceInputs {
        lists: (0..tiles[0] * tiles[1]).flat_map(list).collect(),
        rays: (0..size.stride() * size.height as usize).flat_map(ray).collect(),
        tiles,
        ..block
    }
}

/// 5 × 5 tiles of it. Rays that are near an edge are taken elsewhere.
fn block() -> SurfaceInputs {
    let records = records();
    let up = [0.05, -0.995, 0.09, 0.0];
    let surfaces = up.into_iter().chain(records.iter().flat_map(SurfaceRecord::values)).collect();
    let mut nearest_first: Vec<usize> = (0..records.len()).collect();
    nearest_first.sort_by(|a, b| records[*a].nearest_m.total_cmp(&records[*b].nearest_m));
    let (mut lists, mut members) = (Vec::new(), Vec::new());
    for tile in 0..25 {
        // A tile in five can see nothing, one in five no boxes, one in five no cylinders.
        let without = (tile / 5 + tile % 5) % 5;
        for round in [false, true] {
            let first = members.len();
            if without != 1 && without != if round { 4 } else { 3 } {
                let of_kind = |i: &&usize| (records[**i].kind == Kind::Cylinder) == round;
                members.extend(nearest_first.iter().filter(of_kind).map(|i| *i as f32));
            }
            lists.extend([first as f32, (members.len() - first) as f32]);
        }
    }
    let mut scene = SurfaceInputs { rays: Vec::new(), surfaces, lists, members, tiles: [5, 5] };
    let size = Size::new(PERIOD[0] as u32, PERIOD[1] as u32);
    let mut random = Random::new(11);
    let mut rays = vec![[0.0; RAY]; size.pixels()];
    let mut todo: Vec<usize> = (0..rays.len()).collect();
    // It takes four rounds.
    for _ in 0..20 {
        for &i in &todo {
            rays[i] = ray(&mut random);
        }
        todo = near_an_edge(&scene, size, &rays);
        if todo.is_empty() {
            break;
        }
    }
    scene.rays = rays.into_flattened();
    scene
}

/// The pixels whose centre or samples meet another surface if their rays are rotated by the margin.
fn near_an_edge(scene: &SurfaceInputs, size: Size, rays: &[[f32; RAY]]) -> Vec<usize> {
    let ids = |centres: bool, [x, y]: [f32; 2]| {
        let turned = |ray: &[f32; RAY]| {
            let [a, b, width, _, slopes @ ..] = *ray;
            // A direction this far off the axis rotates by less than its tangents change.
            let scale = MARGIN * (1.0 + a * a + b * b);
            let [p, q, r, s] = if centres { [0.0; 4] } else { slopes };
            [a + x * scale, b + y * scale, width, 0.0, p, q, r, s]
        };
        let rays: Vec<f32> = rays.iter().flat_map(turned).collect();
        scene.ids(size, &rays).as_chunks::<4>().0.to_vec()
    };
    let there = [false, true].map(|centres| {
        [[0.0, 0.0], [1.0, 0.3], [-0.3, 1.0], [-1.0, -0.3], [0.3, -1.0]].map(|turn| ids(centres, turn))
    });
    let steady = |i: &usize| there.iter().all(|ids| ids.iter().all(|of| of[*i] == ids[0][*i]));
    (0..rays.len()).filter(|i| !steady(i)).collect()
}

fn ray(random: &mut Random) -> [f32; RAY] {
    let mut within = |low: f32, high: f32| low + random.next() * (high - low);
    let (x, y, width) = (within(-1.2, 1.2), within(-0.9, 0.9), within(2e-3, 8e-3));
    if within(0.0, 1.0) < 0.02 {
        // The lens shows nothing.
        return [x, y, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    }
    // The samples of one pixel in three lie far apart, so that many see different things.
    let apart = if within(0.0, 3.0) < 1.0 { 20.0 * width } else { width };
    let slant = [within(-0.1, 0.1), within(-0.1, 0.1)].map(|share| share * apart);
    [x, y, width, 0.0, within(0.8, 1.2) * apart, slant[0], slant[1], apart]
}

fn records() -> Vec<SurfaceRecord> {
    let plain = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let ground = [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]];
    let upright = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]];
    let tilted = [[0.8, 0.36, 0.48], [-0.6, 0.48, 0.64], [0.0, -0.8, 0.6]];
    let record = |number, kind, axes: [[f32; 3]; 3], middle: [f32; 3], half_m| {
        let place_m = axes.map(|axis| -(axis[0] * middle[0] + axis[1] * middle[1] + axis[2] * middle[2]));
        let cells = place_m.map(|place| (place / 4.0).floor() + 3000.0);
        let texture_m = std::array::from_fn(|i| place_m[i] - 4.0 * (cells[i] - 3000.0));
        SurfaceRecord { axes, place_m, half_m, nearest_m: 0.0, texture_m, cells, number, kind }
    };
    let mut records = vec![
        record(0, Kind::Flat, ground, [0.0, 1.7, 0.0], [1e9, 1e9, 0.0]),
        record(3, Kind::Cuboid, plain, [-4.0, -2.0, 14.0], [1.5, 3.7, 2.0]),
        record(1999, Kind::Cuboid, tilted, [3.0, 0.5, 8.0], [1.0, 0.7, 1.4]),
        record(17, Kind::Cylinder, upright, [0.3, -1.0, 6.0], [0.3, 0.3, 2.7]),
        record(18, Kind::Cylinder, tilted, [-2.0, -1.5, 5.0], [0.8, 0.8, 0.6]),
        record(19, Kind::Cylinder, upright, [18.0, -4.0, 90.0], [2.5, 2.5, 6.0]),
        record(20, Kind::Flat, tilted, [0.0, -6.0, 30.0], [9.0, 4.0, 0.0]),
        // The camera is inside these: the sky is seen by tiles that leave both out.
        record(21, Kind::Cuboid, plain, [10.0, -20.0, 30.0], [300.0, 90.0, 300.0]),
        record(22, Kind::Cylinder, upright, [-15.0, -10.0, 20.0], [250.0, 250.0, 60.0]),
    ];
    for record in &mut records {
        let beyond: [f32; 3] = std::array::from_fn(|i| (record.place_m[i].abs() - record.half_m[i]).max(0.0));
        // A cylinder's box is as near or nearer.
        record.nearest_m = beyond.map(|b| b * b).iter().sum::<f32>().sqrt();
    }
    records
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_ray_is_near_an_edge_and_much_is_seen() {
        for size in [Size::new(1, 1), Size::new(65, 33), Size::new(161, 83)] {
            let scene = surface_inputs(size);
            assert_eq!(near_an_edge(&scene, size, scene.rays.as_chunks::<RAY>().0), [0; 0]);
        }
        let size = Size::new(PERIOD[0] as u32, PERIOD[1] as u32);
        let scene = surface_inputs(size);
        let ids = scene.ids(size, &scene.rays);
        let mixed = ids.as_chunks::<4>().0.iter().filter(|ids| ids.iter().any(|id| *id != ids[0])).count();
        let mut kinds: Vec<u32> = ids.iter().map(|id| *id as u32).collect();
        kinds.sort_unstable();
        kinds.dedup();
        // The sky, and faces of all surfaces; pixels with an edge between their samples.
        println!("{mixed} of {} pixels with an edge, {kinds:?}", size.pixels());
        assert!(kinds.len() >= 16 && kinds[0] == 0 && mixed >= 100, "{mixed}, {kinds:?}");
    }
}
