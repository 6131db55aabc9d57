//! The sensor that renders images and processes them with a pipeline.

use std::time::Instant;

use super::config::FlightConfig;
use super::cost::Cost;
use super::fault::{Fault, FaultKind};
use super::measure::Measure;
use super::perception::{Perception, SensorInput};
use crate::backend::Backend;
use crate::camera::{Camera, Pose};
use crate::error::{Error, Result};
use crate::frame::{Image, PixelFormat};
use crate::imu::GyroSample;
use crate::pipeline::Pipeline;
use crate::sim::Renderer;
use crate::sim::{Random, World};
use crate::steer::View;

/// Renders images and processes them with a pipeline.
pub(super) struct CameraSensor {
    renderer: Renderer,
    pipeline: Pipeline,
    image: Image,
    random: Random,
    seed: u64,
    /// How many times the device has been destroyed.
    losses: usize,
    measure: Option<Measure>,
}

impl CameraSensor {
    pub(super) fn new(
        [renderer, flow]: [Backend; 2],
        world: &World,
        config: &FlightConfig,
        mut random: Random,
    ) -> Result<Self> {
        let renderer = Renderer::new(renderer, &config.camera, world, &config.renderer)?;
        let mut pipeline = config.pipeline.clone();
        // What the comparison with the true flow reads.
        pipeline.fields.looming |= config.measure;
        pipeline.fields.cells |= config.measure;
        let pipeline = Pipeline::new(flow, &config.camera, &pipeline)?;
        let size = config.camera.size;
        let image = Image { size, format: PixelFormat::Gray8, data: vec![0; size.pixels()] };
        let seed = random.next_u64();
        let view = &config.pipeline.sphere;
        let measure = config.measure.then(|| Measure::new(pipeline.ideal(), pipeline.cells().size, view));
        let measure = measure.transpose()?;
        Ok(Self { renderer, pipeline, image, random, seed, losses: 0, measure })
    }

    pub(super) fn push_gyro(&mut self, sample: GyroSample) {
        self.pipeline.push_gyro(sample);
    }

    /// The ideal pinhole camera, in whose images the flow is computed.
    pub(super) fn ideal(&self) -> &Camera {
        self.pipeline.ideal()
    }

    /// Renders and processes a frame. The perception has the image even if the pipeline's cue is invalid.
    pub(super) fn sense(
        &mut self,
        at: &SensorInput<'_>,
        faults: &[Fault],
        cost: &mut Cost,
    ) -> Result<Perception<'_>> {
        let acts = |kind: FaultKind| faults.iter().any(|fault| fault.kind == kind && fault.acts(at.time_s));
        let begun = Instant::now();
        if acts(FaultKind::Black) {
            self.image.data.fill(0);
            self.show(None);
        } else if !acts(FaultKind::Frozen) {
            let seen = self.renderer.render(&at.pose, self.seed.wrapping_add(at.frame))?;
            self.image.data.copy_from_slice(&seen.data);
            self.show(Some(at.pose));
        }
        cost.sensor = begun.elapsed();
        let shares =
            faults.iter().filter(|fault| fault.acts(at.time_s)).filter_map(|fault| match fault.kind {
                FaultKind::Dropped(share) => Some(share),
                _ => None,
            });
        let dropped = shares.fold(0.0, f64::max);
        if dropped > 0.0 && self.random.uniform() < dropped {
            let invalid = Some("the frame was dropped".to_owned());
            return Ok(Perception { image: Some(&self.image), invalid, ..Perception::default() });
        }
        let due = |fault: &&Fault| fault.kind == FaultKind::DeviceLost && fault.from_s <= at.time_s;
        let due = faults.iter().filter(due).count();
        if due > self.losses {
            self.losses = due;
            if let Some(gpu) = self.pipeline.gpu() {
                gpu.device().destroy();
            }
        }
        let time_s = if acts(FaultKind::NotANumber) { f64::NAN } else { at.time_s };
        self.pipeline.set_heading(at.heading);
        self.pipeline.set_climb(at.climb)?;
        let begun = Instant::now();
        let cue = match self.pipeline.process(&self.image.frame()?, time_s) {
            Ok(cue) => Ok(cue),
            // The driver's own message differs from run to run.
            Err(Error::DeviceLost { .. }) => Err("the device was lost"),
            Err(Error::Timeout { .. }) => Err("the frame was not finished in time"),
            Err(error) => return Err(error),
        };
        cost.pipeline = begun.elapsed();
        let measured = match (&mut self.measure, &cue) {
            (Some(measure), Ok(cue)) => measure.compare(cue, at),
            _ => None,
        };
        let divergences = self.measure.as_ref().map(Measure::divergences).filter(|_| measured.is_some());
        Ok(match cue {
            Ok(cue) => Perception {
                image: Some(&self.image),
                measured,
                divergences,
                view: View::of(&cue),
                invalid: cue.invalid.map(|invalid| invalid.to_string()),
                cue: Some(cue),
            },
            Err(lost) => Perception {
                image: Some(&self.image),
                invalid: Some(lost.to_owned()),
                ..Perception::default()
            },
        })
    }

    /// Records the pose at which the shown image was rendered, if the flow is measured.
    fn show(&mut self, pose: Option<Pose>) {
        if let Some(measure) = &mut self.measure {
            measure.show(pose);
        }
    }
}
