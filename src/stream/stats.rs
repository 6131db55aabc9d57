//! Statistics of a stream: counts, latencies and the time of each step.

use std::time::Duration;

use crate::plan::Plan;
use crate::quantile::nearest_rank;

/// Number of latencies over which percentiles are computed.
const WINDOW: usize = 1024;

/// Percentiles of the time from a frame's submit to the return of its wait, over the last 1024 frames with a result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Latency {
    /// Number of frames; at 0 the other fields are zero.
    pub count: usize,
    /// The median.
    pub p50: Duration,
    /// The 90th percentile.
    pub p90: Duration,
    /// The 99th percentile.
    pub p99: Duration,
    /// The longest.
    pub max: Duration,
}

/// Counts of a stream since its creation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stats {
    /// Frames accepted.
    pub submitted: u64,
    /// Frames whose results were taken, first frames included.
    pub done: u64,
    /// Frames given up: dropped for a newer one, or past the deadline in [`process`](super::Stream::process).
    pub dropped: u64,
    /// Number of missed deadlines.
    pub timeouts: u64,
    /// Number of losses of the GPU.
    pub losses: u64,
    /// Number of times that it was reopened.
    pub rebuilt: u64,
    /// Whether the stream computes on the CPU, from the beginning or since a loss.
    pub on_cpu: bool,
}

/// The clock that measures the times of the steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeSource {
    /// None: times are not asked for, or the device has no such clock.
    None,
    /// The GPU's own clock.
    Gpu,
    /// The host's clock, around each step on the CPU.
    Host,
}

/// The time of a step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StageTime {
    /// The kernel's name.
    pub kernel: &'static str,
    /// The step's purpose, for example `level 2, iteration 1`.
    pub label: String,
    /// The time that it took.
    pub time: Duration,
}

/// The last latencies, in a ring of fixed size.
pub(super) struct Window {
    nanos: Box<[u64]>,
    seen: usize,
}

impl Window {
    pub(super) fn new() -> Self {
        Self { nanos: vec![0; WINDOW].into(), seen: 0 }
    }

    pub(super) fn add(&mut self, latency: Duration) {
        self.nanos[self.seen % WINDOW] = u64::try_from(latency.as_nanos()).unwrap_or(u64::MAX);
        self.seen += 1;
    }

    pub(super) fn latency(&self) -> Latency {
        let count = self.seen.min(WINDOW);
        let mut sorted = [0; WINDOW];
        let sorted = &mut sorted[..count];
        sorted.copy_from_slice(&self.nanos[..count]);
        sorted.sort_unstable();
        let rank = |thousandths| Duration::from_nanos(nearest_rank(sorted, thousandths).unwrap_or(0));
        Latency { count, p50: rank(500), p90: rank(900), p99: rank(990), max: rank(1000) }
    }
}

/// Memory for the time of every step, by parity, allocated once.
pub(super) struct Stages {
    pub(super) times: [Vec<StageTime>; 2],
    shown: (usize, usize),
}

impl Stages {
    pub(super) fn new(plan: &Plan) -> Self {
        let stage = |step: &crate::plan::Step| StageTime {
            kernel: step.kernel.name,
            label: step.label.clone(),
            time: Duration::ZERO,
        };
        Self { times: [0, 1].map(|parity| plan.steps(parity).map(stage).collect()), shown: (0, 0) }
    }

    /// Selects the first `count` steps of a parity.
    pub(super) fn show(&mut self, parity: usize, count: usize) {
        self.shown = (parity, count);
    }

    pub(super) fn shown(&self) -> &[StageTime] {
        &self.times[self.shown.0][..self.shown.1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_of_the_nearest_rank_and_the_last_frames() {
        let mut window = Window::new();
        assert_eq!(window.latency(), Latency::default());
        window.add(Duration::from_millis(7));
        let one = Duration::from_millis(7);
        assert_eq!(window.latency(), Latency { count: 1, p50: one, p90: one, p99: one, max: one });
        // Latencies before the last 1024 are forgotten.
        for i in (1..=WINDOW as u64).rev() {
            window.add(Duration::from_micros(i));
        }
        let expected = Latency {
            count: WINDOW,
            p50: Duration::from_micros(512),
            p90: Duration::from_micros(922),
            p99: Duration::from_micros(1014),
            max: Duration::from_micros(1024),
        };
        assert_eq!(window.latency(), expected);
    }
}
