//! Whatever the flight sees by.

use std::time::Instant;

use glam::DVec3;

use super::camera_eye::CameraEye;
use super::config::{FlightConfig, Sensor};
use super::measure::{Divergences, Measured};
use super::record::Cost;
use super::true_eye::TrueEye;
use crate::backend::Backend;
use crate::camera::{Camera, FRD_FROM_CAMERA, Pose};
use crate::error::Result;
use crate::frame::Image;
use crate::imu::{Gyro, GyroConfig, GyroSample};
use crate::pipeline::{Cue, Invalid};
use crate::sim::{Random, World};
use crate::sphere::Heading;
use crate::steer::View;

/// Whatever the flight sees by.
pub(super) enum Eye {
    /// The world itself, what the gyro tells, and the time of the frame before.
    True(Box<TrueEye>, Box<Gyro>, Option<f64>),
    /// A camera and a pipeline.
    Camera(Box<CameraEye>),
}

/// A moment at which it looks.
pub(super) struct Moment<'a> {
    pub(super) world: &'a World,
    pub(super) pose: Pose,
    pub(super) velocity_world_m_s: DVec3,
    /// Which way the camera moves, in its own frame, where vanes tell.
    pub(super) heading: Option<Heading>,
    pub(super) frame: u64,
    pub(super) time_s: f64,
}

/// What it says.
#[derive(Default)]
pub(super) struct Said<'a> {
    pub(super) image: Option<&'a Image>,
    pub(super) cue: Option<Cue<'a>>,
    pub(super) view: Option<View<'a>>,
    /// Why there is no view.
    pub(super) invalid: Option<String>,
    /// How far it is from the truth, where that is asked for.
    pub(super) measured: Option<Measured>,
    pub(super) divergences: Option<&'a Divergences>,
}

impl Eye {
    pub(super) fn new(
        backends: [Backend; 2],
        world: &World,
        config: &FlightConfig,
        random: Random,
    ) -> Result<Self> {
        if config.sensor == Sensor::Images {
            return Ok(Self::Camera(Box::new(CameraEye::new(backends, world, config, random)?)));
        }
        let ideal = config.pipeline.ideal(&config.camera)?;
        let view = &config.pipeline.sphere;
        let eye = TrueEye::new(&ideal, view, config.sensor, config.flow_noise, random)?;
        Ok(Self::True(Box::new(eye), Box::new(Gyro::new(gyro_config())?), None))
    }

    /// The pinhole in whose pictures it looks.
    pub(super) fn ideal(&self) -> &Camera {
        match self {
            Self::Camera(eye) => eye.ideal(),
            Self::True(eye, ..) => eye.ideal(),
        }
    }

    pub(super) fn push_gyro(&mut self, sample: GyroSample) {
        match self {
            Self::True(_, gyro, _) => gyro.push(sample),
            Self::Camera(eye) => eye.push_gyro(sample),
        }
    }

    /// Looks at the world.
    pub(super) fn look(
        &mut self,
        at: &Moment<'_>,
        config: &FlightConfig,
        cost: &mut Cost,
    ) -> Result<Said<'_>> {
        match self {
            Self::Camera(eye) => eye.look(at, &config.faults, cost),
            Self::True(eye, gyro, before_s) => {
                let begun = Instant::now();
                let before_s = before_s.replace(at.time_s);
                let turn = before_s.map(|before_s| (gyro.prev_from_cur(before_s, at.time_s), before_s));
                let said = match turn {
                    Some((Ok(turn), before_s)) => match eye.look(at, &turn, at.time_s - before_s) {
                        Some(view) => Said { view: Some(view), ..Said::default() },
                        None => Said::invalid(&Invalid::First),
                    },
                    Some((Err(fault), _)) => Said::invalid(&Invalid::Gyro(fault)),
                    None => {
                        eye.begin(at.pose);
                        Said::invalid(&Invalid::First)
                    }
                };
                cost.sight = begun.elapsed();
                Ok(said)
            }
        }
    }
}

impl Said<'_> {
    fn invalid(why: &Invalid) -> Self {
        Self { invalid: Some(why.to_string()), ..Self::default() }
    }
}

/// How the gyro's samples, in the body's frame, belong to a camera that looks along the body's x axis.
pub(super) fn gyro_config() -> GyroConfig {
    GyroConfig { camera_from_gyro: FRD_FROM_CAMERA.transpose(), ..GyroConfig::default() }
}
