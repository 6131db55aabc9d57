//! How what is seen moves.

use glam::DVec3;
use rayon::prelude::*;

use super::{RayTable, World};
use crate::camera::{Camera, Pose};
use crate::error::{Error, Result};
use crate::frame::{FlowField, UNKNOWN_FLOW};

/// A point is hidden if something is nearer to the camera by more than this share of its distance.
const HIDDEN: f64 = 1e-6;

/// The motion of a camera relative to a world at rest, in the camera's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Velocity, m/s.
    pub velocity_m_s: DVec3,
    /// Angular rate, rad/s.
    pub rate_rad_s: DVec3,
}

/// What is seen in a direction: the truth of a bearing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// The direction: a unit vector in the camera's frame.
    pub bearing: DVec3,
    /// One over the distance, 1/m; 0 for the sky.
    pub nearness_per_m: f64,
    /// Unit normal of what is seen, in the camera's frame; 0 for the sky.
    pub normal_camera: DVec3,
}

impl Seen {
    /// How the bearing moves: −ρ(v − p(pᵀv)) + p × ω, rad/s.
    pub fn flow_rad_s(&self, motion: &Motion) -> DVec3 {
        let (p, v) = (self.bearing, motion.velocity_m_s);
        -self.nearness_per_m * (v - p * p.dot(v)) + p.cross(motion.rate_rad_s)
    }

    /// ρ‖v‖, 1/s: one over the time in which the camera flies the distance of what is seen.
    pub fn nearness_rate_per_s(&self, motion: &Motion) -> f64 {
        self.nearness_per_m * motion.velocity_m_s.length()
    }

    /// The divergence of the flow on the view sphere, 1/s. It depends on the surface's normal, not on how it bends.
    pub fn divergence_per_s(&self, motion: &Motion) -> f64 {
        if self.nearness_per_m == 0.0 {
            return 0.0;
        }
        let (p, v, n) = (self.bearing, motion.velocity_m_s, self.normal_camera);
        self.nearness_per_m * (3.0 * v.dot(p) - n.dot(v) / n.dot(p))
    }
}

impl World {
    /// What a camera sees in the direction of a unit vector of its frame.
    pub fn seen(&self, pose: &Pose, bearing: DVec3) -> Seen {
        let hit = self.hit(pose.position_world, pose.world_from_camera * bearing);
        Seen {
            bearing,
            nearness_per_m: hit.map_or(0.0, |hit| 1.0 / hit.distance_m),
            normal_camera: hit
                .map_or(DVec3::ZERO, |hit| pose.world_from_camera.transpose() * hit.normal_world),
        }
    }
}

/// The true flow in pixels of the distorted pictures from one pose to another: of each pixel's centre, where what is seen
/// there goes, also if that is outside the picture. Unknown where it is hidden or not in front of the later camera, and
/// where the lens shows nothing.
///
/// # Errors
/// [`Error::SizeMismatch`] if the rays are of another size than the camera.
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
    let moved = |i: u32| -> Option<[f32; 2]> {
        let pixel = [i % size.width, i / size.width];
        let direction = from.world_from_camera * rays.bearing(pixel[0], pixel[1])?;
        // The sky is at rest however the camera moves.
        let (there, distance_m) = match world.hit(from.position_world, direction) {
            None => (direction, f64::INFINITY),
            Some(hit) => {
                let there = from.position_world + hit.distance_m * direction - to.position_world;
                (there, there.length())
            }
        };
        let first = world.hit(to.position_world, there.normalize());
        if first.is_some_and(|first| first.distance_m < distance_m * (1.0 - HIDDEN)) {
            return None;
        }
        let at = camera.project(to.world_from_camera.transpose() * there)?;
        Some(std::array::from_fn(|c| (at[c] - f64::from(pixel[c])) as f32))
    };
    let data = (0..size.pixels() as u32).into_par_iter().map(|i| moved(i).unwrap_or([UNKNOWN_FLOW; 2]));
    Ok(FlowField { size, data: data.collect() })
}
