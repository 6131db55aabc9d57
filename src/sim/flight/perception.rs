//! What a sensor is given at a frame, and what it says.

use glam::DVec3;

use super::accuracy::{Divergences, Measured};
use crate::camera::Pose;
use crate::frame::Image;
use crate::pipeline::Cue;
use crate::sim::World;
use crate::sphere::Heading;
use crate::steer::View;

/// What a sensor is given at a frame.
pub(super) struct SensorInput<'a> {
    pub(super) world: &'a World,
    pub(super) pose: Pose,
    pub(super) velocity_world_m_s: DVec3,
    /// Which way the camera moves, in its own frame, where vanes tell.
    pub(super) heading: Option<Heading>,
    pub(super) frame: u64,
    pub(super) time_s: f64,
}

/// What a sensor says of a frame.
#[derive(Default)]
pub(super) struct Perception<'a> {
    pub(super) image: Option<&'a Image>,
    pub(super) cue: Option<Cue<'a>>,
    pub(super) view: Option<View<'a>>,
    /// Why there is no view.
    pub(super) invalid: Option<String>,
    /// How far it is from the truth, where that is asked for.
    pub(super) measured: Option<Measured>,
    pub(super) divergences: Option<&'a Divergences>,
}
