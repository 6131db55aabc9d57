//! Synthetic results.

use super::{Ended, Faults, Job, JobResult, Setting};
use crate::frame::Size;
use crate::sim::CourseKind;
use crate::sim::flight::{Outcome, Sensor, Summary};
use crate::steer::{Danger, Policy};

fn job(world: &str, seed: u64) -> Job {
    let world = world.parse::<CourseKind>().unwrap_or_else(|error| panic!("{error}"));
    let setting = Setting {
        world,
        sensor: Sensor::Depth,
        policy: Policy::Arc,
        danger: Danger::Nearness,
        speed_m_s: 12.0,
        size: Size::new(320, 240),
        latency_frames: 1,
        faults: Faults::default(),
    };
    Job { setting, seed }
}

pub(crate) fn flown(world: &str, seed: u64, outcome: Outcome, least_clearance_m: f64) -> JobResult {
    let summary = Summary {
        outcome,
        time_s: 10.0,
        progress_m: 100.0,
        length_m: 110.0,
        path_m: 125.0,
        shortest_m: Some(120.0),
        touches: u32::from(outcome == Outcome::Crashed),
        jerk_m_s2: 250.0,
        least_clearance_m,
        low_clearance_m: least_clearance_m + 1.0 / 3.0,
        roll_rate_rad_s: 0.3,
        invalid: 0.1,
        offset_m: None,
        measured: None,
    };
    JobResult { job: job(world, seed), adapter: None, ended: Ended::Flown(summary) }
}

pub(crate) fn failed(world: &str, seed: u64) -> JobResult {
    let ended = Ended::Failed("too many surfaces".to_owned());
    JobResult { job: job(world, seed), adapter: None, ended }
}
