//! `viewsphere flow`: the flow between two images, or along a sequence or video.

mod report;
pub(super) mod source;
mod targets;

use std::path::{Path, PathBuf};

use clap::Args;

use self::report::Report;
use self::source::Source;
pub(super) use self::targets::gray;
use self::targets::{FormatArg, Pair, Targets};
use super::backend::BackendArgs;
use super::flow_args::FlowArgs;
use super::progress::Progress;
use super::{Outcome, input, print};
use crate::engine::{Config, Engine, FrameInputs};
use crate::error::{Error, Result};
use crate::frame::{FlowField, Image, Plane, Size};
use crate::io::read_flow;

/// Compute the flow between two images, or along a sequence or video.
///
/// Inputs are two images (PNG, JPEG, PGM, PPM), a numbered or globbed sequence, a .y4m video, or - for one on
/// standard input. For two images -o, --color, --arrows and --confidence name files; for everything else folders, in
/// which file 000000 holds the flow from the first frame to the second. If none is given, a summary is printed.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  viewsphere flow a.png b.png                        only a summary
  viewsphere flow a.png b.png -o flow.flo --color flow.png
  viewsphere flow a.png b.png -o - > flow.flo
  viewsphere flow 'frames/%04d.png' -o flows/ --color colours/ --warm-start
  viewsphere flow a.png b.png c.png -o flows/ --algorithm farneback-tv --preset accurate --third-frame 0.5
  viewsphere flow video.y4m -o flows/ --format kitti --backend gpu
  ffmpeg -i in.mp4 -pix_fmt yuv420p -f yuv4mpegpipe - | viewsphere flow - -o flows/
  ffmpeg -i in.mp4 -f rawvideo -pix_fmt gray - | viewsphere flow - --raw 640x480 -o flows/")]
pub(super) struct Flow {
    /// Two images; or a sequence such as 'frames/%04d.png' or 'frames/*.png'; or a .y4m video; or - for standard
    /// input
    #[arg(required = true)]
    inputs: Vec<String>,
    /// Write the flow to this file (.flo, .png for KITTI, .npy) or into this folder; - is standard output
    #[arg(short, long, value_name = "PATH")]
    output: Option<PathBuf>,
    /// Format of the flow [default: by the file's extension; .flo in a folder]
    #[arg(long, value_enum)]
    format: Option<FormatArg>,
    /// Write the flow as a colour image to this .png or into this folder
    #[arg(long, value_name = "PATH")]
    color: Option<PathBuf>,
    /// Displacement in pixels shown in full colour [default: the longest one of the first pair]
    #[arg(long, value_name = "PX", allow_negative_numbers = true, requires = "color")]
    scale: Option<f32>,
    /// Write the first frame with arrows over it to this .png or into this folder
    #[arg(long, value_name = "PATH")]
    arrows: Option<PathBuf>,
    /// Length of an arrow per length of its displacement
    #[arg(
        long,
        value_name = "FACTOR",
        default_value_t = 1.0,
        allow_negative_numbers = true,
        requires = "arrows"
    )]
    arrow_gain: f32,
    /// Write the flow's confidence per pixel, 0 to 1, to this .npy or .png or into this folder (as .npy)
    #[arg(long, value_name = "PATH")]
    confidence: Option<PathBuf>,
    /// Initial flow for the first pair's search
    #[arg(long, value_name = "FILE")]
    init: Option<PathBuf>,
    /// Certainty of each pixel in every frame: an image (black 0, white 1) or a .npy plane of 0 to 1
    #[arg(long, value_name = "FILE")]
    mask: Option<PathBuf>,
    /// Start each pair's search from the previous pair's flow
    #[arg(long)]
    warm_start: bool,
    /// Size of raw gray frames, one byte per pixel, on standard input
    #[arg(long, value_name = "WxH")]
    raw: Option<Size>,
    /// Print no progress and no notes
    #[arg(long)]
    quiet: bool,
    /// Print the summary as JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    flow: FlowArgs,
    #[command(flatten)]
    backend: BackendArgs,
}

/// The frames that are read before the first pair is computed.
struct Begin {
    images: [Image; 2],
    /// The third one, where the algorithm needs three.
    third: Option<Image>,
}

/// The inputs beside the frames.
struct Given {
    mask: Option<Plane>,
    init: Option<FlowField>,
}

impl Flow {
    pub(super) fn run(&self) -> Result<Outcome> {
        let algorithm = self.flow.algorithm()?;
        let mut source = Source::open(&self.inputs, self.raw)?;
        let single = self.inputs.len() == 2 && source.len() == Some(2);
        self.check(single)?;
        let frames = algorithm.frames();
        if source.len() == Some(2) && frames == 2 && algorithm.has_memory() && !self.quiet {
            print::note(print::alone(algorithm.name()));
        }
        let targets = Targets::new(self, single)?;
        let images = source.first_two()?;
        let third = if frames > 2 { Some(source.third()?) } else { None };
        let (size, first) = (images[0].size, &self.inputs[0]);
        let given = Given {
            mask: self.mask.as_ref().map(|path| input::plane(path, size, first.as_ref())).transpose()?,
            init: self.init.as_ref().map(|path| initial(path, size, first.as_ref())).transpose()?,
        };
        let config = Config {
            algorithm,
            format: images[0].format,
            certainty: self.mask.is_some(),
            confidence: self.confidence.is_some(),
            initial_flow: self.init.is_some(),
            warm_start: self.warm_start,
            ..Config::default()
        };
        let mut engine = Engine::new(self.backend.open(self.quiet)?, size, &config)?;
        let pairs = source.len().map(|frames| frames.saturating_sub(1));
        let progress = Progress::of_sequence(pairs, "pairs", 1, self.quiet);
        let done = compute(&mut engine, source, Begin { images, third }, given, targets, &progress);
        progress.finish();
        let report = done?;
        if frames > 2 && !self.quiet {
            print::note("the first pair has no older frame: its flow is that of two frames");
        }
        if !self.writes_to_stdout() {
            report.print(self.json, self.outputs().iter().all(|path| path.is_none()))?;
        }
        Ok(Outcome::Done)
    }

    fn outputs(&self) -> [&Option<PathBuf>; 4] {
        [&self.output, &self.color, &self.arrows, &self.confidence]
    }

    fn writes_to_stdout(&self) -> bool {
        self.outputs().iter().any(|path| path.as_deref() == Some(Path::new("-")))
    }

    /// Checks what would otherwise fail only after the first pair, or pass unnoticed.
    fn check(&self, single: bool) -> Result<()> {
        for (name, value) in [("--scale", self.scale), ("--arrow-gain", Some(self.arrow_gain))] {
            if let Some(value) = value.filter(|value| !(value.is_finite() && *value > 0.0)) {
                return Err(Error::parameter(name, value, "a finite number over 0"));
            }
        }
        if self.json && self.writes_to_stdout() {
            let expected = "none where results go to standard output";
            return Err(Error::parameter("--json", "given", expected));
        }
        if single && self.warm_start {
            return Err(Error::parameter("--warm-start", "given", "a sequence of frames, not two pictures"));
        }
        if !single && self.init.is_some() && !self.warm_start {
            let expected = "--warm-start with it in a sequence, as it is for the first pair only";
            return Err(Error::parameter("--init", "given", expected));
        }
        Ok(())
    }
}

fn compute(
    engine: &mut Engine,
    mut source: Source,
    begin: Begin,
    given: Given,
    mut targets: Targets,
    progress: &Progress,
) -> Result<Report> {
    let Begin { images: [mut first, mut second], mut third } = begin;
    let mut report = Report::new(engine.adapter(), first.size);
    let certainty = given.mask.as_ref();
    let mut initial_flow = given.init.as_ref();
    engine.process_with(&first.frame()?, &FrameInputs { certainty, ..FrameInputs::default() })?;
    targets.make_folders()?;
    loop {
        let output = engine.process_with(&second.frame()?, &FrameInputs { certainty, initial_flow })?;
        if let Some((flow, output)) = output.and_then(|output| Some((output.flow?, output))) {
            targets.write(report.pairs, &Pair { first: &first, flow, confidence: output.confidence })?;
            report.add(flow);
        }
        progress.inc();
        initial_flow = None;
        std::mem::swap(&mut first, &mut second);
        match third.take() {
            Some(image) => second = image,
            None if source.next(&mut second)? => {}
            None => break,
        }
    }
    report.finish(engine.latency(), targets.scale());
    Ok(report)
}

fn initial(path: &Path, size: Size, first: &Path) -> Result<FlowField> {
    let flow = read_flow(path)?;
    input::same_size(path, flow.size, size, first)?;
    Ok(flow)
}
