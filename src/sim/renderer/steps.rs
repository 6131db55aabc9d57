//! The buffers and steps of rendering.

use super::RendererConfig;
use super::visible::{Tiles, VisibleSurfaces};
use crate::error::Result;
use crate::kernels::surface_layout::RAY;
use crate::kernels::{cast, sensor, shade};
use crate::plan::{Bufs, Fill, Plan, Port, PortKind, Shape, Step, pack};
use crate::sim::{RayTable, World};

/// The names of the inputs of each pose of an exposure: surfaces, lists and members.
pub(super) const POSES: [[&str; 3]; RendererConfig::MAX_POSES] = [
    ["surfaces 0", "lists 0", "members 0"],
    ["surfaces 1", "lists 1", "members 1"],
    ["surfaces 2", "lists 2", "members 2"],
    ["surfaces 3", "lists 3", "members 3"],
    ["surfaces 4", "lists 4", "members 4"],
    ["surfaces 5", "lists 5", "members 5"],
    ["surfaces 6", "lists 6", "members 6"],
    ["surfaces 7", "lists 7", "members 7"],
];

/// The plan of an image that averages `poses` poses.
pub(super) fn plan(
    rays: &RayTable,
    tiles: &Tiles,
    world: &World,
    config: &RendererConfig,
    poses: usize,
) -> Result<Plan> {
    let size = rays.size();
    let (plane, quads) = (Shape::planar(size, 1), Shape::quads(size));
    let mut bufs = Bufs::default();
    let table = bufs.constant("rays", ray_values(rays));
    let mut sum = bufs.constant("dark", vec![0.0; plane.len()]);
    let seed = bufs.input("seed", 2);
    let ids = bufs.computed("ids", quads);
    let sums = [bufs.computed("gray, even poses", plane), bufs.computed("gray, odd poses", plane)];
    let nearness = bufs.computed("nearness", plane);
    let other_nearness = bufs.computed("nearness of other poses", plane);
    let picture = bufs.computed("picture", plane);
    let (width, height) = (size.width, size.height);
    let mut inputs = vec![Port::new("seed", PortKind::Raw { len: 2 }, seed, Fill::Required)];
    let mut steps = Vec::new();
    let lengths = [
        VisibleSurfaces::surface_values(world),
        4 * tiles.count(),
        VisibleSurfaces::most_members(tiles, world),
    ];
    for (pose, names) in POSES.iter().enumerate().take(poses) {
        let [surfaces, lists, members] = [0, 1, 2].map(|i| {
            let buf = bufs.input(names[i], lengths[i]);
            inputs.push(Port::new(names[i], PortKind::Raw { len: lengths[i] }, buf, Fill::Required));
            buf
        });
        let params = cast::Params { width, height, tiles: tiles.across as u32 };
        let seen = [table, surfaces, lists, members];
        steps.push(Step::new(&cast::KERNEL, format!("pose {pose}"), params, &seen, &[(ids, quads)]));
        let params = shade::Params { width, height, share: 1.0 / poses as f32 };
        // The image's nearness is that of the exposure's middle pose.
        let near = if pose == poses / 2 { nearness } else { other_nearness };
        let shaded = [table, surfaces, ids, sum];
        sum = sums[pose % 2];
        let outputs = [(sum, plane), (near, plane)];
        steps.push(Step::new(&shade::KERNEL, format!("pose {pose}"), params, &shaded, &outputs));
    }
    let params = sensor::Params { width, height, noise: sensor::noise_step(config.noise_levels) };
    steps.push(Step::new(&sensor::KERNEL, "picture", params, &[sum, seed], &[(picture, plane)]));
    let kind = PortKind::Plane { size, range: None };
    let outputs = vec![Port::output("picture", kind, picture), Port::output("nearness", kind, nearness)];
    let plan = Plan::single(size, bufs.finish(), steps, inputs, outputs);
    plan.validate()?;
    Ok(plan)
}

/// The content of the `rays` buffer. Pixels where the lens shows nothing have zero width.
fn ray_values(rays: &RayTable) -> Vec<f32> {
    pack::padded_groups(rays.size(), |x, y| {
        let (centre, corners) = (rays.centre(x, y), rays.corners(x, y));
        let pixel_rad = (0.5 * (corners[3] - corners[0]).cross(corners[2] - corners[1]).length()).sqrt();
        if !(centre.is_finite() && pixel_rad.is_finite()) {
            return [0.0; RAY];
        }
        let [a, b, c, d] = corners.map(|corner| (corner / corner.z).truncate());
        let (right, down) = ((b - a + d - c) / 2.0, (c - a + d - b) / 2.0);
        let at = centre / centre.z;
        [at.x, at.y, pixel_rad, 0.0, right.x, down.x, right.y, down.y].map(|value| value as f32)
    })
}
