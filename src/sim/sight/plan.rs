//! The buffers and steps of a look.

use super::SightConfig;
use super::scene::{Scene, Tiles};
use crate::error::Result;
use crate::kernels::facets::RAY;
use crate::kernels::{cast, sensor, shade};
use crate::plan::{BufId, Bufs, Plan, Shape, Step};
use crate::sim::{RayTable, World};

/// What the host writes and reads.
pub(super) struct Ports {
    /// Surfaces, lists and members of each pose of an exposure.
    pub(super) scenes: Vec<[BufId; 3]>,
    pub(super) seed: BufId,
    pub(super) picture: BufId,
    pub(super) nearness: BufId,
}

/// The plan: `ingest[0]` is for one pose, `ingest[1]` for an exposure of several.
pub(super) fn plan(
    rays: &RayTable,
    tiles: &Tiles,
    world: &World,
    config: &SightConfig,
) -> Result<(Plan, Ports)> {
    let size = rays.size();
    let (plane, quads) = (Shape::planar(size, 1), Shape::quads(size));
    let mut bufs = Bufs::default();
    let table = bufs.constant("rays", ray_values(rays));
    let dark = bufs.constant("dark", vec![0.0; plane.len()]);
    let seed = bufs.input("seed", 2);
    let scenes: Vec<[BufId; 3]> = (0..config.blur_poses)
        .map(|pose| {
            [
                bufs.input(format!("surfaces of pose {pose}"), Scene::surface_values(world)),
                bufs.input(format!("lists of pose {pose}"), 4 * tiles.count()),
                bufs.input(format!("members of pose {pose}"), Scene::most_members(tiles, world)),
            ]
        })
        .collect();
    let ids = bufs.computed("ids", quads);
    let sums = [bufs.computed("gray, even poses", plane), bufs.computed("gray, odd poses", plane)];
    let nearness = bufs.computed("nearness", plane);
    let other_nearness = bufs.computed("nearness of other poses", plane);
    let picture = bufs.computed("picture", plane);
    let (width, height) = (size.width, size.height);
    let exposure = |scenes: &[[BufId; 3]]| {
        let mut steps = Vec::new();
        let mut sum = dark;
        for (pose, &[surfaces, lists, members]) in scenes.iter().enumerate() {
            let params = cast::Params { width, height, tiles: tiles.across as u32 };
            let inputs = [table, surfaces, lists, members];
            steps.push(Step::new(&cast::KERNEL, format!("pose {pose}"), params, &inputs, &[(ids, quads)]));
            let params = shade::Params { width, height, share: 1.0 / scenes.len() as f32 };
            // The picture's truth is that of the middle of the exposure.
            let near = if pose == scenes.len() / 2 { nearness } else { other_nearness };
            let inputs = [table, surfaces, ids, sum];
            sum = sums[pose % 2];
            let outputs = [(sum, plane), (near, plane)];
            steps.push(Step::new(&shade::KERNEL, format!("pose {pose}"), params, &inputs, &outputs));
        }
        let params = sensor::Params { width, height, noise: sensor::noise_step(config.noise_levels) };
        steps.push(Step::new(&sensor::KERNEL, "picture", params, &[sum, seed], &[(picture, plane)]));
        steps
    };
    let ingest = [exposure(&scenes[..1]), exposure(&scenes)];
    let plan = Plan {
        size,
        flow_size: size,
        bufs: bufs.finish(),
        setup: Vec::new(),
        ingest,
        pair: [Vec::new(), Vec::new()],
        frame: seed,
        certainty: None,
        motion: None,
        // A look has no flow: nothing reads these.
        flow: [picture; 2],
        initial_flow: false,
        confidence: None,
        fields: Vec::new(),
    };
    plan.validate()?;
    Ok((plan, Ports { scenes, seed, picture, nearness }))
}

/// The `rays` buffer. Where the lens shows nothing, pixels have no width.
fn ray_values(rays: &RayTable) -> Vec<f32> {
    let size = rays.size();
    let (width, stride) = (size.width as usize, size.stride());
    let mut values = Vec::with_capacity(RAY * stride * size.height as usize);
    for y in 0..size.height as usize {
        for x in 0..stride {
            let (centre, corners) = (rays.centre(x.min(width - 1), y), rays.corners(x.min(width - 1), y));
            let pixel_rad = (0.5 * (corners[3] - corners[0]).cross(corners[2] - corners[1]).length()).sqrt();
            if !(centre.is_finite() && pixel_rad.is_finite()) {
                values.extend([0.0; RAY]);
                continue;
            }
            let [a, b, c, d] = corners.map(|corner| (corner / corner.z).truncate());
            let (right, down) = ((b - a + d - c) / 2.0, (c - a + d - b) / 2.0);
            let at = centre / centre.z;
            values.extend(
                [at.x, at.y, pixel_rad, 0.0, right.x, down.x, right.y, down.y].map(|value| value as f32),
            );
        }
    }
    values
}
