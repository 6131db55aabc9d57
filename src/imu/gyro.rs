use glam::{DMat3, DQuat, DVec3};

use super::history::History;
use super::{GyroConfig, GyroFault, GyroSample};
use crate::error::Result;

/// A gyro's recent samples, and the rotations integrated from them.
///
/// Samples that are not finite, and those whose time runs backwards, invalidate the intervals that they touch and no
/// others: [`Gyro::prev_from_cur`] reports the fault for those. After the gyro's clock is set back, samples count
/// from the second one on, and older samples of the same times are dropped. A repeated sample counts once.
#[derive(Clone, Debug)]
pub struct Gyro {
    config: GyroConfig,
    camera_from_gyro: DQuat,
    history: History,
}

impl Gyro {
    /// A gyro without samples. The memory for its history is allocated here, and never grows.
    ///
    /// # Errors
    /// As in [`GyroConfig::validate`].
    pub fn new(config: GyroConfig) -> Result<Self> {
        config.validate()?;
        let camera_from_gyro = DQuat::from_mat3(&config.camera_from_gyro).normalize();
        Ok(Self { config, camera_from_gyro, history: History::new(config.history, config.max_gap_s) })
    }

    /// The calibration.
    pub fn config(&self) -> &GyroConfig {
        &self.config
    }

    /// Adds the next sample, in the order of time.
    pub fn push(&mut self, sample: GyroSample) {
        let time_s = sample.time_s + self.config.time_offset_s;
        self.history.push(time_s, sample.gyro_rad_s - self.config.bias_rad_s);
    }

    /// The rotation from the camera's frame at `cur_time_s` to that at `prev_time_s`.
    ///
    /// The rates between two samples are interpolated linearly, and by Magnus' expansion the rotation by such rates
    /// is exact to the fourth order of the samples' distance. The remaining error is that of the interpolation, of
    /// the second order: h² Δt/12 of the rates' second derivative. Half the distance has a quarter of the error.
    ///
    /// # Errors
    /// [`GyroFault`] if sound samples do not cover the whole interval.
    pub fn prev_from_cur(&self, prev_time_s: f64, cur_time_s: f64) -> Result<DMat3, GyroFault> {
        let mut turn = DQuat::IDENTITY;
        self.walk(prev_time_s, cur_time_s, |h, a, b| {
            // The second term: rotations about changing axes do not commute.
            turn *= DQuat::from_scaled_axis((a + b) * (h / 2.0) + a.cross(b) * (h * h / 12.0));
        })?;
        let turn = self.camera_from_gyro * turn.normalize() * self.camera_from_gyro.conjugate();
        // Finite rates of absurd magnitude can still overflow.
        let rotation = DMat3::from_quat(turn);
        if rotation.is_finite() { Ok(rotation) } else { Err(GyroFault::NotANumber { time_s: prev_time_s }) }
    }

    /// The mean angular rate in the camera's frame over an interval, rad/s.
    ///
    /// # Errors
    /// As in [`Gyro::prev_from_cur`]; an empty interval has no mean.
    pub fn mean_rate_rad_s(&self, prev_time_s: f64, cur_time_s: f64) -> Result<DVec3, GyroFault> {
        if !(prev_time_s < cur_time_s) {
            return Err(GyroFault::Frames { prev_time_s, cur_time_s });
        }
        let mut sum = DVec3::ZERO;
        self.walk(prev_time_s, cur_time_s, |h, a, b| sum += (a + b) * (h / 2.0))?;
        let mean = self.camera_from_gyro * (sum / (cur_time_s - prev_time_s));
        if mean.is_finite() { Ok(mean) } else { Err(GyroFault::NotANumber { time_s: prev_time_s }) }
    }

    /// Visits the pieces of an interval in which the rates are linear: the length, and the rates at both ends.
    fn walk(
        &self,
        prev_time_s: f64,
        cur_time_s: f64,
        mut piece: impl FnMut(f64, DVec3, DVec3),
    ) -> Result<(), GyroFault> {
        if !(prev_time_s <= cur_time_s) {
            return Err(GyroFault::Frames { prev_time_s, cur_time_s });
        }
        for [a, b] in self.history.pairs(prev_time_s, cur_time_s)? {
            let (from_s, to_s) = (a.time_s.max(prev_time_s), b.time_s.min(cur_time_s));
            let rate =
                |time_s: f64| a.rate_rad_s.lerp(b.rate_rad_s, (time_s - a.time_s) / (b.time_s - a.time_s));
            piece(to_s - from_s, rate(from_s), rate(to_s));
        }
        Ok(())
    }
}
