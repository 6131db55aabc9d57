//! `viewsphere demo`: a made-up scene, its flow, and how far that is from the truth.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::backend::BackendArgs;
use super::eval::FlowErrorFigures;
use super::flow::gray;
use super::flow_args::FlowArgs;
use super::{Outcome, input, print};
use crate::engine::{Config, Engine};
use crate::error::{Error, Result};
use crate::eval::{Scene, endpoint_error, flow_error};
use crate::frame::{FlowField, Image, Plane, Size};
use crate::io::{flo, picture};
use crate::quantile::sorted;
use crate::report::{arrows, colour_wheel};

/// Frames that are streamed for the speed, beside the first.
const STREAMED: u32 = 20;
/// The endpoint error that is white in `error.png`, in pixels.
const WHITE_ERROR: f32 = 1.0;

/// Compute the flow of a made-up scene whose motion is known, and show it.
///
/// Writes frame_0.png, frame_1.png, flow.flo, color.png, truth.png (both to one scale), arrows.png, error.png (white is
/// 1 px or more) and confidence.png, and prints how accurate and how fast it was. Computes on any adapter there is, also on
/// one that computes on the CPU such as lavapipe; without one, on the CPU backend.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  viewsphere demo
  viewsphere demo -o /tmp/demo --size 1280x720 --preset accurate
  viewsphere demo --backend cpu --json")]
pub(super) struct Demo {
    /// Folder to write into; it is made if it is not there
    #[arg(short, long, value_name = "FOLDER", default_value = "demo")]
    output: PathBuf,
    /// Size of the frames
    #[arg(long, value_name = "WxH", default_value = "640x480")]
    size: Size,
    /// Print the figures as JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    flow: FlowArgs,
    #[command(flatten)]
    backend: BackendArgs,
}

#[derive(Serialize)]
struct Report {
    backend: String,
    width: u32,
    height: u32,
    accuracy: FlowErrorFigures,
    median_ms: f64,
    max_ms: f64,
    fps: f64,
    color_scale_px: f32,
    folder: PathBuf,
}

impl Demo {
    pub(super) fn run(&self) -> Result<Outcome> {
        let mut config = Config { algorithm: self.flow.algorithm()?, ..Config::default() };
        config.confidence = true;
        input::folder(&self.output)?;
        let mut engine = Engine::new(self.backend.open_for_shaders()?, self.size, &config)?;
        let scene = Scene::new(self.size)?;
        let pair = [scene.frame(0), scene.frame(1)];
        let truth = scene.flow(0);

        engine.process(&pair[0].frame()?)?;
        let computed = engine
            .process(&pair[1].frame()?)?
            .and_then(|output| Some((output.flow?.clone(), output.confidence?.clone())));
        let (flow, confidence) =
            computed.ok_or_else(|| Error::parameter("flow", "missing", "one for the second frame"))?;
        let error = flow_error(&truth, &flow, None)?;
        fs::create_dir_all(&self.output).map_err(|source| Error::io(&self.output, source))?;
        let scale = write(&self.output, &pair, &truth, &flow, &confidence)?;

        let mut times = Vec::new();
        for number in 2..2 + STREAMED {
            let image = scene.frame(number);
            let frame = image.frame()?;
            let start = std::time::Instant::now();
            engine.process(&frame)?;
            times.push(start.elapsed().as_secs_f64() * 1e3);
        }
        let times = sorted(times);
        let median = times[times.len() / 2];
        let report = Report {
            backend: engine.adapter(),
            width: self.size.width,
            height: self.size.height,
            accuracy: error.into(),
            median_ms: median,
            max_ms: times[times.len() - 1],
            fps: 1e3 / median,
            color_scale_px: scale,
            folder: self.output.clone(),
        };
        if self.json {
            print::json(&report)?;
        } else {
            print::text(&format!(
                "backend    {}\naccuracy   mean endpoint error {:.4} px, mean angular error {:.3}°, {:.2} % over 1 px\n\
                 speed      {:.2} ms a frame, {:.0} frames a second at {}\ncolours    {scale:.4} px in full colour\n\
                 pictures   in {}",
                report.backend,
                error.aee_px,
                error.aae_deg,
                100.0 * error.r1,
                report.median_ms,
                report.fps,
                self.size,
                self.output.display(),
            ))?;
        }
        Ok(Outcome::Done)
    }
}

/// Writes everything, and returns the scale of the colours.
fn write(
    folder: &Path,
    pair: &[Image; 2],
    truth: &FlowField,
    flow: &FlowField,
    confidence: &Plane,
) -> Result<f32> {
    let (truth_colours, scale) = colour_wheel(truth, None)?;
    let (colours, _) = colour_wheel(flow, Some(scale))?;
    let mut error = endpoint_error(truth, flow)?;
    error.data.iter_mut().for_each(|error| *error /= WHITE_ERROR);
    // Long enough to be seen, and not so long that they cross.
    let gain = 16.0 / scale;
    let drawn = arrows(&pair[0].frame()?, flow, 16, gain)?;
    for (name, image) in [
        ("frame_0.png", &pair[0]),
        ("frame_1.png", &pair[1]),
        ("color.png", &colours),
        ("truth.png", &truth_colours),
        ("arrows.png", &drawn),
        ("error.png", &gray(&error)),
        ("confidence.png", &gray(confidence)),
    ] {
        picture::write_png(folder.join(name), image)?;
    }
    flo::write(folder.join("flow.flo"), flow)?;
    Ok(scale)
}
