//! The aircraft as steering sees it.

use glam::DMat3;

use crate::camera::{FRD_FROM_CAMERA, is_rotation};
use crate::error::{Error, Result, in_ranges};

/// The aircraft as steering sees it.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Aircraft {
    /// The camera's mounting: the rotation from the camera's frame to the body's.
    pub body_from_camera: DMat3,
    /// Time from a frame's exposure until its command takes effect, 0 to 1.
    pub latency_s: f64,
    /// The response to commands.
    pub response: Response,
}

/// The response of an aircraft to commands.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Response {
    /// Time constant of the bank, above 0.
    pub bank_time_s: f64,
    /// Largest rate of roll, rad/s, above 0.
    pub bank_rate_rad_s: f64,
    /// Time constant of the climb, above 0.
    pub climb_time_s: f64,
    /// Time from when a command takes effect until the aircraft begins to follow, 0 to 1: the delay of actuators and
    /// inner loop.
    pub lag_s: f64,
}

impl Default for Aircraft {
    /// A camera along the body's x axis, 0.05 s of latency, and the default [`Response`].
    fn default() -> Self {
        Self { body_from_camera: FRD_FROM_CAMERA, latency_s: 0.05, response: Response::default() }
    }
}

impl Default for Response {
    /// The response of the simulator's airframe of 1.2 kg, fitted to its step responses.
    fn default() -> Self {
        Self { bank_time_s: 0.12, bank_rate_rad_s: 115_f64.to_radians(), climb_time_s: 0.4, lag_s: 0.09 }
    }
}

impl Aircraft {
    /// From a frame's exposure until the aircraft begins to follow its command, seconds.
    pub(super) fn delay_s(&self) -> f64 {
        self.latency_s + self.response.lag_s
    }

    /// Checks every field.
    ///
    /// # Errors
    /// [`Error::Parameter`], naming the first one that is out of range.
    pub fn validate(&self) -> Result<()> {
        in_ranges(&[("latency_s", self.latency_s, 0.0, 1.0)])?;
        self.response.validate()?;
        if !is_rotation(&self.body_from_camera) {
            let found = self.body_from_camera;
            return Err(Error::parameter("body_from_camera", found, "a rotation, of determinant 1"));
        }
        Ok(())
    }
}

impl Response {
    /// Checks every field.
    ///
    /// # Errors
    /// [`Error::Parameter`], naming the first one that is out of range.
    pub fn validate(&self) -> Result<()> {
        in_ranges(&[
            ("bank_time_s", self.bank_time_s, 1e-3, 10.0),
            ("bank_rate_rad_s", self.bank_rate_rad_s, 1e-3, 100.0),
            ("climb_time_s", self.climb_time_s, 1e-3, 10.0),
            ("lag_s", self.lag_s, 0.0, 1.0),
        ])
    }
}
