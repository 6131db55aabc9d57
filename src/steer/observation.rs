//! What steering is told at a frame.

use glam::{DMat3, DVec3};

use super::Aircraft;
use crate::camera::{FRD_FROM_CAMERA, roll_pitch_yaw_rad};
use crate::pipeline::Cue;
use crate::sphere::{Heading, Sectors};

/// What steering is told at a frame.
#[derive(Clone, Copy, Debug)]
pub struct Observation<'a> {
    /// The frame's time in seconds.
    pub time_s: f64,
    /// The aircraft's attitude then: turns what is given in the body's frame (forward, right, down) into the level one's
    /// (north, east, down).
    pub ned_from_body: DMat3,
    /// Its speed through the air, m/s.
    pub airspeed_m_s: f64,
    /// Which way it moves, a unit vector in the body's frame, from vanes or a navigation filter; none for what the view
    /// itself tells.
    pub motion_body: Option<DVec3>,
    /// Where the flight is to lead.
    pub goal: Goal,
    /// What the view says; none if the cue is not to be used.
    pub view: Option<View<'a>>,
}

/// Where a flight is to lead.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Goal {
    /// In which direction, clockwise from north.
    pub yaw_rad: f64,
    /// By how much the aircraft flies too low, in metres; none where no altitude is to be kept.
    pub too_low_m: Option<f64>,
}

/// What the view says.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// Its sectors, in the camera's frame.
    pub sectors: &'a Sectors,
    /// Which way the camera moves, in its own frame.
    pub heading: Heading,
}

impl<'a> View<'a> {
    /// What a pipeline's cue says; none if it is not to be used.
    pub fn of(cue: &Cue<'a>) -> Option<Self> {
        cue.invalid.is_none().then_some(Self { sectors: cue.sectors, heading: cue.heading })
    }
}

/// How the aircraft moves at a frame's time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Moving {
    pub(super) bank_rad: f64,
    /// Of the path, not of the nose.
    pub(super) yaw_rad: f64,
    pub(super) climb_rad: f64,
    pub(super) speed_m_s: f64,
}

/// A heading of the view is taken for the direction of motion if its standard error is below this.
const KNOWN_RAD: f64 = 0.1;

impl Moving {
    pub(super) fn of(aircraft: &Aircraft, o: &Observation<'_>) -> Self {
        let seen = o.view.map(|view| view.heading).filter(|heading| heading.error_rad <= KNOWN_RAD);
        let body = o.motion_body.or(seen.map(|heading| aircraft.body_from_camera * heading.direction));
        // Where nothing is known it moves the way its nose points.
        let motion = o.ned_from_body * body.filter(|motion| motion.x > 0.0).unwrap_or(DVec3::X);
        Self {
            bank_rad: roll_pitch_yaw_rad(&o.ned_from_body)[0],
            yaw_rad: motion.y.atan2(motion.x),
            climb_rad: (-motion.z).atan2(motion.x.hypot(motion.y)),
            speed_m_s: o.airspeed_m_s,
        }
    }

    /// Turns the level frame's axes along the motion, as a camera's that looks that way (right, down, forward), into
    /// north, east and down.
    pub(super) fn ned_from_level(&self) -> DMat3 {
        DMat3::from_rotation_z(self.yaw_rad) * FRD_FROM_CAMERA
    }
}
