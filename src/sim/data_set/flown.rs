//! The flight of a data set.

use super::folder::Folder;
use crate::backend::Backend;
use crate::camera::FRD_FROM_CAMERA;
use crate::error::{Error, Result};
use crate::imu::GyroSample;
use crate::io::write_atomic;
use crate::sim::Course;
use crate::sim::flight::{Flight, FlightConfig, Outcome, Sensor};
use crate::sim::vehicle::{GyroErrors, GyroModel, VehicleState};

/// A completed flight.
pub(super) struct Flown {
    /// The vehicle at each frame.
    pub(super) frames: Vec<VehicleState>,
    /// The vehicle at each step, from the first frame to the last.
    steps: Vec<VehicleState>,
    /// How it ended, if it did so before its time was over.
    pub(super) ended: Option<Outcome>,
}

impl Flown {
    /// Flies a course by true depth, until there are `most` frames, `apart` steps apart, or the flight ends.
    pub(super) fn new(course: &Course, speed_m_s: f64, apart: usize, most: usize) -> Result<Self> {
        let config = FlightConfig { speed_m_s, sensor: Sensor::Depth, ..FlightConfig::default() };
        let mut flight = Flight::new([Backend::Cpu, Backend::Cpu], course, &config)?;
        let needed = (most - 1) * apart + 1;
        let (mut steps, mut ended) = (Vec::new(), None);
        while steps.len() < needed && ended.is_none() {
            ended = flight.step(|_| Ok(()))?.map(|summary| summary.outcome);
            // The first state of a frame is the last one of the previous frame.
            steps.extend(flight.states().iter().skip(usize::from(!steps.is_empty())));
        }
        if steps.len() >= needed {
            steps.truncate(needed);
            ended = None;
        }
        let frames: Vec<VehicleState> = steps.iter().step_by(apart).copied().collect();
        steps.truncate(frames.len().saturating_sub(1) * apart + 1);
        Ok(Self { frames, steps, ended })
    }

    /// The gyro's samples from the first frame to the last, one per step.
    pub(super) fn gyro(&self, errors: &GyroErrors, seed: u64) -> Result<Vec<GyroSample>> {
        let mut gyro = GyroModel::new(errors, seed)?;
        Ok(self.steps.iter().map(|state| gyro.sample(state)).collect())
    }

    /// The length of the path from the first frame to the last, metres.
    pub(super) fn path_m(&self) -> f64 {
        let way = |pair: &[VehicleState]| pair[0].position_ned_m.distance(pair[1].position_ned_m);
        // The sum of no values is −0.
        self.steps.windows(2).map(way).sum::<f64>() + 0.0
    }

    /// The least clearance along the path, metres.
    pub(super) fn least_clearance_m(&self, course: &Course) -> f64 {
        let clearances = self.steps.iter().map(|state| course.world.clearance_m(state.position_ned_m));
        clearances.fold(f64::INFINITY, f64::min)
    }

    /// Writes times.csv and poses.csv.
    pub(super) fn write_tables(&self, folder: &Folder) -> Result<()> {
        let times = self.frames.iter().map(|state| format!("{}", state.time_s));
        table(folder, "times.csv", "time_s", times)?;
        let pose = |state: &VehicleState| {
            let turn = glam::DQuat::from_mat3(&state.world_from_body);
            let (p, v) = (state.position_ned_m, state.velocity_ned_m_s);
            let values = [state.time_s, p.x, p.y, p.z, turn.w, turn.x, turn.y, turn.z, v.x, v.y, v.z];
            values.map(|value| value.to_string()).join(",")
        };
        let header = "time_s,north_m,east_m,down_m,q_w,q_x,q_y,q_z,v_north_m_s,v_east_m_s,v_down_m_s";
        table(folder, "poses.csv", header, self.frames.iter().map(pose))
    }
}

/// How a flight ended, as text.
pub(super) fn ended(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Reached => "the goal was reached",
        Outcome::Crashed => "it would have crashed",
        Outcome::LeftBand => "it left its altitude band",
        Outcome::TimedOut => "it timed out",
    }
}

/// The camera's motion, in its own frame.
pub(super) fn motion(state: &VehicleState) -> crate::sim::Twist {
    crate::sim::Twist {
        velocity_m_s: state.camera_pose().world_from_camera.transpose() * state.velocity_ned_m_s,
        rate_rad_s: FRD_FROM_CAMERA.transpose() * state.rate_body_rad_s,
    }
}

fn table(folder: &Folder, name: &str, header: &str, rows: impl Iterator<Item = String>) -> Result<()> {
    let path = folder.path(name);
    write_atomic(&path, |out| {
        std::iter::once(header.to_owned())
            .chain(rows)
            .try_for_each(|row| writeln!(out, "{row}"))
            .map_err(|source| Error::io(&path, source))
    })
}
