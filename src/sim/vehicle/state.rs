use glam::{DMat3, DVec3};

use crate::camera::{FRD_FROM_CAMERA, Pose};
use crate::error::{Error, Result};
use crate::steer::Command;

/// Standard acceleration of gravity, m/s².
pub const GRAVITY_M_S2: f64 = 9.80665;
/// The usual step of the vehicles, seconds: eight per frame of 1/30 s.
pub const STEP_S: f64 = 1.0 / 240.0;
/// The longest integration step, seconds. The Runge–Kutta method is stable on the airframe up to twice that.
pub const MAX_STEP_S: f64 = 1.0 / 30.0;

/// The state of a vehicle. The world's frame is north, east, down (NED), the body's forward, right, down (FRD).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VehicleState {
    /// Time since the start, seconds.
    pub time_s: f64,
    /// Position, metres NED.
    pub position_ned_m: DVec3,
    /// Velocity over ground, m/s NED.
    pub velocity_ned_m_s: DVec3,
    /// The rotation from the body's frame to the world's.
    pub world_from_body: DMat3,
    /// Angular rate relative to the world, rad/s FRD.
    pub rate_body_rad_s: DVec3,
    /// Velocity relative to the air, m/s FRD. Its length is the airspeed.
    pub air_velocity_body_m_s: DVec3,
}

impl VehicleState {
    /// The pose of a camera at the vehicle's origin that looks along the body's x axis.
    pub fn camera_pose(&self) -> Pose {
        Pose {
            position_world: self.position_ned_m,
            world_from_camera: self.world_from_body * FRD_FROM_CAMERA,
        }
    }
}

/// A vehicle that follows commands.
pub trait Vehicle: Send {
    /// The present state.
    fn state(&self) -> VehicleState;

    /// Advances by one step under a command, usually [`STEP_S`].
    ///
    /// A command whose bank or climb is not finite counts as level wings and no climb, so that the state never
    /// becomes NaN. A step that is not above 0 changes nothing, and one longer than [`MAX_STEP_S`] is clamped to
    /// that; [`VehicleState::time_s`] has the time flown.
    fn advance(&mut self, command: &Command, step_s: f64);
}

/// The start of a flight: level, trimmed relative to the air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// Position, metres NED.
    pub position_ned_m: DVec3,
    /// Heading, radians clockwise from north.
    pub yaw_rad: f64,
    /// Airspeed, m/s, above 0. It is also the commanded one.
    pub speed_m_s: f64,
}

impl Start {
    /// Checks every field.
    ///
    /// # Errors
    /// [`Error::Parameter`] for the first that is out of range.
    pub fn validate(&self) -> Result<()> {
        if !self.position_ned_m.is_finite() {
            return Err(Error::parameter("position_ned_m", self.position_ned_m, "three finite lengths"));
        }
        if !self.yaw_rad.is_finite() {
            return Err(Error::parameter("yaw_rad", self.yaw_rad, "a finite angle"));
        }
        positive("speed_m_s", self.speed_m_s)
    }
}

/// The command, or level wings if it is not finite.
pub(super) fn sound(command: &Command) -> Command {
    if command.bank_rad.is_finite() && command.climb_rad.is_finite() { *command } else { Command::default() }
}

/// The clamped step; `None` for one that is not above 0.
pub(super) fn bounded(step_s: f64) -> Option<f64> {
    (step_s > 0.0).then(|| step_s.min(MAX_STEP_S))
}

/// Checks that a parameter is above 0 and finite.
pub(super) fn positive(name: &'static str, value: f64) -> Result<()> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(Error::parameter(name, value, "above 0 and finite"))
}

/// Checks that a parameter is 0 or above, and finite.
pub(super) fn not_negative(name: &'static str, value: f64) -> Result<()> {
    if value >= 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(Error::parameter(name, value, "0 or above, and finite"))
}

/// Checks that a parameter is within a range, its ends included.
pub(super) fn within(name: &'static str, value: f64, low: f64, high: f64) -> Result<()> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    Err(Error::parameter(name, value, format_args!("{low} to {high}")))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn each_field_of_a_start_is_checked() {
        let good = Start { position_ned_m: DVec3::ZERO, yaw_rad: 0.0, speed_m_s: 12.0 };
        good.validate().unwrap();
        let wrong = [
            ("position_ned_m", Start { position_ned_m: DVec3::NAN, ..good }),
            ("yaw_rad", Start { yaw_rad: f64::INFINITY, ..good }),
            ("speed_m_s", Start { speed_m_s: 0.0, ..good }),
            ("speed_m_s", Start { speed_m_s: f64::NAN, ..good }),
        ];
        for (name, start) in wrong {
            let text = start.validate().unwrap_err().to_string();
            assert!(text.starts_with(name) && !text.contains('\n'), "{text}");
        }
    }

    #[test]
    fn a_level_vehicle_heading_east_has_a_camera_that_looks_east() {
        let state = VehicleState {
            time_s: 0.0,
            position_ned_m: DVec3::new(1.0, 2.0, -3.0),
            velocity_ned_m_s: DVec3::ZERO,
            world_from_body: crate::camera::world_from_body(0.0, 0.0, std::f64::consts::FRAC_PI_2),
            rate_body_rad_s: DVec3::ZERO,
            air_velocity_body_m_s: DVec3::ZERO,
        };
        let pose = state.camera_pose();
        assert_eq!(pose.position_world, state.position_ned_m);
        for (camera, world) in [(DVec3::Z, DVec3::Y), (DVec3::X, DVec3::NEG_X), (DVec3::Y, DVec3::Z)] {
            assert!((pose.world_from_camera * camera - world).length() <= 1e-15);
        }
    }
}
