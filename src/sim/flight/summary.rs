//! The summary of a flight.

use glam::DVec3;

use super::accuracy::Measured;
use super::record::Record;
use crate::named::named;
use crate::quantile::{above_share, sorted};

/// How a flight ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The goal was reached.
    Reached,
    /// A surface came nearer than the vehicle's radius.
    Crashed,
    /// The vehicle left the altitude band.
    LeftBand,
    /// The flight took too long.
    TimedOut,
}

impl Outcome {
    /// All outcomes, the best first.
    pub const ALL: [Self; 4] = [Self::Reached, Self::Crashed, Self::LeftBand, Self::TimedOut];

    /// The name: `reached`, `crashed`, `left-band` or `timed-out`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Reached => "reached",
            Self::Crashed => "crashed",
            Self::LeftBand => "left-band",
            Self::TimedOut => "timed-out",
        }
    }
}

named!(Outcome, "outcome");

/// A flight in numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// How the flight ended.
    pub outcome: Outcome,
    /// When it ended, seconds.
    pub time_s: f64,
    /// Progress towards the goal, metres.
    pub progress_m: f64,
    /// The distance flown, metres.
    pub path_m: f64,
    /// The least clearance, metres.
    pub least_clearance_m: f64,
    /// The 5th percentile of the clearance over the frames, metres.
    pub low_clearance_m: f64,
    /// Root mean square of the roll rate, rad/s: a measure of control effort.
    pub roll_rate_rad_s: f64,
    /// The share of frames without a valid cue, 0 to 1.
    pub invalid: f64,
    /// Standard deviation and mean of the offset to the right of the centre line, metres; `None` for courses without
    /// one.
    pub offset_m: Option<[f64; 2]>,
    /// The error of the flow, if it is measured: medians over the frames.
    pub measured: Option<Measured>,
}

impl Summary {
    /// Path efficiency: progress per distance flown, 0 to 1.
    pub fn efficiency(&self) -> f64 {
        if self.path_m > 0.0 { (self.progress_m / self.path_m).max(0.0) } else { 0.0 }
    }
}

/// Accumulates records into a [`Summary`].
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

    /// The summary. The least clearance is passed in, as it may lie between two frames.
    pub(super) fn summary(&self, outcome: Outcome, last: &Record, least_clearance_m: f64) -> Summary {
        let count = self.clearances_m.len().max(1) as f64;
        let clearances_m = sorted(self.clearances_m.iter().copied());
        let mean = self.offsets_m.iter().sum::<f64>() / self.offsets_m.len() as f64;
        let variance = self.offsets_m.iter().map(|offset| (offset - mean).powi(2)).sum::<f64>();
        Summary {
            outcome,
            time_s: last.time_s,
            progress_m: last.progress_m,
            path_m: self.path_m,
            least_clearance_m,
            low_clearance_m: above_share(&clearances_m, 0.05).unwrap_or(least_clearance_m),
            roll_rate_rad_s: (self.roll_rate_square / count).sqrt(),
            invalid: self.invalid as f64 / count,
            offset_m: (!self.offsets_m.is_empty())
                .then(|| [(variance / self.offsets_m.len() as f64).sqrt(), mean]),
            measured: Measured::over(&self.measured),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        for outcome in Outcome::ALL {
            assert_eq!(outcome.to_string().parse::<Outcome>().unwrap(), outcome);
        }
    }

    /// The index behind the 5th percentile of the clearance.
    #[test]
    fn a_twentieth_of_the_frames_is_exact_for_every_length() {
        for frames in 1..5000_usize {
            let indices: Vec<usize> = (0..frames).collect();
            assert_eq!(above_share(&indices, 0.05), Some(frames / 20));
        }
    }
}
