//! Ground truth: exact nearness, flow and divergence.

use glam::DVec3;
use rayon::prelude::*;

use super::rays::TILE;
use super::{Hit, RayTable, World};
use crate::camera::{Camera, Pose};
use crate::error::{Error, Result};
use crate::frame::{FlowField, UNKNOWN_FLOW};
use crate::sphere::model::bearing_rate;

/// A point is hidden if something is nearer to the camera by more than this share of its distance.
const HIDDEN: f64 = 1e-6;

/// The motion of a camera relative to a world at rest, in the camera's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Twist {
    /// Velocity, m/s.
    pub velocity_m_s: DVec3,
    /// Angular rate, rad/s.
    pub rate_rad_s: DVec3,
}

/// What a ray meets: the ground truth of a bearing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// The direction: a unit vector in the camera's frame.
    pub bearing: DVec3,
    /// The inverse of the distance, 1/m; 0 for the sky.
    pub nearness_per_m: f64,
    /// The surface's unit normal, in the camera's frame; 0 for the sky.
    pub normal_camera: DVec3,
}

impl Seen {
    /// The flow of the bearing: −ρ(v − p(pᵀv)) + p × ω, rad/s.
    pub fn flow_rad_s(&self, motion: &Twist) -> DVec3 {
        bearing_rate(self.bearing, self.nearness_per_m, motion.velocity_m_s, motion.rate_rad_s)
    }

    /// The nearness rate ρ‖v‖, 1/s: the inverse of the time in which the camera flies the distance of the point.
    pub fn nearness_rate_per_s(&self, motion: &Twist) -> f64 {
        self.nearness_per_m * motion.velocity_m_s.length()
    }

    /// The divergence of the flow on the view sphere, 1/s. It depends on the surface's normal, not on its curvature.
    pub fn divergence_per_s(&self, motion: &Twist) -> f64 {
        if self.nearness_per_m == 0.0 {
            return 0.0;
        }
        let (p, v, n) = (self.bearing, motion.velocity_m_s, self.normal_camera);
        self.nearness_per_m * (3.0 * v.dot(p) - n.dot(v) / n.dot(p))
    }
}

impl World {
    /// What a camera sees along a bearing: a unit vector in its frame.
    pub fn seen(&self, pose: &Pose, bearing: DVec3) -> Seen {
        self.seen_among(0..self.surfaces.len(), pose, bearing)
    }

    /// Like [`World::seen`], if only some surfaces can be met.
    pub(super) fn seen_among(
        &self,
        surfaces: impl Iterator<Item = usize>,
        pose: &Pose,
        bearing: DVec3,
    ) -> Seen {
        let hit = self.hit_among(surfaces, pose.position_world, pose.world_from_camera * bearing);
        Seen {
            bearing,
            nearness_per_m: hit.map_or(0.0, |hit| 1.0 / hit.distance_m),
            normal_camera: hit
                .map_or(DVec3::ZERO, |hit| pose.world_from_camera.transpose() * hit.normal_world),
        }
    }
}

/// The true flow in pixels of the distorted images from one pose to another: the displacement of the point that each
/// pixel's centre shows, even to outside the image. Unknown where the point is hidden or not in front of the later
/// camera, and where the lens shows nothing.
///
/// # Errors
/// [`Error::SizeMismatch`] if the rays and the camera have different sizes.
pub fn displacement(
    world: &World,
    camera: &Camera,
    rays: &RayTable,
    from: &Pose,
    to: &Pose,
) -> Result<FlowField> {
    let size = rays.size();
    if camera.size != size {
        return Err(Error::SizeMismatch { what: "camera".to_owned(), found: camera.size, expected: size });
    }
    let width = size.width as usize;
    let mut data = vec![[UNKNOWN_FLOW; 2]; size.pixels()];
    data.par_chunks_mut(width * TILE).enumerate().for_each(|(tile_y, band)| {
        for tile_x in 0..width.div_ceil(TILE) {
            let near = reached_from_both(world, rays, from, to.position_world, [tile_x, tile_y]);
            let first =
                |origin: DVec3, direction: DVec3| world.hit_among(near.iter().copied(), origin, direction);
            for (row, flow) in band.chunks_exact_mut(width).enumerate() {
                for (x, flow) in flow.iter_mut().enumerate().skip(tile_x * TILE).take(TILE) {
                    let pixel = [x as u32, (tile_y * TILE + row) as u32];
                    if let Some(there) = goes_to(camera, rays, [from, to], pixel, &first) {
                        *flow = std::array::from_fn(|c| (there[c] - f64::from(pixel[c])) as f32);
                    }
                }
            }
        }
    });
    Ok(FlowField { size, data })
}

/// The pixel at which the later camera shows what the earlier one shows at a pixel. `first` finds a ray's first hit.
fn goes_to(
    camera: &Camera,
    rays: &RayTable,
    [from, to]: [&Pose; 2],
    [x, y]: [u32; 2],
    first: &impl Fn(DVec3, DVec3) -> Option<Hit>,
) -> Option<[f64; 2]> {
    let direction = from.world_from_camera * rays.bearing(x, y)?;
    // The sky is at rest however the camera moves.
    let (there, distance_m) = match first(from.position_world, direction) {
        None => (direction, f64::INFINITY),
        Some(hit) => {
            let there = from.position_world + hit.distance_m * direction - to.position_world;
            (there, there.length())
        }
    };
    let hit = first(to.position_world, there.normalize());
    if hit.is_some_and(|hit| hit.distance_m < distance_m * (1.0 - HIDDEN)) {
        return None;
    }
    camera.project(to.world_from_camera.transpose() * there)
}

/// The surfaces that may be visible in a tile, or may occlude what it shows from another position.
fn reached_from_both(
    world: &World,
    rays: &RayTable,
    pose: &Pose,
    other_world: DVec3,
    [tile_x, tile_y]: [usize; 2],
) -> Vec<usize> {
    // What lies between the other position and a point on a plane's inner side is no further beyond it than that
    // position.
    let sides = rays.sides(tile_x, tile_y).map(|side| {
        let normal = (pose.world_from_camera * side).normalize();
        let beyond_m = normal.dot(other_world - pose.position_world).min(0.0);
        (pose.position_world + beyond_m * normal, normal)
    });
    let within =
        |i: &usize| sides.iter().all(|(origin, normal)| world.surfaces[*i].reaches(*origin, *normal));
    (0..world.surfaces.len()).filter(within).collect()
}
