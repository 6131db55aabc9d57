//! Times of repeated work.

use std::time::Instant;

use crate::quantile::{nearest_rank, sorted};

/// Statistics of repeated measurements, in milliseconds.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Times {
    /// The median.
    pub median: f64,
    /// The 99th percentile (nearest rank).
    pub p99: f64,
    /// The shortest.
    pub min: f64,
}

impl Times {
    /// The statistics of these measurements, in milliseconds; NaN for none.
    pub(super) fn new(ms: Vec<f64>) -> Self {
        let ms = sorted(ms);
        let rank = |thousandths| nearest_rank(&ms, thousandths).unwrap_or(f64::NAN);
        Self { median: rank(500), p99: rank(990), min: rank(0) }
    }
}

/// The result of some work, and its time in milliseconds.
pub(crate) fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let result = work();
    (result, start.elapsed().as_secs_f64() * 1e3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_of_the_nearest_rank() {
        let times = Times::new((1..=200).rev().map(f64::from).collect());
        assert_eq!((times.min, times.median, times.p99), (1.0, 100.0, 198.0));
    }
}
