//! `viewsphere run`: from frames and a gyro to what will be met, where and when.

mod gyro;
mod horizon;
mod intake;
mod line;
mod summary;
mod times;
mod video;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::{ArgGroup, Args};

use self::gyro::{Feed, GyroArgs, Numbers};
use self::horizon::Horizon;
use self::intake::{Intake, Reader, Taken};
use self::line::{Line, Timing};
use self::summary::Summary;
use self::times::{Rate, Times};
use self::video::Video;
use super::backend::BackendArgs;
use super::flow::source::Source;
use super::flow_args::FlowArgs;
use super::{Outcome, input, print};
use crate::camera::{self, Camera, Lens};
use crate::error::{Error, Result};
use crate::frame::{Image, Size};
use crate::pipeline::{Cue, Pipeline, PipelineConfig};
use crate::sphere::{Alarm, Sphere};

/// Say what will be met, where and when: time to contact per sector of the view, frame by frame.
///
/// Inputs are pictures (PNG, JPEG, PGM, PPM), a numbered or globbed sequence, a .y4m video, or - for one on standard input.
/// The camera comes from a file of OpenCV, ROS (camera_info), Kalibr or EuRoC, or with --fov-deg is a pinhole without a
/// lens. Azimuth is positive to the right and elevation up, from the camera's axis.
///
/// A line a frame goes to standard output, the summary to standard error. A frame whose cue is not to be used says why and
/// the run goes on: the first one; one too long after the one before; one whose gyro samples are missing, are not numbers
/// or run backwards; one in which too little can be seen. Without --gyro the camera's turn stays in the flow.
///
/// With --json-lines a line is an object: frame, time_s, valid, invalid_kind and invalid (null, or first, interval, gyro,
/// coverage, lost, frozen, turn, and the reason), heading (azimuth_deg, elevation_deg, error_deg) or null, threat (azimuth_deg,
/// elevation_deg, time_s, sectors, alarm) or null, sectors (columns, rows, azimuth_deg from left to right, elevation_deg
/// from top to bottom, and in lists row by row ttc_s, null where nothing is known or comes nearer, and coverage 0 to 1),
/// timing (age_ms since the frame was there, latency_ms since it was submitted, dropped in all).
#[derive(Args, Debug)]
#[command(group(ArgGroup::new("view").args(["camera", "fov_deg"]).required(true)))]
#[command(after_help = "\
Examples:
  viewsphere run flight.y4m --camera cam.yaml --gyro gyro.csv
  viewsphere run 'cam0/data/*.png' --camera cam0.yaml \\
    --times cam0/data.csv --gyro imu0/data.csv --camera-from-gyro 0,1,0,-1,0,0,0,0,1
  viewsphere run flight.y4m --fov-deg 90 --json-lines | jq -c 'select(.threat.alarm) | [.time_s, .threat]'
  viewsphere run flight.y4m --fov-deg 90 --quiet --overlay out.y4m
  viewsphere run flight.y4m --fov-deg 90 --realtime --quiet --overlay - | ffplay -
  ffmpeg -i in.mp4 -f yuv4mpegpipe - | viewsphere run - --fov-deg 90
  ffmpeg -f v4l2 -i /dev/video0 -f yuv4mpegpipe - | viewsphere run - --camera cam.yaml --realtime")]
pub(super) struct Run {
    /// Pictures; or a sequence such as 'frames/%04d.png' or 'frames/*.png'; or a .y4m video; or - for standard input
    #[arg(required = true)]
    inputs: Vec<String>,
    /// The camera that took the frames
    #[arg(long, value_name = "FILE")]
    camera: Option<PathBuf>,
    /// In place of a camera file: a pinhole without a lens that sees this far from the left border to the right one
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    fov_deg: Option<f64>,
    /// Frames a second, such as 25 or 30000/1001 [default: the video's, else 30]
    #[arg(long, value_name = "RATE", conflicts_with = "times")]
    fps: Option<Rate>,
    /// The frames' times: EuRoC's `#timestamp [ns],filename`, or one in seconds a line
    #[arg(long, value_name = "FILE")]
    times: Option<PathBuf>,
    /// What is added to all frames' times, so that they are those of the gyro's log
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, default_value_t = 0.0)]
    start_s: f64,
    /// Columns and rows of sectors
    #[arg(long, value_name = "WxH", default_value = "24x9")]
    sectors: Size,
    /// What is met within this time is a threat, above 0 and at most 60; an alarm if it was one in the frame before too
    /// [default: 2]
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    within_s: Option<f64>,
    /// What is passed at less than this much flying time aside is met, 0 to 60: 0.4 is 2 m at 5 m/s. Low over a ground it
    /// is a threat too [default: 0.4]
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    aside_s: Option<f64>,
    /// How far each pixel of every frame is to be trusted: a picture (black 0, white 1) or a .npy plane of 0 to 1.
    /// About doubles the time: what it hides is left out of the flow too
    #[arg(long, value_name = "FILE")]
    mask: Option<PathBuf>,
    /// Print a JSON object a frame
    #[arg(long, conflicts_with_all = ["quiet", "json"])]
    json_lines: bool,
    /// Add to each sector ttc_early_s and ttc_late_s (between which most of it lies), nearness_rate_hz, divergence_hz and
    /// confidence
    #[arg(long, requires = "json_lines")]
    sector_detail: bool,
    /// Print nothing but the summary
    #[arg(long)]
    quiet: bool,
    /// Print nothing but the summary, as JSON on standard output
    #[arg(long)]
    json: bool,
    /// Write a video of the frames with what was made of them, to this .y4m or to standard output (-): the flow's colours,
    /// each sector's time to contact (red below 1 s, orange 2 s, yellow 4 s, green 8 s), the threat and its time, the
    /// direction of motion, with --level the horizon; a red border where the cue is invalid. Frames that --realtime drops
    /// are not in it
    #[arg(long, value_name = "FILE")]
    overlay: Option<PathBuf>,
    /// The camera's roll (right side down) and pitch (up) at the first frame, in degrees, for the overlay's horizon: the
    /// gyro carries it on, up to the first frame whose turn it does not tell
    #[arg(long, value_name = "ROLL,PITCH", allow_hyphen_values = true, requires_all = ["overlay", "gyro"])]
    level: Option<Numbers<2>>,
    /// Take frames as a camera would deliver them: those of files at their times, those of a stream as they come. Of those
    /// that come while one is computed the newest is kept, and the others are dropped and counted
    #[arg(long)]
    realtime: bool,
    /// Size of raw gray frames, one byte a pixel, on standard input
    #[arg(long, value_name = "WxH")]
    raw: Option<Size>,
    #[command(flatten)]
    gyro: GyroArgs,
    #[command(flatten)]
    flow: FlowArgs,
    #[command(flatten)]
    backend: BackendArgs,
}

impl Run {
    pub(super) fn run(&self) -> Result<Outcome> {
        if !self.start_s.is_finite() {
            return Err(Error::parameter("--start-s", self.start_s, "a finite time"));
        }
        let files = [&self.camera, &self.gyro.gyro, &self.times, &self.mask].into_iter().flatten();
        let read = self.inputs.iter().map(Path::new).chain(files.map(PathBuf::as_path));
        input::spared("--overlay", self.overlay.as_deref().filter(|path| !path.is_dir()), read)?;
        let lines = self.json || !self.quiet;
        let target = self.overlay.as_ref().map(|path| video::target(path, lines)).transpose()?;
        let horizon = Horizon::new(self.level)?;
        let PipelineConfig { alarm, .. } = PipelineConfig::default();
        let mut config = PipelineConfig {
            algorithm: self.flow.algorithm()?,
            read_flow: target.is_some(),
            sphere: Sphere {
                derotation: self.gyro.derotation(),
                sectors: [self.sectors.width, self.sectors.height],
                ..Sphere::default()
            },
            gyro: self.gyro.config()?,
            alarm: Alarm {
                within_s: self.within_s.unwrap_or(alarm.within_s),
                aside_s: self.aside_s.unwrap_or(alarm.aside_s),
                ..alarm
            },
            ..PipelineConfig::default()
        };
        config.validate()?;
        let file = self.camera.as_ref().map(|path| Ok((path, camera::read(path)?))).transpose()?;
        let feed = self.gyro.feed()?;
        let source = Source::open(&self.inputs, self.raw)?;
        let times = self.times(&source)?;
        let mut reader = Reader::new(source, times);
        let mut first = Taken::default();
        if !reader.next(&mut first)? {
            return Err(Error::format(reader.name(), "number of frames", 0, "at least 1"));
        }
        let Image { size, format, .. } = first.image;
        let name = reader.name();
        let camera = match file {
            Some((path, camera)) => {
                input::same_size(&name, size, camera.size, path)?;
                camera
            }
            None => self.pinhole(size)?,
        };
        config.format = format;
        config.mask = self.mask.as_ref().map(|path| input::plane(path, size, &name)).transpose()?;
        // What the mask hides must not be seen in the flow beside it.
        config.certainty = config.mask.is_some();
        let pipeline = Pipeline::new(self.backend.open_unless(self.quiet)?, &camera, &config)?;
        // What it took to get ready is not the frame's age.
        first.there = Instant::now();
        let (ideal, rate) = (*pipeline.ideal(), reader.rate().fraction());
        let intake = match self.realtime {
            true => Intake::newest(reader, &first, self.inputs == ["-"]),
            false => Intake::Each(Box::new(reader)),
        };
        let mut flight = Flight { summary: Summary::new(pipeline.adapter()), pipeline, feed, intake };
        let mut end = Ok(());
        let written = match target {
            None => {
                end = self.frames(&mut flight, first, None);
                Ok(())
            }
            Some(place) => video::write(&place, |out| {
                let mut video = Video::new(out, &place, [&camera, &ideal], rate, horizon)?;
                // What was processed is shown, also where the source fails after it.
                end = self.frames(&mut flight, first, Some(&mut video));
                video.finish()
            }),
        };
        let Flight { summary, pipeline, intake, .. } = &mut flight;
        summary.finish(pipeline.latency(), intake.dropped());
        summary.print(self.json)?;
        end.and(written).map(|()| Outcome::Done)
    }

    /// Frames until the source ends or fails.
    fn frames(&self, flight: &mut Flight, mut taken: Taken, mut video: Option<&mut Video<'_>>) -> Result<()> {
        loop {
            let dropped = flight.intake.dropped();
            flight.feed.push_until(&mut flight.pipeline, taken.time_s);
            let cue = flight.pipeline.process(&taken.image.frame()?, taken.time_s)?;
            let milliseconds = |time: Duration| 1e3 * time.as_secs_f64();
            let timing = Timing {
                age_ms: milliseconds(taken.there.elapsed()),
                latency_ms: milliseconds(cue.latency),
                dropped,
            };
            flight.summary.add(cue.invalid, cue.threat.is_some_and(|threat| threat.alarm));
            let read = self.say(taken.number, &cue, timing)?;
            let seen = video.as_mut().is_none_or(|video| video.add(&taken, &cue));
            if !(read && seen && flight.intake.next(&mut taken)?) {
                return Ok(());
            }
        }
    }

    /// Says what there is to say of a frame. Returns false if nobody listens any more.
    fn say(&self, number: u64, cue: &Cue<'_>, timing: Timing) -> Result<bool> {
        if self.quiet || self.json {
            return Ok(true);
        }
        let mut text = match self.json_lines {
            true => print::one_line(&Line::new(number, cue, timing, self.sector_detail))?,
            false => line::text(number, cue),
        };
        text.push('\n');
        print::offer(text.as_bytes())
    }

    fn times(&self, source: &Source) -> Result<Times> {
        if let Some(path) = &self.times {
            return Times::read(path, source.len(), self.start_s);
        }
        let rate = self.fps.or_else(|| source.rate().map(Rate::of_fraction));
        Ok(Times::even(rate.unwrap_or(Rate::DEFAULT), self.start_s))
    }

    /// A camera without a lens, with square pixels and its axis through the middle.
    fn pinhole(&self, size: Size) -> Result<Camera> {
        let fov_deg = self.fov_deg.unwrap_or(f64::NAN);
        if !(1.0..=170.0).contains(&fov_deg) {
            return Err(Error::parameter("--fov-deg", fov_deg, "1 to 170"));
        }
        let f = 0.5 * f64::from(size.width) / (0.5 * fov_deg.to_radians()).tan();
        let middle = |side: u32| 0.5 * (f64::from(side) - 1.0);
        let (u_0, v_0) = (middle(size.width), middle(size.height));
        Ok(Camera { size, f_u: f, f_v: f, u_0, v_0, lens: Lens::NONE })
    }
}

/// What a run goes on with.
struct Flight {
    pipeline: Pipeline,
    feed: Feed,
    intake: Intake,
    summary: Summary,
}
