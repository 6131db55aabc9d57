//! The computing time of a flight's frames. It differs from run to run.

use std::time::Duration;

use serde::Serialize;

use crate::quantile::{nearest_rank, sorted};
use crate::sim::flight::Cost;

/// The frame interval at 30 Hz, milliseconds.
const REAL_TIME_MS: f64 = 33.0;

/// The costs of all frames so far.
#[derive(Default)]
pub(in crate::cli) struct Costs {
    frames: Vec<Cost>,
    latencies: Vec<Duration>,
}

#[derive(Serialize)]
pub(in crate::cli) struct Timing {
    /// The backends that rendered the images and computed the flow; `null` for a sensor without images.
    backends: Option<[String; 2]>,
    frames: usize,
    /// The number of frames that took longer than the frame interval at 30 Hz.
    over_33_ms: usize,
    total_ms: Spread,
    sensor_ms: Spread,
    pipeline_ms: Spread,
    steer_ms: Spread,
    vehicle_ms: Spread,
    /// The time from an image's submission to its cue; `null` for a sensor without images.
    latency_ms: Option<Spread>,
}

#[derive(Clone, Copy, Serialize)]
struct Spread {
    median: f64,
    p99: f64,
}

impl Costs {
    pub(in crate::cli) fn add(&mut self, cost: Cost) {
        self.frames.push(cost);
    }

    pub(in crate::cli) fn add_latency(&mut self, latency: Duration) {
        self.latencies.push(latency);
    }

    /// The cost of each frame, in order.
    pub(in crate::cli) fn frames(&self) -> &[Cost] {
        &self.frames
    }

    pub(in crate::cli) fn timing(&self, backends: Option<[String; 2]>) -> Timing {
        let part =
            |part: fn(&Cost) -> Duration| Spread::of(self.frames.iter().map(part)).unwrap_or(Spread::NONE);
        Timing {
            backends,
            frames: self.frames.len(),
            over_33_ms: self.frames.iter().filter(|cost| milliseconds(cost.total()) > REAL_TIME_MS).count(),
            total_ms: part(Cost::total),
            sensor_ms: part(|cost| cost.sensor),
            pipeline_ms: part(|cost| cost.pipeline),
            steer_ms: part(|cost| cost.steer),
            vehicle_ms: part(|cost| cost.vehicle),
            latency_ms: Spread::of(self.latencies.iter().copied()),
        }
    }
}

impl Timing {
    /// The median times of the parts, as text.
    pub(in crate::cli) fn parts(&self) -> String {
        let [sight, pipeline, steer] =
            [self.sensor_ms, self.pipeline_ms, self.steer_ms].map(|part| part.median);
        format!(
            "rendering {sight:.2} ms, image to sectors {pipeline:.2} ms, sectors to command {steer:.2} ms (medians)"
        )
    }

    /// The total time per frame, as text.
    pub(in crate::cli) fn text(&self) -> String {
        let Spread { median, p99 } = self.total_ms;
        format!(
            "median {median:.2} ms per frame, p99 {p99:.2} ms, {} of {} frames over {REAL_TIME_MS} ms",
            self.over_33_ms, self.frames
        )
    }
}

impl Spread {
    const NONE: Self = Self { median: 0.0, p99: 0.0 };

    fn of(times: impl Iterator<Item = Duration>) -> Option<Self> {
        let sorted = sorted(times.map(milliseconds));
        let at = |thousandths| nearest_rank(&sorted, thousandths);
        Some(Self { median: at(500)?, p99: at(990)? })
    }
}

fn milliseconds(time: Duration) -> f64 {
    1e3 * time.as_secs_f64()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_and_late_frames_are_counted() {
        let mut costs = Costs::default();
        for ms in 0..100 {
            costs.add(Cost { sensor: Duration::from_millis(ms), ..Cost::default() });
        }
        let timing = costs.timing(None);
        assert_eq!((timing.frames, timing.over_33_ms), (100, 66));
        assert_eq!((timing.sensor_ms.median, timing.total_ms.p99), (49.0, 98.0));
        assert_eq!(timing.pipeline_ms.p99, 0.0);
        assert!(timing.latency_ms.is_none());
    }
}
