//! The log of a flight as JSON lines: its settings, each frame, and how it ended. The same flight has the same log.

use serde::Serialize;

use super::measured::MeasuredFigures;
use super::setup::SetupArgs;
use crate::cli::print;
use crate::error::Result;
use crate::journal::fingerprint;
use crate::sim::Course;
use crate::sim::campaign::Faults;
use crate::sim::course::file;
use crate::sim::flight::{FRAME_S, Flight, Record, Summary};
use crate::sphere::ExtraOutputs;
use crate::steer::{Command, Source};

/// The settings of the flight: everything needed to repeat it.
#[derive(Serialize)]
struct Header<'a> {
    viewsphere: &'static str,
    /// The fingerprint of the whole configuration and the course.
    fingerprint: String,
    /// The backends that render the images and compute the flow; `null` for a sensor without images.
    backends: Option<&'a [String; 2]>,
    world: &'a str,
    seed: u64,
    policy: &'static str,
    danger: &'static str,
    sensor: &'static str,
    speed_m_s: f64,
    size: String,
    latency_frames: u32,
    body: String,
    wind_ned_m_s: [f64; 3],
    gusts: String,
    vanes: bool,
    vertical_speed: bool,
    faults: String,
    frame_s: f64,
    radius_m: f64,
    start_ned_m: [f64; 3],
    start_yaw_rad: f64,
    goal_yaw_rad: f64,
    length_m: f64,
    altitude_m: [f64; 2],
}

/// A frame. Unknown values are `null`.
#[derive(Serialize)]
struct FrameLine<'a> {
    frame: u64,
    time_s: f64,
    position_ned_m: [f64; 3],
    velocity_ned_m_s: [f64; 3],
    roll_pitch_yaw_rad: [f64; 3],
    rate_body_rad_s: [f64; 3],
    airspeed_m_s: f64,
    clearance_m: f64,
    progress_m: f64,
    offset_m: Option<f64>,
    invalid: Option<&'a str>,
    coverage: f64,
    heading_error_rad: Option<f64>,
    contact_s: Option<f64>,
    true_contact_s: Option<f64>,
    measured: Option<MeasuredFigures>,
    source: &'static str,
    command: Angles,
    danger: Option<f64>,
    acting: Angles,
}

#[derive(Serialize)]
struct Angles {
    bank_rad: f64,
    climb_rad: f64,
}

/// How the flight ended.
#[derive(Debug, Serialize)]
pub(super) struct End {
    outcome: &'static str,
    time_s: f64,
    progress_m: f64,
    path_m: f64,
    efficiency: f64,
    touches: u32,
    shortest_m: Option<f64>,
    progress: f64,
    optimality: Option<f64>,
    goal_speed_m_s: Option<f64>,
    energy_hz2: Option<f64>,
    least_clearance_m: f64,
    low_clearance_m: f64,
    roll_rate_rad_s: f64,
    invalid: f64,
    offset_std_m: Option<f64>,
    offset_mean_m: Option<f64>,
    measured: Option<MeasuredFigures>,
}

/// The first line of a log.
pub(super) fn header(flight: &Flight, setup: &SetupArgs, backends: Option<&[String; 2]>) -> Result<String> {
    let (course, config): (&Course, _) = (flight.course(), flight.config());
    let (body, gusts, vanes) = setup.names();
    let size = config.camera.size;
    // The outputs for drawing and measuring do not affect the flight.
    let mut flown = config.clone();
    flown.pipeline.read_flow = false;
    (flown.measure, flown.pipeline.fields) = (false, ExtraOutputs::default());
    print::one_line(&Header {
        viewsphere: env!("CARGO_PKG_VERSION"),
        fingerprint: fingerprint(&(&flown, file::encode(course)?))?,
        backends,
        world: &course.name,
        seed: course.seed,
        policy: config.steer.policy.name(),
        danger: config.steer.danger.name(),
        sensor: config.sensor.name(),
        speed_m_s: config.speed_m_s,
        size: format!("{}x{}", size.width, size.height),
        latency_frames: config.latency_frames,
        body,
        wind_ned_m_s: config.wind_ned_m_s.to_array(),
        gusts,
        vanes,
        vertical_speed: config.vertical_speed.is_some(),
        faults: Faults(config.faults.clone()).to_string(),
        frame_s: FRAME_S,
        radius_m: config.radius_m,
        start_ned_m: course.start_ned_m.to_array(),
        start_yaw_rad: course.start_yaw_rad,
        goal_yaw_rad: course.goal_yaw_rad,
        length_m: course.length_m,
        altitude_m: course.altitude_m,
    })
}

/// The line of a frame.
pub(super) fn frame(record: &Record) -> Result<String> {
    print::one_line(&FrameLine {
        frame: record.frame,
        time_s: record.time_s,
        position_ned_m: record.position_ned_m.to_array(),
        velocity_ned_m_s: record.velocity_ned_m_s.to_array(),
        roll_pitch_yaw_rad: record.roll_pitch_yaw_rad,
        rate_body_rad_s: record.rate_body_rad_s.to_array(),
        airspeed_m_s: record.airspeed_m_s,
        clearance_m: record.clearance_m,
        progress_m: record.progress_m,
        offset_m: record.offset_m,
        invalid: record.invalid.as_deref(),
        coverage: record.coverage,
        heading_error_rad: record.heading_error_rad,
        contact_s: record.contact_s,
        true_contact_s: record.true_contact_s,
        measured: record.measured.map(MeasuredFigures::from),
        source: match record.source {
            Source::Cue => "cue",
            Source::Held => "held",
            Source::Recovery => "recovery",
        },
        command: record.command.into(),
        danger: record.danger,
        acting: record.acting.into(),
    })
}

impl From<Command> for Angles {
    fn from(Command { bank_rad, climb_rad }: Command) -> Self {
        Self { bank_rad, climb_rad }
    }
}

impl From<&Summary> for End {
    fn from(summary: &Summary) -> Self {
        let [offset_std_m, offset_mean_m] = summary.offset_m.map_or([None; 2], |offset| offset.map(Some));
        Self {
            outcome: summary.outcome.name(),
            time_s: summary.time_s,
            progress_m: summary.progress_m,
            path_m: summary.path_m,
            efficiency: summary.efficiency(),
            touches: summary.touches,
            shortest_m: summary.shortest_m,
            progress: summary.progress(),
            optimality: summary.optimality(),
            goal_speed_m_s: summary.goal_speed_m_s(),
            energy_hz2: summary.energy_hz2(),
            least_clearance_m: summary.least_clearance_m,
            low_clearance_m: summary.low_clearance_m,
            roll_rate_rad_s: summary.roll_rate_rad_s,
            invalid: summary.invalid,
            offset_std_m,
            offset_mean_m,
            measured: summary.measured.map(MeasuredFigures::from),
        }
    }
}
