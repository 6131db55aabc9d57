use glam::DVec3;

use super::state::{STEP_S, VehicleState, within};
use super::stream::{Stream, normal};
use crate::error::Result;
use crate::imu::GyroSample;
use crate::sim::Random;

/// The largest bias about an axis, rad/s: the full scale of a 2000 °/s gyro, the widest among small ones.
pub const MAX_BIAS_RAD_S: f64 = 35.0;

/// The errors of a gyro.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct GyroErrors {
    /// Density of each axis' white noise, rad/s/√Hz, 0 to 1. The angle over a time T has an error of √T times it.
    pub noise_rad_s_rthz: f64,
    /// Density of the noise that drives each axis' bias random walk, rad/s²/√Hz, 0 to 1.
    pub bias_walk_rad_s2_rthz: f64,
    /// The bias at the start, rad/s FRD, each axis within ±[`MAX_BIAS_RAD_S`].
    pub bias_rad_s: DVec3,
}

impl Default for GyroErrors {
    /// 3.4e-4 rad/s/√Hz and 3.9e-5 rad/s²/√Hz, those of a small MEMS gyro, as used by Agile Autonomy (Loquercio et
    /// al. 2021); no bias at the start.
    fn default() -> Self {
        Self { noise_rad_s_rthz: 3.4e-4, bias_walk_rad_s2_rthz: 3.9e-5, bias_rad_s: DVec3::ZERO }
    }
}

impl GyroErrors {
    /// A gyro without errors.
    pub const NONE: Self =
        Self { noise_rad_s_rthz: 0.0, bias_walk_rad_s2_rthz: 0.0, bias_rad_s: DVec3::ZERO };

    /// White noise whose mean over a frame has the standard deviation `noise_rad_s`, and the same bias about each
    /// axis, rad/s: 0.2 °/s over 1/30 s is a density of 6.4e-4 rad/s/√Hz.
    pub fn over_frames(noise_rad_s: f64, frame_s: f64, bias_rad_s: f64) -> Self {
        Self {
            noise_rad_s_rthz: noise_rad_s * frame_s.sqrt(),
            bias_walk_rad_s2_rthz: 0.0,
            bias_rad_s: DVec3::splat(bias_rad_s),
        }
    }

    /// Checks every field.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) for the first that is out of range.
    pub fn validate(&self) -> Result<()> {
        within("noise_rad_s_rthz", self.noise_rad_s_rthz, 0.0, 1.0)?;
        within("bias_walk_rad_s2_rthz", self.bias_walk_rad_s2_rthz, 0.0, 1.0)?;
        let axes = self.bias_rad_s.to_array();
        axes.into_iter().try_for_each(|axis| within("bias_rad_s", axis, -MAX_BIAS_RAD_S, MAX_BIAS_RAD_S))
    }
}

/// An on-board gyro, along the body's axes: FRD, so that
/// [`GyroConfig::camera_from_gyro`](crate::imu::GyroConfig::camera_from_gyro) is
/// [`FRD_FROM_CAMERA`](crate::camera::FRD_FROM_CAMERA) transposed. It has unlimited bandwidth and no delay.
#[derive(Clone, Debug)]
pub struct GyroModel {
    errors: GyroErrors,
    bias_rad_s: DVec3,
    last: Option<GyroSample>,
    random: Random,
}

impl GyroModel {
    /// A gyro without samples. The same seed gives the same errors.
    ///
    /// # Errors
    /// As in [`GyroErrors::validate`].
    pub fn new(errors: &GyroErrors, seed: u64) -> Result<Self> {
        errors.validate()?;
        Ok(Self { errors: *errors, bias_rad_s: errors.bias_rad_s, last: None, random: Stream::Gyro.of(seed) })
    }

    /// The next sample, to be taken at every step. A state with the previous one's time gives the same sample again.
    pub fn sample(&mut self, state: &VehicleState) -> GyroSample {
        // The first sample represents a step of the usual length.
        let mut interval_s = STEP_S;
        if let Some(last) = self.last {
            interval_s = state.time_s - last.time_s;
            if !(interval_s > 0.0) {
                return last;
            }
            let walk = self.errors.bias_walk_rad_s2_rthz * interval_s.sqrt();
            self.bias_rad_s += walk * normal(&mut self.random);
        }
        let noise = self.errors.noise_rad_s_rthz / interval_s.sqrt() * normal(&mut self.random);
        let sample =
            GyroSample { time_s: state.time_s, gyro_rad_s: state.rate_body_rad_s + self.bias_rad_s + noise };
        self.last = Some(sample);
        sample
    }
}
