//! What a stream tells of itself: counts, latencies and the time of each step.

use std::time::Duration;

use crate::plan::Plan;

/// Latencies that the percentiles are taken from.
const WINDOW: usize = 1024;

/// Time from submit to wait's return, over the last 1024 frames that gave a result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Latency {
    /// Frames in the window; at 0 the rest is zero.
    pub count: usize,
    /// Half of the frames took at most this long.
    pub p50: Duration,
    /// Nine in ten took at most this long.
    pub p90: Duration,
    /// 99 in a hundred took at most this long.
    pub p99: Duration,
    /// The longest.
    pub max: Duration,
}

/// What a stream has counted since it was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stats {
    /// Frames accepted.
    pub submitted: u64,
    /// Frames handed over, first frames included.
    pub done: u64,
    /// Frames given up: replaced by a newer one, or late in [`process`](super::Stream::process).
    pub dropped: u64,
    /// Times that a deadline passed.
    pub timeouts: u64,
    /// Times that the GPU was lost.
    pub losses: u64,
    /// Times that it was brought back.
    pub rebuilt: u64,
    /// Whether the stream computes on the CPU, from the beginning or since a loss.
    pub on_cpu: bool,
}

/// Where the times of the steps come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeSource {
    /// Nowhere: not asked for, or the device cannot tell.
    None,
    /// The GPU's own clock.
    Gpu,
    /// The host's clock, around each step on the CPU.
    Host,
}

/// How long a step took.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StageTime {
    /// The kernel's name.
    pub kernel: &'static str,
    /// What it was done for, for example `level 2, iteration 1`.
    pub label: String,
    /// How long it took.
    pub time: Duration,
}

/// The last latencies, in a ring that never grows.
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
        // The nearest rank: the smallest latency that so many of a hundred do not exceed.
        let rank = |percent: usize| {
            let at = (count * percent).div_ceil(100).max(1) - 1;
            Duration::from_nanos(sorted.get(at).copied().unwrap_or(0))
        };
        Latency { count, p50: rank(50), p90: rank(90), p99: rank(99), max: rank(100) }
    }
}

/// Room for the time of every step, by parity, made once.
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

    /// Shows the first `count` steps of a parity from now on.
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
        // What came before the last 1024 is forgotten.
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
