//! `viewsphere demo`: the flow of a synthetic pair, and a simulated flight steered by flow.

mod flight;
mod pair;

use std::fs::File;
use std::io::Read;
use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use self::flight::{Flown, Plan};
use self::pair::Pair;
use super::args::whole;
use super::backend::BackendArgs;
use super::eval::FlowErrorFigures;
use super::flow_args::FlowArgs;
use super::fly::timing::Timing;
use super::{Outcome, input, paths, print};
use crate::error::{Error, Result};
use crate::frame::Size;
use crate::io::write_bytes;
use crate::report::{DemoReport, GENERATOR};
use crate::sim::CourseKind;
use crate::sim::flight::{FRAME_S, FlightConfig};

/// Show flow, time to contact and steering on one page.
///
/// Computes the flow of a synthetic pair and compares it with the known motion; then flies through a simulated world,
/// whose obstacles it sees only by the flow of its camera's images and a gyro. Steering also gets airspeed, attitude and
/// altitude. Both are shown on one self-contained page, index.html: open it in a browser. The last line of output is
/// its path.
///
/// Computes on any adapter, also on a software adapter such as lavapipe; without one, on the CPU backend. If a software
/// adapter is too slow for the flight and was not asked for, the CPU backend flies; page and output say so.
///
/// Beside the page are the pair's frame_0.png, frame_1.png, flow.flo, color.png and truth.png (both on one scale),
/// arrows.png, error.png (white is 1 px or more) and confidence.png.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  viewsphere demo
  viewsphere demo -o /tmp/demo --world forest --seed 7
  viewsphere demo --seconds 20 --world corridor
  viewsphere demo --size 1280x720 --preset accurate
  viewsphere demo --backend cpu --json")]
pub(super) struct Demo {
    /// Folder to write into, created if missing. Files of an earlier demo are replaced, other files of these names are
    /// not
    #[arg(short, long, value_name = "FOLDER", default_value = "demo")]
    output: PathBuf,
    /// Image size of the pair
    #[arg(long, value_name = "WxH", default_value = "640x480")]
    size: Size,
    /// World to fly through, with its parameters (see `viewsphere fly --help`)
    #[arg(long, value_name = "WORLD[:PARAMETER=VALUE]...", default_value = "city")]
    world: CourseKind,
    /// Seed of the world
    #[arg(long, value_name = "N", default_value_t = 4, allow_negative_numbers = true, value_parser = whole::<u64>)]
    seed: u64,
    /// Duration of the flight, 0.1 to 120 s; it may end earlier
    #[arg(long, value_name = "SECONDS", default_value_t = 10.0, allow_negative_numbers = true)]
    seconds: f64,
    /// Print no progress and no notes
    #[arg(long)]
    quiet: bool,
    /// Print the figures as JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    flow: FlowArgs,
    #[command(flatten)]
    backend: BackendArgs,
}

const PAGE: &str = "index.html";
/// The generator is named within this many bytes from the beginning of the page.
const HEAD: u64 = 1024;

#[derive(Serialize)]
struct Report<'a> {
    backend: &'a str,
    width: u32,
    height: u32,
    accuracy: FlowErrorFigures,
    median_ms: f64,
    max_ms: f64,
    fps: f64,
    color_scale_px: f32,
    flight: FlightFigures<'a>,
    folder: PathBuf,
    page: PathBuf,
}

#[derive(Serialize)]
struct FlightFigures<'a> {
    backend: &'a str,
    /// Why it differs from the pair's backend; `null` if it does not.
    why: Option<&'a str>,
    world: &'a str,
    seed: u64,
    time_s: f64,
    /// How the flight ended; `null` if it was still flying.
    outcome: Option<&'static str>,
    least_clearance_m: f64,
    timing: Timing,
}

impl Demo {
    pub(super) fn run(&self) -> Result<Outcome> {
        let flow = self.flow.algorithm()?;
        if !(0.1..=120.0).contains(&self.seconds) {
            return Err(Error::parameter("--seconds", self.seconds, "0.1 to 120"));
        }
        let course = self.world.course(self.seed)?;
        let mut config = FlightConfig::default();
        // The flow is read back for the page only.
        config.pipeline.read_flow = true;
        config.pipeline.algorithm = self.flow.algorithm_or(&config.pipeline.algorithm)?;
        input::folder(&self.output)?;
        self.spare()?;
        let backend = self.backend.open_for_shaders(self.quiet)?;
        if !self.quiet {
            print::note(format_args!("the flow of a pair of {}", self.size));
        }
        if flow.has_memory() && !self.quiet {
            print::note(print::alone(flow.name()));
        }
        let pair = Pair::compute(backend.clone(), self.size, flow)?;
        let plan = Plan {
            course: &course,
            config: &config,
            frames: (self.seconds / FRAME_S).round() as u64,
            quiet: self.quiet,
        };
        let flown = plan.fly(&backend, &pair.shown.adapter, self.backend.is_free())?;
        let page = DemoReport { pair: &pair.shown, flight: flown.report(&course, &config) }.html()?;
        input::within(&self.output, || {
            // The page comes first, as it marks the folder's files as those of a demo.
            write_bytes(self.output.join(PAGE), page.as_bytes())?;
            pair.write(&self.output)
        })?;
        self.tell(&pair, &flown, &course.name)?;
        Ok(Outcome::Done)
    }

    /// Checks that files to be replaced belong to an earlier demo.
    fn spare(&self) -> Result<()> {
        let mut head = Vec::new();
        let page = File::open(self.output.join(PAGE));
        let read = page.and_then(|page| page.take(HEAD).read_to_end(&mut head));
        let made = read.is_ok() && String::from_utf8_lossy(&head).contains(GENERATOR);
        let names: Vec<&str> = [PAGE].into_iter().chain(Pair::FILES).collect();
        paths::of_an_earlier_run(&self.output, &names, made, "the index.html of an earlier demo")
    }

    fn tell(&self, pair: &Pair, flown: &Flown, world: &str) -> Result<()> {
        let (shown, page) = (&pair.shown, self.output.join(PAGE));
        let [median_ms, max_ms] = shown.frame_ms;
        let (timing, fps) = (flown.timing(), 1e3 / median_ms);
        if self.json {
            return print::json(&Report {
                backend: &shown.adapter,
                width: self.size.width,
                height: self.size.height,
                accuracy: shown.accuracy.into(),
                median_ms,
                max_ms,
                fps,
                color_scale_px: shown.scale_px,
                flight: FlightFigures {
                    backend: &flown.adapter,
                    why: flown.why.as_deref(),
                    world,
                    seed: self.seed,
                    time_s: flown.time_s(),
                    outcome: flown.outcome.map(|outcome| outcome.name()),
                    least_clearance_m: flown.least_clearance_m(),
                    timing,
                },
                folder: self.output.clone(),
                page,
            });
        }
        let e = &shown.accuracy;
        let ended = flown.outcome.map_or("still flying".to_owned(), |outcome| outcome.to_string());
        let mut text = format!(
            "backend    {}\n\
             accuracy   mean endpoint error {:.4} px, mean angular error {:.3}°, {:.2} % over 1 px\n\
             speed      median {median_ms:.2} ms per frame, {fps:.0} frames per second at {}\n\
             colours    {:.4} px in full colour\n\
             flight     {world}, seed {}: {ended} after {:.1} s, least clearance {:.2} m\n\
             on         {}\n\
             parts      {}\n\
             frames     {}\n",
            shown.adapter,
            e.aee_px,
            e.aae_deg,
            100.0 * e.r1,
            self.size,
            shown.scale_px,
            self.seed,
            flown.time_s(),
            flown.least_clearance_m(),
            flown.adapter,
            timing.parts(),
            timing.text(),
        );
        if let Some(why) = &flown.why {
            text += &format!("why        {why}\n");
        }
        text += &format!("images     in {}\n{}", self.output.display(), page.display());
        print::text(&text)
    }
}
