//! The configuration of a pipeline.

use crate::camera::{Camera, Framing, Lens};
use crate::error::{Error, Result};
use crate::flow::Algorithm;
use crate::frame::{PixelFormat, Plane};
use crate::imu::GyroConfig;
use crate::sphere::{Alarm, ExtraOutputs, Sphere};
use crate::stream::StreamConfig;

/// How a [`Pipeline`](super::Pipeline) works.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct PipelineConfig {
    /// The estimator of the flow and its parameters.
    pub algorithm: Algorithm,
    /// How the frames' pixels are stored.
    pub format: PixelFormat,
    /// Whether what the frame does not show, and what the mask hides, is left out of the estimator's neighbourhoods too,
    /// at about twice the time.
    pub certainty: bool,
    /// Whether the flow is brought to the host.
    pub read_flow: bool,
    /// How the stream of frames is run. A frame that follows a dropped one has an invalid cue.
    pub stream: StreamConfig,
    /// How the flow on the view sphere is summed up.
    pub sphere: Sphere,
    /// The pinhole whose pictures the flow is computed of, of any size. None for what the camera's own frame shows
    /// without a gap, in its size.
    pub ideal: Option<Camera>,
    /// How far each pixel of the raw frame is to be trusted, 0 to 1: 0 where the aircraft itself is seen. None for 1.
    pub mask: Option<Plane>,
    /// The gyro. None if there is none: then the camera's turn stays in the flow.
    pub gyro: Option<GyroConfig>,
    /// What is read beside the sectors.
    pub fields: ExtraOutputs,
    /// What is a threat.
    pub alarm: Alarm,
    /// Frames further apart make no pair, in seconds, above 0.
    pub max_interval_s: f64,
    /// A cue is invalid if its flow shows a turn faster than this beside what the gyro tells, in rad/s, above 0. Infinite
    /// to look at none.
    pub max_remaining_rad_s: f64,
    /// A cue is invalid if less of the view is trusted, 0 to 1.
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

    /// Whether a turn that the flow shows beside the gyro's is looked for.
    pub(super) fn watches_turn(&self) -> bool {
        self.gyro.is_some() && self.max_remaining_rad_s.is_finite()
    }

    /// The pinhole whose pictures the flow is computed of.
    pub(crate) fn ideal(&self, camera: &Camera) -> Result<Camera> {
        match &self.ideal {
            None if camera.lens == Lens::NONE => Ok(*camera),
            None => camera.ideal(camera.size, Framing::CropToValid),
            Some(ideal) if ideal.lens == Lens::NONE => Ok(*ideal),
            Some(_) => Err(Error::parameter("ideal", "a camera with a lens", "one without")),
        }
    }
}
