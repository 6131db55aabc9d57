//! A flight, frame by frame.

use std::collections::VecDeque;
use std::time::Instant;

use glam::DVec3;

use super::accuracy::Divergences;
use super::clock::{self, STEPS};
use super::config::FlightConfig;
use super::cost::Cost;
use super::fault::FaultKind;
use super::perception::{Perception, SensorInput};
use super::record::Record;
use super::sensor_model::SensorModel;
use super::summary::{Outcome, Summary, Tally};
use crate::backend::Backend;
use crate::camera::{Camera, FRD_FROM_CAMERA};
use crate::error::Result;
use crate::frame::Image;
use crate::pipeline::Cue;
use crate::sim::vehicle::{
    AirspeedModel, GyroModel, STEP_S, Start, VaneModel, Vehicle, VehicleState, VerticalSpeedModel, Wind,
};
use crate::sim::{Course, Random};
use crate::sphere::{Climb, Heading};
use crate::steer::{Command, Goal, Observation, SteerConfig, Steering};

/// Standard error of a direction of motion from vanes, radians.
const VANES_RAD: f64 = 0.035;

/// A flight through a course.
pub struct Flight {
    course: Course,
    config: FlightConfig,
    vehicle: Box<dyn Vehicle>,
    sensor: SensorModel,
    steering: Steering,
    gyro: GyroModel,
    airspeed: AirspeedModel,
    vanes: Option<VaneModel>,
    vertical_speed: Option<VerticalSpeedModel>,
    frame: u64,
    /// Commands that are decided and do not act yet, the oldest first.
    waiting: VecDeque<Command>,
    tally: Tally,
    cost: Cost,
    states: Vec<VehicleState>,
}

/// A frame of a flight, for whoever watches it.
#[derive(Clone, Copy)]
pub struct FlightFrame<'a> {
    /// The image, if the sensor is a camera.
    pub image: Option<&'a Image>,
    /// The pipeline's cue, if there is one.
    pub cue: Option<&'a Cue<'a>>,
    /// The steering after its decision.
    pub steering: &'a Steering,
    /// The divergence in each cell of the view, where it is [measured](FlightConfig::measure).
    pub divergences: Option<&'a Divergences>,
    /// The frame's record.
    pub record: &'a Record,
}

impl Flight {
    /// A flight from the start of a course. The first backend renders the images, the second one computes the flow.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) for a parameter out of range, also for a fault that begins after the flight
    /// is given up; as [`Renderer::new`](crate::sim::Renderer::new) and [`Pipeline::new`](crate::Pipeline::new).
    pub fn new(backends: [Backend; 2], course: &Course, config: &FlightConfig) -> Result<Self> {
        config.validate()?;
        course.validate()?;
        config.check_faults_in(course)?;
        let random = Random::new(course.seed);
        let start = Start {
            position_ned_m: course.start_ned_m,
            yaw_rad: course.start_yaw_rad,
            speed_m_s: config.speed_m_s,
        };
        let wind = Wind::new(config.wind_ned_m_s, config.gusts, random.fork(1).next_u64())?;
        let steer =
            SteerConfig { params: config.steer, aircraft: config.body.aircraft(config.latency_frames) };
        Ok(Self {
            course: course.clone(),
            vehicle: config.body.vehicle(&start, wind)?,
            sensor: SensorModel::new(backends, &course.world, config, random.fork(2))?,
            steering: Steering::new(steer)?,
            gyro: GyroModel::new(&config.gyro, random.fork(3).next_u64())?,
            airspeed: AirspeedModel::new(config.airspeed_error, random.fork(4).next_u64())?,
            vertical_speed: match &config.vertical_speed {
                Some(errors) => Some(VerticalSpeedModel::new(errors, random.fork(6).next_u64())?),
                None => None,
            },
            vanes: match &config.vanes {
                Some(errors) => Some(VaneModel::new(errors, random.fork(5).next_u64())?),
                None => None,
            },
            frame: 0,
            waiting: std::iter::repeat_n(Command::default(), config.latency_frames as usize).collect(),
            tally: Tally::default(),
            cost: Cost::default(),
            states: Vec::new(),
            config: config.clone(),
        })
    }

    /// The course.
    pub fn course(&self) -> &Course {
        &self.course
    }

    /// The configuration.
    pub fn config(&self) -> &FlightConfig {
        &self.config
    }

    /// The ideal camera, a pinhole, in whose image the flow is computed.
    pub fn ideal(&self) -> &Camera {
        self.sensor.ideal()
    }

    /// The time that each part of the last frame took.
    pub fn cost(&self) -> Cost {
        self.cost
    }

    /// The vehicle's states from the last frame to the next one, both included, [`STEP_S`] apart: what a gyro or a faster
    /// camera on board would have measured. The last one is missing where the flight ended.
    pub fn states(&self) -> &[VehicleState] {
        &self.states
    }

    /// Flies to the end of the flight and calls `show` with each frame.
    ///
    /// # Errors
    /// As [`Flight::step`].
    pub fn fly(&mut self, mut show: impl FnMut(&FlightFrame<'_>) -> Result<()>) -> Result<Summary> {
        loop {
            if let Some(summary) = self.step(&mut show)? {
                return Ok(summary);
            }
        }
    }

    /// Flies one frame further and calls `show` with it. The summary, once the flight has ended.
    ///
    /// # Errors
    /// Those of the renderer, the pipeline and `show`, except for configured faults, with which a flight goes on.
    pub fn step(&mut self, mut show: impl FnMut(&FlightFrame<'_>) -> Result<()>) -> Result<Option<Summary>> {
        let state = self.state(0);
        self.states.clear();
        self.states.push(state);
        self.push_gyro(&state);
        let motion_body = self.vanes.as_mut().map(|vanes| vanes.direction_body(&state));
        let airspeed_m_s = self.airspeed.speed_m_s(&state);
        let climb = self.vertical_speed.as_mut().map(|model| Climb {
            up: state.camera_pose().world_from_camera.transpose() * DVec3::NEG_Z,
            angle_rad: (model.up_m_s(&state) / airspeed_m_s.max(0.1)).clamp(-1.0, 1.0).asin(),
        });
        let Self { course, config, sensor, steering, .. } = self;
        let input = SensorInput {
            world: &course.world,
            pose: state.camera_pose(),
            velocity_world_m_s: state.velocity_ned_m_s,
            heading: motion_body.map(|motion| Heading {
                direction: FRD_FROM_CAMERA.transpose() * motion,
                error_rad: VANES_RAD,
            }),
            climb,
            frame: self.frame,
            time_s: state.time_s,
        };
        let mut cost = Cost::default();
        let perception = sensor.sense(&input, config, &mut cost)?;
        let begun = Instant::now();
        let observation = Observation {
            time_s: state.time_s,
            ned_from_body: state.world_from_body,
            airspeed_m_s,
            motion_body,
            goal: Goal {
                yaw_rad: course.goal_yaw_rad,
                too_low_m: Some(state.position_ned_m.z - course.start_ned_m.z),
            },
            view: perception.view,
        };
        let decision = steering.update(&observation);
        cost.steer = begun.elapsed();
        self.waiting.push_back(decision.command);
        let acting = self.waiting.pop_front().unwrap_or(decision.command);
        let record = Record::of(course, &input, &state, &perception, decision, acting);
        let Perception { image, divergences, ref cue, .. } = perception;
        show(&FlightFrame { image, cue: cue.as_ref(), steering, divergences, record: &record })?;
        let begun = Instant::now();
        self.tally.add(&record);
        let outcome = self.advance(&acting, &record);
        cost.vehicle = begun.elapsed();
        self.cost = cost;
        self.frame += 1;
        Ok(outcome.map(|outcome| {
            let outcome = if self.tally.has_touched() { Outcome::Crashed } else { outcome };
            self.tally.summary(outcome, &record, &self.course, self.config.radius_m)
        }))
    }

    /// Moves the vehicle to the next frame.
    fn advance(&mut self, acting: &Command, record: &Record) -> Option<Outcome> {
        if record.progress_m >= self.course.length_m {
            return Some(Outcome::Reached);
        }
        if record.time_s > self.config.longest_s(&self.course) {
            return Some(Outcome::TimedOut);
        }
        for step in 1..=STEPS {
            self.vehicle.advance(acting, STEP_S);
            let state = self.state(step);
            let clearance_m = self.course.world.clearance_m(state.position_ned_m);
            let touches = self.tally.step(state.velocity_ned_m_s, clearance_m, self.config.radius_m, STEP_S);
            if touches && !self.config.fly_on {
                return Some(Outcome::Crashed);
            }
            let [low_m, high_m] = self.course.altitude_m;
            if !(low_m..=high_m).contains(&-state.position_ned_m.z) {
                return Some(Outcome::LeftBand);
            }
            self.states.push(state);
            // That of the last step is the next frame's own.
            if step < STEPS {
                self.push_gyro(&state);
            }
        }
        None
    }

    /// The vehicle's state after so many steps of a frame.
    fn state(&self, step: u32) -> VehicleState {
        VehicleState { time_s: clock::time_s(self.frame, step), ..self.vehicle.state() }
    }

    fn push_gyro(&mut self, state: &VehicleState) {
        let mut sample = self.gyro.sample(state);
        for fault in self.config.faults.iter().filter(|fault| fault.acts(state.time_s)) {
            match fault.kind {
                FaultKind::GyroLost => return,
                FaultKind::GyroBias(bias_rad_s) => sample.gyro_rad_s += bias_rad_s,
                _ => (),
            }
        }
        self.sensor.push_gyro(sample);
    }
}
