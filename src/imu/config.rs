use glam::{DMat3, DVec3};

use crate::camera::is_rotation;
use crate::error::{Error, Result};

/// What a gyro measured at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GyroSample {
    /// The time, in seconds of the gyro's clock.
    ///
    /// Seconds since 1970 have a resolution of 0.2 µs in `f64`, far finer than derotation needs.
    pub time_s: f64,
    /// Angular rate of the sensor relative to the world, in the sensor's own frame, rad/s, by the right-hand rule.
    pub gyro_rad_s: DVec3,
}

/// The calibration of a gyro relative to the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct GyroConfig {
    /// The gyro's reading at rest, in its own frame, rad/s. It is subtracted from every sample.
    pub bias_rad_s: DVec3,
    /// Added to the samples' times to give the camera's time, seconds. A frame's time is that of the middle of its
    /// exposure.
    pub time_offset_s: f64,
    /// The rotation from the gyro's frame to the camera's (x right, y down, z forward).
    pub camera_from_gyro: DMat3,
    /// The longest allowed time between two samples, seconds. A longer one is a gap.
    pub max_gap_s: f64,
    /// The number of samples kept. The oldest is dropped when there are more.
    pub history: usize,
}

impl Default for GyroConfig {
    /// No bias, no offset, the gyro's axes along the camera's, a gap above 0.05 s, 4096 samples (4 s at 1 kHz).
    fn default() -> Self {
        Self {
            bias_rad_s: DVec3::ZERO,
            time_offset_s: 0.0,
            camera_from_gyro: DMat3::IDENTITY,
            max_gap_s: 0.05,
            history: 4096,
        }
    }
}

impl GyroConfig {
    /// Checks every field.
    ///
    /// # Errors
    /// [`Error::Parameter`] for the first that is out of range.
    pub fn validate(&self) -> Result<()> {
        if !self.bias_rad_s.is_finite() {
            return Err(Error::parameter("bias_rad_s", self.bias_rad_s, "three finite rates"));
        }
        if !self.time_offset_s.is_finite() {
            return Err(Error::parameter("time_offset_s", self.time_offset_s, "a finite time"));
        }
        if !(self.max_gap_s > 0.0 && self.max_gap_s.is_finite()) {
            return Err(Error::parameter("max_gap_s", self.max_gap_s, "above 0 and finite"));
        }
        if !(2..=1 << 24).contains(&self.history) {
            return Err(Error::parameter("history", self.history, "2 to 16777216"));
        }
        if !is_rotation(&self.camera_from_gyro) {
            let found = self.camera_from_gyro;
            return Err(Error::parameter("camera_from_gyro", found, "a rotation, of determinant 1"));
        }
        Ok(())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn the_default_is_legal_and_each_field_is_checked() {
        let good = GyroConfig::default();
        good.validate().unwrap();
        let mirror = DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0));
        let wrong = [
            ("bias_rad_s", GyroConfig { bias_rad_s: DVec3::NAN, ..good }),
            ("time_offset_s", GyroConfig { time_offset_s: f64::INFINITY, ..good }),
            ("max_gap_s", GyroConfig { max_gap_s: 0.0, ..good }),
            ("max_gap_s", GyroConfig { max_gap_s: f64::NAN, ..good }),
            ("history", GyroConfig { history: 1, ..good }),
            ("camera_from_gyro", GyroConfig { camera_from_gyro: mirror, ..good }),
            ("camera_from_gyro", GyroConfig { camera_from_gyro: DMat3::NAN, ..good }),
            ("camera_from_gyro", GyroConfig { camera_from_gyro: DMat3::IDENTITY * 1.01, ..good }),
        ];
        for (name, config) in wrong {
            let text = config.validate().unwrap_err().to_string();
            assert!(text.starts_with(name) && !text.contains('\n'), "{text}");
        }
    }
}
