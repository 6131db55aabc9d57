//! The summary of the computed flow.

use serde::Serialize;

use crate::cli::print;
use crate::error::Result;
use crate::frame::{FlowField, Size};
use crate::stream::Latency;

/// Statistics over all pairs.
#[derive(Debug, Serialize)]
pub(super) struct Report {
    backend: String,
    width: u32,
    height: u32,
    pub(super) pairs: u64,
    /// The mean over the known displacements of all pairs.
    mean_flow_px: f64,
    max_flow_px: f64,
    /// The median of the times from submitting a frame to receiving its flow.
    median_ms: f64,
    p99_ms: f64,
    /// The displacement shown in full colour, if colour images were written.
    color_scale_px: Option<f32>,
    #[serde(skip)]
    known: u64,
}

impl Report {
    pub(super) fn new(backend: String, size: Size) -> Self {
        Self {
            backend,
            width: size.width,
            height: size.height,
            pairs: 0,
            mean_flow_px: 0.0,
            max_flow_px: 0.0,
            median_ms: 0.0,
            p99_ms: 0.0,
            color_scale_px: None,
            known: 0,
        }
    }

    pub(super) fn add(&mut self, flow: &FlowField) {
        for [u, v] in flow.data.iter().filter(|uv| FlowField::is_known(**uv)) {
            let length = f64::from(u.hypot(*v));
            self.known += 1;
            self.mean_flow_px += (length - self.mean_flow_px) / self.known as f64;
            self.max_flow_px = self.max_flow_px.max(length);
        }
        self.pairs += 1;
    }

    pub(super) fn finish(&mut self, latency: Latency, scale: Option<f32>) {
        self.median_ms = latency.p50.as_secs_f64() * 1e3;
        self.p99_ms = latency.p99.as_secs_f64() * 1e3;
        self.color_scale_px = scale;
    }

    /// Prints to standard output: with `json` everything as JSON, with `summary` everything as text, else only the
    /// scale of the colours.
    pub(super) fn print(&self, json: bool, summary: bool) -> Result<()> {
        if json {
            return print::json(self);
        }
        if summary {
            print::text(&format!(
                "{} pair{} of {}×{} on {}\nflow   mean {:.3} px, max {:.3} px\ntime   median {:.2} ms, p99 {:.2} ms per pair",
                self.pairs,
                if self.pairs == 1 { "" } else { "s" },
                self.width,
                self.height,
                self.backend,
                self.mean_flow_px,
                self.max_flow_px,
                self.median_ms,
                self.p99_ms,
            ))?;
        }
        match self.color_scale_px {
            Some(scale) => print::text(&format!("colour scale: {scale:.4} px is full colour")),
            None => Ok(()),
        }
    }
}
