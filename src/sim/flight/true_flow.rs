//! The true flow of a bearing.

use glam::{DMat3, DVec3};

use crate::camera::Pose;
use crate::sphere::model;

/// The true flow of a point with this bearing and nearness, from one exact pose to the next, with a rotation taken out:
/// its bearing half-way, and the flow there in radians.
pub(super) fn true_flow(
    bearing: DVec3,
    nearness_per_m: f64,
    [before, pose]: [&Pose; 2],
    prev_from_cur: &DMat3,
) -> (DVec3, DVec3) {
    let from_before =
        nearness_per_m * (pose.position_world - before.position_world) + pose.world_from_camera * bearing;
    let seen_before = before.world_from_camera.transpose() * from_before.normalize();
    model::midpoint_flow(prev_from_cur.transpose() * seen_before, bearing)
}
