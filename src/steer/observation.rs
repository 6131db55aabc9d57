//! The inputs of steering.

use glam::{DMat3, DVec3};

use super::Aircraft;
use crate::camera::{FRD_FROM_CAMERA, roll_pitch_yaw_rad};
use crate::pipeline::Cue;
use crate::sphere::{Heading, Sectors};

/// The inputs of steering at one frame.
#[derive(Clone, Copy, Debug)]
pub struct Observation<'a> {
    /// The frame's time in seconds.
    pub time_s: f64,
    /// The aircraft's attitude then: the rotation from the body's frame (forward, right, down) to the level one's
    /// (north, east, down).
    pub ned_from_body: DMat3,
    /// The airspeed, m/s.
    pub airspeed_m_s: f64,
    /// The direction of motion, a unit vector in the body's frame, from vanes or a navigation filter; `None` to use
    /// the view's heading.
    pub motion_body: Option<DVec3>,
    /// The goal of the flight.
    pub goal: Goal,
    /// The view's sectors and heading; `None` if the cue is invalid.
    pub view: Option<View<'a>>,
}

/// The goal of a flight.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Goal {
    /// The direction, clockwise from north.
    pub yaw_rad: f64,
    /// How far the aircraft is below the desired altitude, in metres; `None` if no altitude is to be held.
    pub too_low_m: Option<f64>,
}

/// The measurements of the view.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// The sectors, in the camera's frame.
    pub sectors: &'a Sectors,
    /// The direction of the camera's motion, in its own frame.
    pub heading: Heading,
}

impl<'a> View<'a> {
    /// The measurements of a pipeline's cue; `None` if it is invalid.
    pub fn of(cue: &Cue<'a>) -> Option<Self> {
        cue.invalid.is_none().then_some(Self { sectors: cue.sectors, heading: cue.heading })
    }
}

/// The aircraft's motion at a frame's time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Moving {
    pub(super) bank_rad: f64,
    /// The yaw of the path, not of the nose.
    pub(super) yaw_rad: f64,
    pub(super) climb_rad: f64,
    pub(super) speed_m_s: f64,
}

/// The largest standard error at which the view's heading is used as the direction of motion.
const KNOWN_RAD: f64 = 0.1;

impl Moving {
    pub(super) fn of(aircraft: &Aircraft, o: &Observation<'_>) -> Self {
        let seen = o.view.map(|view| view.heading).filter(|heading| heading.error_rad <= KNOWN_RAD);
        let body = o.motion_body.or(seen.map(|heading| aircraft.body_from_camera * heading.direction));
        // Without a known direction of motion the aircraft moves the way its nose points.
        let motion = o.ned_from_body * body.filter(|motion| motion.x > 0.0).unwrap_or(DVec3::X);
        Self {
            bank_rad: roll_pitch_yaw_rad(&o.ned_from_body)[0],
            yaw_rad: motion.y.atan2(motion.x),
            climb_rad: (-motion.z).atan2(motion.x.hypot(motion.y)),
            speed_m_s: o.airspeed_m_s,
        }
    }

    /// The rotation from the frame of a level camera that looks along the motion (right, down, forward) to north,
    /// east and down.
    pub(super) fn ned_from_level(&self) -> DMat3 {
        DMat3::from_rotation_z(self.yaw_rad) * FRD_FROM_CAMERA
    }
}
