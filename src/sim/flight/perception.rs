//! A sensor's input and output at a frame.

use glam::DVec3;

use super::accuracy::{Divergences, Measured};
use crate::camera::Pose;
use crate::frame::Image;
use crate::pipeline::Cue;
use crate::sim::World;
use crate::sphere::{Climb, Heading};
use crate::steer::View;

/// A sensor's input at a frame.
pub(super) struct SensorInput<'a> {
    pub(super) world: &'a World,
    pub(super) pose: Pose,
    pub(super) velocity_world_m_s: DVec3,
    /// The camera's direction of motion in its own frame, if vanes measure it.
    pub(super) heading: Option<Heading>,
    /// How steeply it climbs, if the vertical speed is known.
    pub(super) climb: Option<Climb>,
    pub(super) frame: u64,
    pub(super) time_s: f64,
}

/// A sensor's output at a frame.
#[derive(Default)]
pub(super) struct Perception<'a> {
    pub(super) image: Option<&'a Image>,
    pub(super) cue: Option<Cue<'a>>,
    pub(super) view: Option<View<'a>>,
    /// Why there is no view.
    pub(super) invalid: Option<String>,
    /// The error against the truth, if it is measured.
    pub(super) measured: Option<Measured>,
    pub(super) divergences: Option<&'a Divergences>,
}
