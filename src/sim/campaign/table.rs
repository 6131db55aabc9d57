use std::fmt::Write;

use super::statistics::{mean, wilson};
use super::{Ended, JobResult, Setting};
use crate::quantile::{nearest, sorted};
use crate::sim::flight::{Outcome, Summary};

/// A campaign's results: a row per setting, in the order of [`Setting::order`].
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Table {
    /// The adapters that computed the flow.
    pub adapters: Vec<String>,
    /// The rows.
    pub rows: Vec<Row>,
}

/// The statistics of one setting's flights. What is undefined for them is `None`.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Row {
    /// The world's generator.
    pub world: String,
    /// What the vehicle steered by.
    pub sensor: String,
    /// The steering policy.
    pub policy: String,
    /// The measure of danger.
    pub danger: String,
    /// Airspeed, m/s.
    pub speed_m_s: f64,
    /// Image size.
    pub size: String,
    /// Frames from an exposure until its command took effect.
    pub latency_frames: u32,
    /// The faults that occurred.
    pub faults: String,
    /// Completed flights.
    pub flights: usize,
    /// Jobs that failed with an error; no other figure counts them.
    pub failed: usize,
    /// Flights that reached the goal.
    pub reached: usize,
    /// Flights that ended in a collision.
    pub crashed: usize,
    /// Flights that left the altitude band.
    pub left_band: usize,
    /// Flights that timed out.
    pub timed_out: usize,
    /// The share of flights that reached the goal, 0 to 1.
    pub success: Option<f64>,
    /// The lower end of its 95 % confidence interval, by [`wilson`].
    pub success_low: f64,
    /// The upper end.
    pub success_high: f64,
    /// The least clearance of a flight, metres: the mean over the flights.
    pub least_clearance_mean_m: Option<f64>,
    /// The least clearance of a flight, metres: the 5th percentile over the flights.
    pub least_clearance_p5_m: Option<f64>,
    /// Path efficiency, progress per distance flown, 0 to 1: the mean over the flights that reached the goal.
    pub efficiency: Option<f64>,
    /// How often a surface came nearer than the vehicle's radius, in all flights together: the number of crashes, unless
    /// the flights were [flown on](crate::sim::flight::FlightConfig::fly_on).
    pub touches: usize,
    /// Distance flown per touch, metres; `None` without a touch.
    pub between_touches_m: Option<f64>,
    /// Mission progress, the share of the course that was flown, 0 to 1: the mean over the flights.
    pub progress: Option<f64>,
    /// [`Summary::optimality`]: the mean over the flights that have one.
    pub optimality: Option<f64>,
    /// [`Summary::goal_speed_m_s`]: the mean over the flights that have one.
    pub goal_speed_m_s: Option<f64>,
    /// [`Summary::energy_hz2`]: that of all flights together.
    pub energy_hz2: Option<f64>,
    /// Flights through a course without a way at the altitude of its start, by
    /// [`Course::shortest_way_m`](crate::sim::Course::shortest_way_m).
    pub without_way: usize,
    /// Total distance flown, metres.
    pub path_m: f64,
    /// Root mean square of the roll rate over the time of all flights, rad/s.
    pub roll_rate_rad_s: Option<f64>,
    /// The share of the time without a valid cue, 0 to 1.
    pub invalid: Option<f64>,
    /// Offset to the right of the centre line, metres: the mean over the flights. `None` for courses without one.
    pub offset_mean_m: Option<f64>,
    /// The offset's standard deviation within a flight, metres: the mean over the flights.
    pub offset_std_m: Option<f64>,
}

impl Table {
    /// The table of all results.
    pub fn of(results: &[&JobResult]) -> Self {
        let mut sorted = results.to_vec();
        sorted.sort_by(|a, b| a.job.order(&b.job));
        let mut adapters: Vec<String> = sorted.iter().filter_map(|result| result.adapter.clone()).collect();
        adapters.sort();
        adapters.dedup();
        let rows = sorted.chunk_by(|a, b| a.job.setting == b.job.setting).map(Row::of).collect();
        Self { adapters, rows }
    }

    /// The rows as comma-separated values below a header. `None` is an empty cell.
    pub fn csv(&self) -> String {
        let mut text = COLUMNS.join(",") + "\n";
        for row in &self.rows {
            let some = |value: Option<f64>| value.map(|value| value.to_string()).unwrap_or_default();
            let cells = [
                row.world.clone(),
                row.sensor.clone(),
                row.policy.clone(),
                row.danger.clone(),
                row.speed_m_s.to_string(),
                row.size.clone(),
                row.latency_frames.to_string(),
                row.faults.clone(),
                row.flights.to_string(),
                row.failed.to_string(),
                row.reached.to_string(),
                row.crashed.to_string(),
                row.left_band.to_string(),
                row.timed_out.to_string(),
                some(row.success),
                row.success_low.to_string(),
                row.success_high.to_string(),
                some(row.least_clearance_mean_m),
                some(row.least_clearance_p5_m),
                some(row.efficiency),
                row.touches.to_string(),
                some(row.between_touches_m),
                some(row.progress),
                some(row.optimality),
                some(row.goal_speed_m_s),
                some(row.energy_hz2),
                row.without_way.to_string(),
                row.path_m.to_string(),
                some(row.roll_rate_rad_s),
                some(row.invalid),
                some(row.offset_mean_m),
                some(row.offset_std_m),
            ];
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{}", cells.join(","));
        }
        text
    }
}

/// The columns of [`Table::csv`]: the fields of a [`Row`].
const COLUMNS: [&str; 32] = [
    "world",
    "sensor",
    "policy",
    "danger",
    "speed_m_s",
    "size",
    "latency_frames",
    "faults",
    "flights",
    "failed",
    "reached",
    "crashed",
    "left_band",
    "timed_out",
    "success",
    "success_low",
    "success_high",
    "least_clearance_mean_m",
    "least_clearance_p5_m",
    "efficiency",
    "touches",
    "between_touches_m",
    "progress",
    "optimality",
    "goal_speed_m_s",
    "energy_hz2",
    "without_way",
    "path_m",
    "roll_rate_rad_s",
    "invalid",
    "offset_mean_m",
    "offset_std_m",
];

impl Row {
    /// The row of one setting's results, of which there is at least one.
    fn of(results: &[&JobResult]) -> Self {
        let flown: Vec<&Summary> = (results.iter())
            .filter_map(|result| match &result.ended {
                Ended::Flown(summary) => Some(summary),
                Ended::Failed(_) => None,
            })
            .collect();
        let count = |outcome| flown.iter().filter(|summary| summary.outcome == outcome).count();
        let all = |value: fn(&Summary) -> f64| flown.iter().map(|summary| value(summary)).collect::<Vec<_>>();
        let [reached, crashed] = [Outcome::Reached, Outcome::Crashed].map(count);
        let [success_low, success_high] = wilson(reached, flown.len());
        let path_m: f64 = all(|summary| summary.path_m).iter().sum();
        let time_s: f64 = all(|summary| summary.time_s).iter().sum();
        // Weight flights by their duration, as their frames would.
        let over_time = |value: fn(&Summary) -> f64| {
            let sum: f64 = flown.iter().map(|summary| value(summary) * summary.time_s).sum();
            (time_s > 0.0).then(|| sum / time_s)
        };
        let clearances_m = all(|summary| summary.least_clearance_m);
        let arrived = flown.iter().filter(|summary| summary.outcome == Outcome::Reached);
        let offset = |which: usize| {
            mean(&flown.iter().filter_map(|summary| Some(summary.offset_m?[which])).collect::<Vec<_>>())
        };
        let touches = flown.iter().map(|summary| summary.touches as usize).sum::<usize>();
        let some = |value: fn(&Summary) -> Option<f64>| {
            flown.iter().filter_map(|summary| value(summary)).collect::<Vec<_>>()
        };
        let progress = all(Summary::progress);
        let first = &results[0].job.setting;
        let Setting { world, sensor, policy, danger, speed_m_s, latency_frames, faults, .. } = first;
        Self {
            world: world.to_string(),
            sensor: sensor.to_string(),
            policy: policy.to_string(),
            danger: danger.to_string(),
            speed_m_s: *speed_m_s,
            size: first.size_text(),
            latency_frames: *latency_frames,
            faults: faults.to_string(),
            flights: flown.len(),
            failed: results.len() - flown.len(),
            reached,
            crashed,
            left_band: count(Outcome::LeftBand),
            timed_out: count(Outcome::TimedOut),
            success: (!flown.is_empty()).then(|| reached as f64 / flown.len() as f64),
            success_low,
            success_high,
            least_clearance_mean_m: mean(&clearances_m),
            least_clearance_p5_m: nearest(&sorted(clearances_m.iter().copied()), 0.05),
            efficiency: mean(&arrived.map(|summary| summary.efficiency()).collect::<Vec<_>>()),
            touches,
            between_touches_m: (touches > 0).then(|| path_m / touches as f64),
            progress: mean(&progress),
            optimality: mean(&some(Summary::optimality)),
            goal_speed_m_s: mean(&some(Summary::goal_speed_m_s)),
            energy_hz2: (path_m > 0.0).then(|| all(|summary| summary.jerk_m_s2).iter().sum::<f64>() / path_m),
            without_way: flown.iter().filter(|summary| summary.shortest_m.is_none()).count(),
            path_m,
            roll_rate_rad_s: over_time(|summary| summary.roll_rate_rad_s.powi(2)).map(f64::sqrt),
            invalid: over_time(|summary| summary.invalid),
            offset_mean_m: offset(1),
            offset_std_m: offset(0),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::super::testing::{failed, flown};
    use super::*;

    #[test]
    fn a_row_adds_up_by_hand() {
        let results = [
            flown("wall", 0, Outcome::Reached, 2.0),
            flown("wall", 1, Outcome::Crashed, 0.5),
            failed("wall", 2),
            flown("forest", 0, Outcome::TimedOut, 1.0),
        ];
        let table = Table::of(&results.iter().collect::<Vec<_>>());
        assert_eq!(table.rows.iter().map(|row| row.world.as_str()).collect::<Vec<_>>(), ["forest", "wall"]);
        let wall = &table.rows[1];
        assert_eq!((wall.flights, wall.failed, wall.reached, wall.crashed), (2, 1, 1, 1));
        assert_eq!((wall.left_band, wall.timed_out), (0, 0));
        assert_eq!(wall.success, Some(0.5));
        assert_eq!([wall.success_low, wall.success_high], wilson(1, 2));
        assert_eq!(wall.least_clearance_mean_m, Some(1.25));
        assert_eq!(wall.least_clearance_p5_m, Some(0.5));
        // Each flight makes 100 m of progress on a path of 125 m, in 10 s, and rolls by 0.3 rad/s.
        assert_eq!(wall.efficiency, Some(0.8));
        assert_eq!((wall.path_m, wall.touches, wall.between_touches_m), (250.0, 1, Some(250.0)));
        // Of 110 m, on a path of 125 m where 120 m would do; the jerk adds up to 250 m/s².
        assert_eq!((wall.progress, wall.optimality), (Some(100.0 / 110.0), Some(125.0 / 120.0 - 1.0)));
        assert_eq!((wall.goal_speed_m_s, wall.energy_hz2, wall.without_way), (Some(12.0), Some(2.0), 0));
        assert!((wall.roll_rate_rad_s.unwrap() - 0.3).abs() < 1e-12);
        assert!((wall.invalid.unwrap() - 0.1).abs() < 1e-12);
        let forest = &table.rows[0];
        assert_eq!((forest.timed_out, forest.efficiency, forest.between_touches_m), (1, None, None));
    }

    #[test]
    fn the_order_of_the_results_does_not_matter() {
        let mut results: Vec<JobResult> =
            (0..7).map(|seed| flown("wall", seed, Outcome::Reached, seed as f64)).collect();
        results.push(flown("city", 3, Outcome::Crashed, 0.1));
        let table = Table::of(&results.iter().collect::<Vec<_>>());
        results.reverse();
        assert_eq!(table, Table::of(&results.iter().collect::<Vec<_>>()));
    }

    #[test]
    fn csv_has_a_cell_for_every_column() {
        let results = [failed("wall", 2), flown("forest", 0, Outcome::TimedOut, 1.0)];
        let csv = Table::of(&results.iter().collect::<Vec<_>>()).csv();
        let lines: Vec<&str> = csv.lines().collect();
        assert_eq!(lines.len(), 3);
        assert!(lines.iter().all(|line| line.split(',').count() == COLUMNS.len()), "{csv}");
        assert!(lines[1].starts_with("forest,depth,arc,nearness,12,320x240,1,none,1,0,0,0,0,1,0,"), "{csv}");
        assert!(
            lines[2].starts_with("wall,depth,arc,nearness,12,320x240,1,none,0,1,0,0,0,0,,0,1,,"),
            "{csv}"
        );
    }
}
