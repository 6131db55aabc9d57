//! The summary of a run.

use std::time::Instant;

use serde::Serialize;

use crate::cli::print;
use crate::error::Result;
use crate::pipeline::{Invalid, InvalidKind};
use crate::stream::Latency;
use crate::text::counted;

/// Statistics over all frames.
#[derive(Debug, Serialize)]
pub(super) struct RunSummary {
    backend: String,
    /// The frames processed, without the dropped ones.
    frames: u64,
    valid: u64,
    invalid: ByKind,
    dropped: u64,
    alarms: u64,
    latency_p50_ms: f64,
    latency_p99_ms: f64,
    frames_per_s: f64,
    #[serde(skip)]
    begin: Instant,
}

/// The number of invalid frames per kind of reason.
#[derive(Debug, Default, Serialize)]
struct ByKind {
    first: u64,
    interval: u64,
    gyro: u64,
    coverage: u64,
    lost: u64,
    frozen: u64,
    turn: u64,
}

impl ByKind {
    /// The counts in the order of [`InvalidKind::ALL`].
    fn counts(&mut self) -> [&mut u64; InvalidKind::ALL.len()] {
        let Self { first, interval, gyro, coverage, lost, frozen, turn } = self;
        [first, interval, gyro, coverage, lost, frozen, turn]
    }
}

impl RunSummary {
    pub(super) fn new(backend: String) -> Self {
        Self {
            backend,
            frames: 0,
            valid: 0,
            invalid: ByKind::default(),
            dropped: 0,
            alarms: 0,
            latency_p50_ms: 0.0,
            latency_p99_ms: 0.0,
            frames_per_s: 0.0,
            begin: Instant::now(),
        }
    }

    pub(super) fn add(&mut self, invalid: Option<Invalid>, alarm: bool) {
        self.frames += 1;
        self.alarms += u64::from(alarm);
        match invalid {
            None => self.valid += 1,
            Some(reason) => *self.invalid.counts()[reason.kind() as usize] += 1,
        }
    }

    pub(super) fn finish(&mut self, latency: Latency, dropped: u64) {
        self.latency_p50_ms = latency.p50.as_secs_f64() * 1e3;
        self.latency_p99_ms = latency.p99.as_secs_f64() * 1e3;
        self.frames_per_s = self.frames as f64 / self.begin.elapsed().as_secs_f64().max(1e-9);
        self.dropped = dropped;
    }

    /// Prints to standard output as JSON, or to standard error as text.
    pub(super) fn print(&mut self, json: bool) -> Result<()> {
        if json {
            return print::json(self);
        }
        let named = self.invalid.counts().into_iter().zip(InvalidKind::ALL).filter(|(count, _)| **count > 0);
        let kinds: Vec<String> = named.map(|(count, kind)| format!("{count} {}", kind.name())).collect();
        let invalid = if kinds.is_empty() { "none".to_owned() } else { kinds.join(", ") };
        print::note(format_args!(
            "{}, {} valid, invalid: {invalid}; {} dropped, {} with an alarm; latency median {:.2} ms, p99 {:.2} ms; \
             {:.1} frames/s on {}",
            counted(self.frames as usize, "frame"),
            self.valid,
            self.dropped,
            self.alarms,
            self.latency_p50_ms,
            self.latency_p99_ms,
            self.frames_per_s,
            self.backend,
        ));
        Ok(())
    }
}
