//! `viewsphere bench`: the time per frame and per kernel, compared with the speed of a plain copy.

mod serve;
mod show;

use clap::Args;
use serde::Serialize;

use super::backend::BackendArgs;
use super::flow_args::FlowArgs;
use super::{Outcome, print};
use crate::backend::Backend;
use crate::benchmark;
use crate::error::{Error, Result};
use crate::flow::Algorithm;
use crate::frame::Size;

/// Time a frame and each kernel, on the GPU and on the CPU.
///
/// Frames of a synthetic scene are streamed; a frame's time includes its upload and the readback of the flow. Kernels
/// are timed in a second run: on the GPU by its own clock, on the CPU around each step. "moved" counts the bytes that
/// a step must at least read and write, "Mflop" the floating-point operations of its shader. "of copy" compares its
/// throughput with that of a plain copy measured in the same run: how much faster the kernel could still become. Work
/// that stays in a cache can exceed 100 %.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  viewsphere bench
  viewsphere bench --size 640x480 1280x720 --preset fast --frames 200
  viewsphere bench --backend gpu --adapter llvmpipe --json
  viewsphere bench --pipeline                        the cost of whole pipelines, up to the sectors of the view
  viewsphere bench --serve                           answer requests, one JSON object per line; see benches/opencv.py")]
pub(super) struct Bench {
    /// Frame sizes
    #[arg(long, value_name = "WxH", num_args = 1.., default_value = "640x480")]
    size: Vec<Size>,
    /// Frames to time in each run, 2 to 100000
    #[arg(long, value_name = "N", default_value_t = 50, allow_negative_numbers = true)]
    frames: u32,
    /// Print the results as JSON
    #[arg(long)]
    json: bool,
    /// Time whole pipelines, from raw frames to sectors, interleaved with the flow alone
    #[arg(long, conflicts_with = "serve")]
    pipeline: bool,
    /// Answer requests on standard input, one JSON object per line, until it ends
    #[arg(long)]
    serve: bool,
    #[command(flatten)]
    flow: FlowArgs,
    #[command(flatten)]
    backend: BackendArgs,
}

impl Bench {
    pub(super) fn run(&self) -> Result<Outcome> {
        if self.serve {
            return serve::serve(&self.backend).map(|()| Outcome::Done);
        }
        if !(2..=100_000).contains(&self.frames) {
            return Err(Error::parameter("--frames", self.frames, "2 to 100000"));
        }
        match self.pipeline {
            true => self.each(benchmark::pipelines, show::pipelines),
            false => self.each(benchmark::stream, show::stream),
        }
    }

    /// Measures on each backend at each size, and prints each result when it is there; as JSON all of them at the end.
    fn each<T: Serialize>(
        &self,
        measure: impl Fn(&Backend, Size, &Algorithm, u32) -> Result<T>,
        text: impl Fn(&T) -> String,
    ) -> Result<Outcome> {
        let algorithm = self.flow.algorithm()?;
        let mut results = Vec::new();
        for backend in self.backend.open_all()? {
            for &size in &self.size {
                let figures = measure(&backend, size, &algorithm, self.frames)?;
                if !self.json {
                    print::text(&text(&figures))?;
                    print::text("")?;
                }
                results.push(figures);
            }
        }
        if self.json {
            print::json(&results)?;
        }
        Ok(Outcome::Done)
    }
}
