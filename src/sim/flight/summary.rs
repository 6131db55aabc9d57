//! The summary of a flight.

use glam::DVec3;

use super::accuracy::Measured;
use super::record::Record;
use crate::named::named;
use crate::quantile::{above_share, sorted};
use crate::sim::Course;

/// How a flight ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The goal was reached.
    Reached,
    /// A surface came nearer than the vehicle's radius, at the end of the flight or, if it was
    /// [flown on](super::FlightConfig::fly_on), before.
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
    /// The progress at which the goal is reached, metres.
    pub length_m: f64,
    /// The distance flown, metres.
    pub path_m: f64,
    /// The length of the shortest way through the course for this vehicle, metres; `None` if there is none
    /// ([`Course::shortest_way_m`](crate::sim::Course::shortest_way_m)).
    pub shortest_m: Option<f64>,
    /// How often a surface came nearer than the vehicle's radius. At most 1 unless the flight is
    /// [flown on](super::FlightConfig::fly_on).
    pub touches: u32,
    /// The jerk, the rate of change of the acceleration: its magnitude integrated over the flight, m/s².
    pub jerk_m_s2: f64,
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

    /// AvoidBench's optimality factor: by how much the flight is longer than the shortest way, relative to that. 0 is the
    /// best; the way may be a little shorter than the one that was found, so that values slightly below 0 occur. `None`
    /// without a way, and for flights that did not reach the goal.
    ///
    /// The factor and the figures below are those of H. Yu, G. C. H. E. de Croon and C. De Wagter, AvoidBench: a
    /// high-fidelity vision-based obstacle avoidance benchmarking suite for multi-rotors, ICRA 2023, as its code computes
    /// them. Its processing time is [`Cost`](super::Cost), its number of collisions [`Summary::touches`].
    pub fn optimality(&self) -> Option<f64> {
        self.shortest_m
            .filter(|_| self.outcome == Outcome::Reached)
            .map(|shortest_m| self.path_m / shortest_m - 1.0)
    }

    /// AvoidBench's average goal velocity: the shortest way over the time taken, m/s. `None` as for
    /// [`Summary::optimality`].
    pub fn goal_speed_m_s(&self) -> Option<f64> {
        self.shortest_m
            .filter(|_| self.outcome == Outcome::Reached)
            .map(|shortest_m| shortest_m / self.time_s)
    }

    /// AvoidBench's mission progress: the share of the course that was flown, 0 to 1.
    pub fn progress(&self) -> f64 {
        (self.progress_m / self.length_m).clamp(0.0, 1.0)
    }

    /// AvoidBench's energy: the integral of the jerk per distance flown, 1/s². `None` for a flight without a distance.
    pub fn energy_hz2(&self) -> Option<f64> {
        (self.path_m > 0.0).then(|| self.jerk_m_s2 / self.path_m)
    }
}

/// Accumulates records, and the vehicle's states in between, into a [`Summary`].
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    clearances_m: Vec<f64>,
    offsets_m: Vec<f64>,
    measured: Vec<Measured>,
    path_m: f64,
    roll_rate_square: f64,
    invalid: usize,
    last_m: Option<DVec3>,
    /// `None` before the first clearance.
    least_clearance_m: Option<f64>,
    touches: u32,
    is_touching: bool,
    jerk_m_s2: f64,
    velocity_m_s: Option<DVec3>,
    acceleration_m_s2: Option<DVec3>,
}

impl Tally {
    pub(super) fn add(&mut self, record: &Record) {
        self.near(record.clearance_m);
        self.clearances_m.push(record.clearance_m);
        self.offsets_m.extend(record.offset_m);
        self.measured.extend(record.measured);
        let last_m = self.last_m.replace(record.position_ned_m);
        self.path_m += last_m.map_or(0.0, |last_m| last_m.distance(record.position_ned_m));
        self.roll_rate_square += record.rate_body_rad_s.x.powi(2);
        self.invalid += usize::from(record.invalid.is_some());
    }

    /// Adds the vehicle's state after a step of this length. Whether a surface has come nearer than the radius.
    pub(super) fn step(&mut self, velocity_m_s: DVec3, clearance_m: f64, radius_m: f64, step_s: f64) -> bool {
        self.near(clearance_m);
        let acceleration_m_s2 = self.velocity_m_s.map(|before| (velocity_m_s - before) / step_s);
        if let Some([before, now]) = self.acceleration_m_s2.zip(acceleration_m_s2).map(<[DVec3; 2]>::from) {
            self.jerk_m_s2 += before.distance(now);
        }
        (self.velocity_m_s, self.acceleration_m_s2) = (Some(velocity_m_s), acceleration_m_s2);
        let was_touching = std::mem::replace(&mut self.is_touching, !(clearance_m >= radius_m));
        let touches = self.is_touching && !was_touching;
        self.touches += u32::from(touches);
        touches
    }

    /// Takes note of a clearance.
    fn near(&mut self, clearance_m: f64) {
        self.least_clearance_m =
            Some(self.least_clearance_m.map_or(clearance_m, |least| least.min(clearance_m)));
    }

    /// Whether a surface has ever come nearer than the radius.
    pub(super) fn has_touched(&self) -> bool {
        self.touches > 0
    }

    /// The summary of a flight of a vehicle of this radius.
    pub(super) fn summary(&self, outcome: Outcome, last: &Record, course: &Course, radius_m: f64) -> Summary {
        let least_clearance_m = self.least_clearance_m.unwrap_or(f64::INFINITY);
        let count = self.clearances_m.len().max(1) as f64;
        let clearances_m = sorted(self.clearances_m.iter().copied());
        let mean = self.offsets_m.iter().sum::<f64>() / self.offsets_m.len() as f64;
        let variance = self.offsets_m.iter().map(|offset| (offset - mean).powi(2)).sum::<f64>();
        Summary {
            outcome,
            time_s: last.time_s,
            progress_m: last.progress_m,
            length_m: course.length_m,
            path_m: self.path_m,
            shortest_m: course.shortest_way_m(radius_m),
            touches: self.touches,
            jerk_m_s2: self.jerk_m_s2,
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

    /// Contact that lasts is one touch, and a second one counts once the surface was left.
    #[test]
    fn touches_are_counted_by_their_beginning() {
        let mut tally = Tally::default();
        let begun = [0.7, 0.5, 0.4, 0.6, 0.59, f64::NAN]
            .map(|clearance_m| tally.step(DVec3::X, clearance_m, 0.6, 0.1));
        assert_eq!(begun, [false, true, false, false, true, false]);
        assert_eq!((tally.touches, tally.least_clearance_m), (2, Some(0.4)));
    }

    #[test]
    fn jerk_is_the_change_of_the_acceleration() {
        let mut tally = Tally::default();
        // Accelerations of 10, 10, -20 and 0 m/s²: changes of 0, 30 and 20 m/s².
        for speed_m_s in [0.0, 1.0, 2.0, 0.0, 0.0] {
            tally.step(DVec3::Y * speed_m_s, 9.0, 0.6, 0.1);
        }
        assert!((tally.jerk_m_s2 - 50.0).abs() < 1e-9, "{}", tally.jerk_m_s2);
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
