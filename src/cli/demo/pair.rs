//! The demo's pair: its flow, the error, and the frame rate.

use std::path::Path;

use crate::backend::Backend;
use crate::engine::{Config, Engine};
use crate::error::{Error, Result};
use crate::eval::{Scene, endpoint_error, flow_error};
use crate::flow::Algorithm;
use crate::frame::{FlowField, Image, Size};
use crate::io::{flo, picture};
use crate::quantile::{median, sorted};
use crate::report::{DemoPair, arrows, colour_wheel};

use crate::cli::flow::gray;

/// Frames streamed to measure the frame rate, beside the first two.
const STREAMED: u32 = 20;
/// The endpoint error that is white in `error.png`, in pixels.
const WHITE_ERROR: f32 = 1.0;

/// The pair as the page shows it, and the parts that are only written to files.
pub(super) struct Pair {
    pub(super) shown: DemoPair,
    flow: FlowField,
    confidence: Image,
}

impl Pair {
    /// The names of its files.
    pub(super) const FILES: [&str; 8] = [
        "frame_0.png",
        "frame_1.png",
        "color.png",
        "truth.png",
        "arrows.png",
        "error.png",
        "confidence.png",
        "flow.flo",
    ];

    pub(super) fn compute(backend: Backend, size: Size, algorithm: Algorithm) -> Result<Self> {
        let config = Config { algorithm, confidence: true, ..Config::default() };
        let mut engine = Engine::new(backend, size, &config)?;
        let scene = Scene::new(size)?;
        let frames = [scene.frame(0), scene.frame(1)];
        let truth = scene.flow(0);
        engine.process(&frames[0].frame()?)?;
        let computed = engine
            .process(&frames[1].frame()?)?
            .and_then(|output| Some((output.flow?.clone(), output.confidence?.clone())));
        let (flow, confidence) =
            computed.ok_or_else(|| Error::parameter("flow", "missing", "one for the second frame"))?;
        let (truth_colours, scale_px) = colour_wheel(&truth, None)?;
        let (colours, _) = colour_wheel(&flow, Some(scale_px))?;
        let mut error = endpoint_error(&truth, &flow)?;
        error.data.iter_mut().for_each(|error| *error /= WHITE_ERROR);
        // Long enough to be visible, and short enough not to cross.
        let arrows = arrows(&frames[0].frame()?, &flow, 16, 16.0 / scale_px)?;
        let frame_ms = stream(&mut engine, &scene)?;
        let shown = DemoPair {
            frames,
            arrows,
            flow: colours,
            truth: truth_colours,
            scale_px,
            error: gray(&error),
            white_px: WHITE_ERROR,
            accuracy: flow_error(&truth, &flow, None)?,
            adapter: engine.adapter(),
            frame_ms,
        };
        Ok(Self { shown, flow, confidence: gray(&confidence) })
    }

    pub(super) fn write(&self, folder: &Path) -> Result<()> {
        let DemoPair { frames, arrows, flow, truth, error, .. } = &self.shown;
        let images = [&frames[0], &frames[1], flow, truth, arrows, error, &self.confidence];
        let [pictures @ .., field] = Self::FILES;
        for (name, image) in pictures.into_iter().zip(images) {
            picture::write_png(folder.join(name), image)?;
        }
        flo::write(folder.join(field), &self.flow)
    }
}

/// The time per frame in a stream: median and longest, milliseconds.
fn stream(engine: &mut Engine, scene: &Scene) -> Result<[f64; 2]> {
    let mut times_ms = Vec::new();
    for number in 2..2 + STREAMED {
        let image = scene.frame(number);
        let frame = image.frame()?;
        let start = std::time::Instant::now();
        engine.process(&frame)?;
        times_ms.push(start.elapsed().as_secs_f64() * 1e3);
    }
    let times_ms = sorted(times_ms);
    let median_ms = median(times_ms.iter().copied()).unwrap_or(f64::NAN);
    Ok([median_ms, times_ms.last().copied().unwrap_or(f64::NAN)])
}
