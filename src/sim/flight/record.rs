//! What is kept of a flight.

use std::time::Duration;

use glam::DVec3;

use super::measure::Measured;
use crate::steer::{Command, Source};

/// What is kept of a frame. It holds nothing that differs from one run to the next.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// The frame's number, from 0.
    pub frame: u64,
    /// Its time, seconds.
    pub time_s: f64,
    /// Where the vehicle is, metres NED.
    pub position_ned_m: DVec3,
    /// How it moves over ground, m/s NED.
    pub velocity_ned_m_s: DVec3,
    /// Its roll, pitch and yaw.
    pub roll_pitch_yaw_rad: [f64; 3],
    /// Its angular rate, rad/s FRD.
    pub rate_body_rad_s: DVec3,
    /// Its airspeed, m/s.
    pub airspeed_m_s: f64,
    /// From its middle to the nearest surface, metres.
    pub clearance_m: f64,
    /// How far it has come towards the goal, metres.
    pub progress_m: f64,
    /// How far it is to the right of the middle of the way, where that has one.
    pub offset_m: Option<f64>,
    /// Why the view says nothing; none if it does.
    pub invalid: Option<String>,
    /// The share of the view that is trusted, 0 to 1.
    pub coverage: f64,
    /// Angle between the direction of motion that the view tells and the true one; none where it tells none.
    pub heading_error_rad: Option<f64>,
    /// Time to contact along the direction of motion, as the view says within 0.1 rad of it.
    pub contact_s: Option<f64>,
    /// The same, in truth.
    pub true_contact_s: Option<f64>,
    /// How far the flow is from the true one, where that is [measured](super::FlightConfig::measure).
    pub measured: Option<Measured>,
    /// What was decided.
    pub command: Command,
    /// By what.
    pub source: Source,
    /// How dangerous the way is that was chosen, 0 to 1.
    pub danger: Option<f64>,
    /// The command that acts from this frame to the next: one that was decided some frames before.
    pub acting: Command,
}

/// How a flight ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The goal was reached.
    Reached,
    /// Something came nearer than the vehicle's radius.
    Crashed,
    /// The vehicle left the band of altitudes.
    LeftBand,
    /// It took too long.
    TimedOut,
}

/// A flight in numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// How it ended.
    pub outcome: Outcome,
    /// When, seconds.
    pub time_s: f64,
    /// Progress towards the goal, metres.
    pub progress_m: f64,
    /// The way flown, metres.
    pub path_m: f64,
    /// The least clearance, metres.
    pub least_clearance_m: f64,
    /// The clearance that is undercut for a twentieth of the time, metres.
    pub low_clearance_m: f64,
    /// Root mean square of the roll rate, rad/s: what control costs.
    pub roll_rate_rad_s: f64,
    /// The share of frames without a cue, 0 to 1.
    pub invalid: f64,
    /// Standard deviation of the offset from the middle of the way, metres, and its mean, where there is a middle.
    pub offset_m: Option<[f64; 2]>,
    /// How far the flow is from the true one, where that is measured: medians over the frames.
    pub measured: Option<Measured>,
}

impl Summary {
    /// Progress a metre flown, 0 to 1.
    pub fn efficiency(&self) -> f64 {
        if self.path_m > 0.0 { (self.progress_m / self.path_m).max(0.0) } else { 0.0 }
    }
}

/// What the parts of a frame cost. It differs from run to run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Drawing the picture, or finding the true flow.
    pub sensor: Duration,
    /// From the picture to the sectors.
    pub pipeline: Duration,
    /// From the sectors to a command.
    pub steer: Duration,
    /// The vehicle's motion, and how near it is to everything.
    pub vehicle: Duration,
}

impl Cost {
    /// All together.
    pub fn total(&self) -> Duration {
        self.sensor + self.pipeline + self.steer + self.vehicle
    }
}

/// Adds up what becomes a [`Summary`].
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    clearances_m: Vec<f64>,
    offsets_m: Vec<f64>,
    measured: Vec<Measured>,
    path_m: f64,
    roll_rate_square: f64,
    invalid: usize,
    last_m: Option<DVec3>,
}

impl Tally {
    pub(super) fn add(&mut self, record: &Record) {
        self.clearances_m.push(record.clearance_m);
        self.offsets_m.extend(record.offset_m);
        self.measured.extend(record.measured);
        let last_m = self.last_m.replace(record.position_ned_m);
        self.path_m += last_m.map_or(0.0, |last_m| last_m.distance(record.position_ned_m));
        self.roll_rate_square += record.rate_body_rad_s.x.powi(2);
        self.invalid += usize::from(record.invalid.is_some());
    }

    /// The least clearance may have been between two frames.
    pub(super) fn summary(&self, outcome: Outcome, last: &Record, least_clearance_m: f64) -> Summary {
        let count = self.clearances_m.len().max(1) as f64;
        let mut sorted = self.clearances_m.clone();
        sorted.sort_by(f64::total_cmp);
        let mean = self.offsets_m.iter().sum::<f64>() / self.offsets_m.len() as f64;
        let variance = self.offsets_m.iter().map(|offset| (offset - mean).powi(2)).sum::<f64>();
        Summary {
            outcome,
            time_s: last.time_s,
            progress_m: last.progress_m,
            path_m: self.path_m,
            least_clearance_m,
            low_clearance_m: sorted.get(sorted.len() / 20).copied().unwrap_or(least_clearance_m),
            roll_rate_rad_s: (self.roll_rate_square / count).sqrt(),
            invalid: self.invalid as f64 / count,
            offset_m: (!self.offsets_m.is_empty())
                .then(|| [(variance / self.offsets_m.len() as f64).sqrt(), mean]),
            measured: Measured::over(&self.measured),
        }
    }
}
