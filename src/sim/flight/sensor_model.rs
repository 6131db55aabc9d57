//! The sensor that a flight steers by.

use std::time::Instant;

use super::camera_sensor::CameraSensor;
use super::config::FlightConfig;
use super::cost::Cost;
use super::perception::{Perception, SensorInput};
use super::sensor::Sensor;
use super::true_sensor::TrueSensor;
use crate::backend::Backend;
use crate::camera::Camera;
use crate::error::Result;
use crate::imu::{Gyro, GyroSample};
use crate::pipeline::Invalid;
use crate::sim::{Random, World};

/// The sensor that a flight steers by.
pub(super) enum SensorModel {
    /// The world itself, the gyro, and the time of the previous frame.
    True(Box<TrueSensor>, Box<Gyro>, Option<f64>),
    /// A camera and a pipeline.
    Camera(Box<CameraSensor>),
}

impl SensorModel {
    pub(super) fn new(
        backends: [Backend; 2],
        world: &World,
        config: &FlightConfig,
        random: Random,
    ) -> Result<Self> {
        if config.sensor == Sensor::Images {
            return Ok(Self::Camera(Box::new(CameraSensor::new(backends, world, config, random)?)));
        }
        let ideal = config.pipeline.ideal(&config.camera)?;
        let view = &config.pipeline.sphere;
        let sensor = TrueSensor::new(&ideal, view, config.sensor, config.flow_noise, random)?;
        Ok(Self::True(Box::new(sensor), Box::new(Gyro::new(config.required_gyro()?)?), None))
    }

    /// The ideal camera, a pinhole, whose view is observed.
    pub(super) fn ideal(&self) -> &Camera {
        match self {
            Self::Camera(sensor) => sensor.ideal(),
            Self::True(sensor, ..) => sensor.ideal(),
        }
    }

    pub(super) fn push_gyro(&mut self, sample: GyroSample) {
        match self {
            Self::True(_, gyro, _) => gyro.push(sample),
            Self::Camera(sensor) => sensor.push_gyro(sample),
        }
    }

    /// Observes the world.
    pub(super) fn sense(
        &mut self,
        at: &SensorInput<'_>,
        config: &FlightConfig,
        cost: &mut Cost,
    ) -> Result<Perception<'_>> {
        match self {
            Self::Camera(sensor) => sensor.sense(at, &config.faults, cost),
            Self::True(sensor, gyro, before_s) => {
                let begun = Instant::now();
                let before_s = before_s.replace(at.time_s);
                let turn = before_s.map(|before_s| (gyro.prev_from_cur(before_s, at.time_s), before_s));
                let perception = match turn {
                    Some((Ok(turn), before_s)) => match sensor.sense(at, &turn, at.time_s - before_s) {
                        Some(view) => Perception { view: Some(view), ..Perception::default() },
                        None => Perception::invalid(&Invalid::First),
                    },
                    Some((Err(fault), _)) => Perception::invalid(&Invalid::Gyro(fault)),
                    None => {
                        sensor.begin(at.pose);
                        Perception::invalid(&Invalid::First)
                    }
                };
                cost.sensor = begun.elapsed();
                Ok(perception)
            }
        }
    }
}

impl Perception<'_> {
    fn invalid(why: &Invalid) -> Self {
        Self { invalid: Some(why.to_string()), ..Self::default() }
    }
}
