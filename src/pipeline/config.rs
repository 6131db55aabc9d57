//! The configuration of a pipeline.

use crate::camera::{Camera, Framing, Lens};
use crate::error::{Error, Result};
use crate::flow::Algorithm;
use crate::frame::{PixelFormat, Plane};
use crate::imu::GyroConfig;
use crate::sphere::{Alarm, ExtraOutputs, Sphere};
use crate::stream::StreamConfig;

/// The configuration of a [`Pipeline`](super::Pipeline).
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct PipelineConfig {
    /// The estimator of the flow and its parameters.
    pub algorithm: Algorithm,
    /// The pixel format of the frames.
    pub format: PixelFormat,
    /// Whether pixels outside the frame and pixels that the mask hides are excluded from the estimator's neighbourhoods
    /// too. It takes about twice the time.
    pub certainty: bool,
    /// Whether the flow is read back to the host.
    pub read_flow: bool,
    /// The configuration of the stream. A frame that follows a dropped one has an invalid cue.
    pub stream: StreamConfig,
    /// How the flow on the view sphere is aggregated.
    pub sphere: Sphere,
    /// The ideal camera: a pinhole without a lens, of any size, in whose image the flow is computed. `None` for the
    /// largest view that the raw frame fills, at its size.
    pub ideal: Option<Camera>,
    /// The certainty of each pixel of the raw frame, 0 to 1, in a plane of the camera's size: 0 where the aircraft
    /// itself is seen. `None` for 1 everywhere.
    pub mask: Option<Plane>,
    /// The gyro. Without one (`None`) the camera's rotation stays in the flow.
    pub gyro: Option<GyroConfig>,
    /// The outputs that are read back beside the sectors.
    pub fields: ExtraOutputs,
    /// The criteria of threats and alarms.
    pub alarm: Alarm,
    /// The longest time between paired frames, in seconds, above 0.
    pub max_interval_s: f64,
    /// The highest residual rotation of a valid cue, in rad/s, above 0: the rotation that the flow shows and the gyro
    /// does not. Infinite for no check.
    pub max_remaining_rad_s: f64,
    /// The least coverage of a valid cue: the share of the view whose flow is trusted, 0 to 1.
    pub least_coverage: f64,
}

impl Default for PipelineConfig {
    fn default() -> Self {
        Self {
            algorithm: Algorithm::default(),
            format: PixelFormat::Gray8,
            certainty: false,
            read_flow: false,
            stream: StreamConfig::default(),
            sphere: Sphere::default(),
            ideal: None,
            mask: None,
            gyro: None,
            fields: ExtraOutputs::default(),
            alarm: Alarm::default(),
            max_interval_s: 0.25,
            max_remaining_rad_s: f64::INFINITY,
            least_coverage: 0.1,
        }
    }
}

impl PipelineConfig {
    /// Checks every parameter's range.
    ///
    /// # Errors
    /// [`Error::Parameter`], naming the first one that is out of range.
    pub fn validate(&self) -> Result<()> {
        self.algorithm.validate()?;
        self.stream.validate()?;
        self.sphere.validate()?;
        self.alarm.validate()?;
        if let Some(gyro) = &self.gyro {
            gyro.validate()?;
        }
        if !(self.max_interval_s > 0.0 && self.max_interval_s.is_finite()) {
            return Err(Error::parameter("max_interval_s", self.max_interval_s, "above 0 and finite"));
        }
        if !(self.max_remaining_rad_s > 0.0) {
            return Err(Error::parameter("max_remaining_rad_s", self.max_remaining_rad_s, "above 0"));
        }
        if !(0.0..=1.0).contains(&self.least_coverage) {
            return Err(Error::parameter("least_coverage", self.least_coverage, "0 to 1"));
        }
        Ok(())
    }

    /// Whether the residual rotation is checked.
    pub(super) fn watches_turn(&self) -> bool {
        self.gyro.is_some() && self.max_remaining_rad_s.is_finite()
    }

    /// The pinhole whose images the flow is computed of.
    pub(crate) fn ideal(&self, camera: &Camera) -> Result<Camera> {
        match &self.ideal {
            None if camera.lens == Lens::NONE => Ok(*camera),
            None => camera.ideal(camera.size, Framing::CropToValid),
            Some(ideal) if ideal.lens == Lens::NONE => Ok(*ideal),
            Some(_) => Err(Error::parameter("ideal", "a camera with a lens", "one without")),
        }
    }
}
