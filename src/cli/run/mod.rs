//! `viewsphere run`: time to contact per sector of the view, from frames and a gyro.

mod gyro;
mod horizon;
mod summary;
mod text;
mod video;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::{ArgGroup, Args, ValueEnum};

use self::gyro::{GyroArgs, Numbers};
use self::horizon::Horizon;
use self::summary::RunSummary;
use self::video::Video;
use super::args::named_by_flags;
use super::backend::BackendArgs;
use super::flow::source::Source;
use super::flow_args::FlowArgs;
use super::{Outcome, input, print};
use crate::camera::{Camera, Lens};
use crate::error::{Error, Result};
use crate::frame::{Image, Size};
use crate::io::{self, frame_times};
use crate::live::{FrameRate, FrameTimes, GyroFeed, Intake, Pace, TimedFrame, TimedFrames};
use crate::pipeline::{Cue, Pipeline, PipelineConfig};
use crate::sphere::{Alarm, HeadingModel, Sphere};
use crate::wire::{CueMessage, Timing};

/// Report what will be hit, where and when: the time to contact per sector of the view, frame by frame.
///
/// Inputs are images (PNG, JPEG, PGM, PPM), a numbered or globbed sequence, a .y4m video, or - for one on standard
/// input. The camera comes from a file of OpenCV, ROS (camera_info), Kalibr or EuRoC, or with --fov-deg is a pinhole
/// without distortion. Azimuth is positive to the right and elevation up, from the camera's axis.
///
/// One line per frame goes to standard output, the summary to standard error. A frame without a valid cue reports the
/// reason, and the run goes on: the first frame; one too long after the previous one; one whose gyro samples are
/// missing, not finite or out of order; one that shows too little. Without --gyro the camera's rotation stays in the
/// flow.
///
/// With --json-lines each line is an object: frame, time_s, valid, invalid_kind and invalid (null, or first,
/// interval, gyro, coverage, lost, frozen, turn, and the reason), heading (azimuth_deg, elevation_deg, error_deg) or
/// null, threat (azimuth_deg, elevation_deg, time_s, sectors, alarm) or null, sectors (columns, rows, azimuth_deg
/// from left to right, elevation_deg from top to bottom, and as row-major lists ttc_s, null where nothing is known or
/// nothing approaches, and coverage 0 to 1), timing (age_ms since the frame arrived, latency_ms since it was
/// submitted, dropped in total).
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
  ffmpeg -i in.mp4 -pix_fmt yuv420p -f yuv4mpegpipe - | viewsphere run - --fov-deg 90
  ffmpeg -f v4l2 -i /dev/video0 -f yuv4mpegpipe - | viewsphere run - --camera cam.yaml --realtime")]
pub(super) struct Run {
    /// Images; or a sequence such as 'frames/%04d.png' or 'frames/*.png'; or a .y4m video; or - for standard input
    #[arg(required = true)]
    inputs: Vec<String>,
    /// Camera file: the camera that took the frames
    #[arg(long, value_name = "FILE")]
    camera: Option<PathBuf>,
    /// Instead of a camera file: the horizontal field of view of a pinhole without distortion, in degrees
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    fov_deg: Option<f64>,
    /// Frame rate in Hz, such as 25 or 30000/1001 [default: the video's, else 30]
    #[arg(long, value_name = "RATE", conflicts_with = "times")]
    fps: Option<FrameRate>,
    /// Times of the frames: EuRoC's `#timestamp [ns],filename`, or one per line in seconds
    #[arg(long, value_name = "FILE")]
    times: Option<PathBuf>,
    /// How the direction of motion is carried from frame to frame
    #[arg(long, value_enum, default_value_t = HeadingArg::Straight)]
    heading: HeadingArg,
    /// Added to all frame times, so that they match those of the gyro's log, in seconds
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, default_value_t = 0.0)]
    start_s: f64,
    /// Sectors of the view, columns × rows
    #[arg(long, value_name = "WxH", default_value = "24x9")]
    sectors: Size,
    /// A sector with a shorter time to contact is a threat, above 0 and at most 60 s; an alarm if the previous frame
    /// had one too [default: 2]
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    within_s: Option<f64>,
    /// What passes at less than this much flying time to the side counts as hit, 0 to 60 s: 0.4 is 2 m at 5 m/s. In
    /// low flight the ground is then a threat too [default: 0.4]
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    aside_s: Option<f64>,
    /// Certainty of each pixel in every frame: an image (black 0, white 1) or a .npy plane of 0 to 1. About doubles
    /// the computing time, as masked pixels are left out of the flow estimate too
    #[arg(long, value_name = "FILE")]
    mask: Option<PathBuf>,
    /// Print one JSON object per frame
    #[arg(long, conflicts_with_all = ["quiet", "json"])]
    json_lines: bool,
    /// Add to each sector ttc_early_s and ttc_late_s (the range that holds most of it), nearness_rate_hz,
    /// divergence_hz and confidence
    #[arg(long, requires = "json_lines")]
    sector_detail: bool,
    /// Print only the summary
    #[arg(long)]
    quiet: bool,
    /// Print only the summary, as JSON on standard output
    #[arg(long)]
    json: bool,
    /// Write a video of the frames and their results to this .y4m or to standard output (-): the flow in colours,
    /// each sector's time to contact (red below 1 s, orange 2 s, yellow 4 s, green 8 s), the threat and its time, the
    /// direction of motion, with --level the horizon; a red border where the cue is invalid. Frames dropped by
    /// --realtime are left out
    #[arg(long, value_name = "FILE")]
    overlay: Option<PathBuf>,
    /// The camera's roll (right side down) and pitch (up) at the first frame, in degrees, for the overlay's horizon.
    /// The gyro keeps it up to date until the first frame whose rotation is unknown
    #[arg(long, value_name = "ROLL,PITCH", allow_hyphen_values = true, requires_all = ["overlay", "gyro"])]
    level: Option<Numbers<2>>,
    /// Deliver frames as a live camera would: those of files at their times, those of a stream as they arrive. Of the
    /// frames that arrive during a computation the newest is kept; the others are dropped and counted
    #[arg(long)]
    realtime: bool,
    /// Size of raw gray frames, one byte per pixel, on standard input
    #[arg(long, value_name = "WxH")]
    raw: Option<Size>,
    #[command(flatten)]
    gyro: GyroArgs,
    #[command(flatten)]
    flow: FlowArgs,
    #[command(flatten)]
    backend: BackendArgs,
}

/// The flags by the parameters that they set.
const FLAGS: [(&str, &str); 6] = [
    ("within_s", "--within-s"),
    ("aside_s", "--aside-s"),
    ("sectors", "--sectors"),
    ("camera_from_gyro", "--camera-from-gyro"),
    ("bias_rad_s", "--gyro-bias"),
    ("time_offset_s", "--gyro-offset-s"),
];

impl Run {
    pub(super) fn run(&self) -> Result<Outcome> {
        if !self.start_s.is_finite() {
            return Err(Error::parameter("--start-s", self.start_s, "a finite time"));
        }
        let files = [&self.camera, &self.gyro.gyro, &self.times, &self.mask].into_iter().flatten();
        let read = self.inputs.iter().map(Path::new).chain(files.map(PathBuf::as_path));
        let lines = self.json || !self.quiet;
        let target = self.overlay.as_ref().map(|path| video::target(path, lines, read)).transpose()?;
        let horizon = Horizon::new(self.level)?;
        let PipelineConfig { alarm, .. } = PipelineConfig::default();
        let mut config = PipelineConfig {
            algorithm: self.flow.algorithm()?,
            read_flow: target.is_some(),
            sphere: Sphere {
                derotation: self.gyro.derotation(),
                sectors: [self.sectors.width, self.sectors.height],
                heading: self.heading.into(),
                ..Sphere::default()
            },
            gyro: self.gyro.config().map_err(|error| named_by_flags(error, &FLAGS))?,
            alarm: Alarm {
                within_s: self.within_s.unwrap_or(alarm.within_s),
                aside_s: self.aside_s.unwrap_or(alarm.aside_s),
                ..alarm
            },
            ..PipelineConfig::default()
        };
        config.validate().map_err(|error| named_by_flags(error, &FLAGS))?;
        let file = self.camera.as_ref().map(|path| Ok((path, io::camera::read(path)?))).transpose()?;
        let feed = self.gyro.feed()?;
        let source = Source::open(&self.inputs, self.raw)?;
        let times = self.times(&source)?;
        let mut frames = TimedFrames::new(source, times);
        let mut first = TimedFrame::default();
        if !frames.next_frame(&mut first)? {
            return Err(Error::format(frames.source().name(), "number of frames", 0, "at least 1"));
        }
        let Image { size, format, .. } = first.image;
        let name = frames.source().name();
        let camera = match file {
            Some((path, camera)) => {
                input::same_size(&name, size, camera.size, path)?;
                camera
            }
            None => self.pinhole(size)?,
        };
        config.format = format;
        config.mask = self.mask.as_ref().map(|path| input::plane(path, size, &name)).transpose()?;
        // Masked pixels must not affect the flow beside the mask.
        config.certainty = config.mask.is_some();
        let pipeline = Pipeline::new(self.backend.open(self.quiet)?, &camera, &config)?;
        // The start-up time is not part of the first frame's age.
        first.arrived = Instant::now();
        let (ideal, rate) = (*pipeline.ideal(), frames.times().rate().fraction());
        let intake = match self.realtime {
            true if self.inputs == ["-"] => Intake::latest(frames, &first, Pace::Source),
            true => Intake::latest(frames, &first, Pace::Times),
            false => Intake::each(frames),
        };
        let mut session = Session { summary: RunSummary::new(pipeline.adapter()), pipeline, feed, intake };
        let mut end = Ok(());
        let written = match target {
            None => {
                end = self.frames(&mut session, first, None);
                Ok(())
            }
            Some(place) => video::write(&place, |out| {
                let mut video = Video::new(out, &place, [&camera, &ideal], rate, horizon)?;
                // Show the frames processed, even if the source fails after them.
                end = self.frames(&mut session, first, Some(&mut video));
                video.finish()
            }),
        };
        let Session { summary, pipeline, intake, .. } = &mut session;
        summary.finish(pipeline.latency(), intake.dropped());
        summary.print(self.json)?;
        end.and(written).map(|()| Outcome::Done)
    }

    /// Processes frames until the source ends or fails.
    fn frames(
        &self,
        session: &mut Session,
        mut taken: TimedFrame,
        mut video: Option<&mut Video<'_>>,
    ) -> Result<()> {
        loop {
            let dropped = session.intake.dropped();
            for sample in session.feed.until(taken.time_s) {
                session.pipeline.push_gyro(*sample);
            }
            let cue = session.pipeline.process(&taken.image.frame()?, taken.time_s)?;
            let milliseconds = |time: Duration| 1e3 * time.as_secs_f64();
            let timing = Timing {
                age_ms: milliseconds(taken.arrived.elapsed()),
                latency_ms: milliseconds(cue.latency),
                dropped,
            };
            session.summary.add(cue.invalid, cue.threat.is_some_and(|threat| threat.alarm));
            let read = self.say(taken.number, &cue, timing)?;
            let seen = video.as_mut().is_none_or(|video| video.add(&taken, &cue));
            if !(read && seen && session.intake.next_frame(&mut taken)?) {
                return Ok(());
            }
        }
    }

    /// Prints a frame's line. Returns false if there is no reader any more.
    fn say(&self, number: u64, cue: &Cue<'_>, timing: Timing) -> Result<bool> {
        if self.quiet || self.json {
            return Ok(true);
        }
        let mut text = match self.json_lines {
            true => print::one_line(&CueMessage::new(number, cue, timing, self.sector_detail))?,
            false => text::text(number, cue),
        };
        text.push('\n');
        print::offer(text.as_bytes())
    }

    fn times(&self, source: &Source) -> Result<FrameTimes> {
        if let Some(path) = &self.times {
            return FrameTimes::listed(path, frame_times::read(path)?, source.len(), self.start_s);
        }
        let rate = self.fps.or_else(|| source.rate().map(FrameRate::of_fraction));
        if rate.is_none() && !self.quiet {
            print::note("assuming 30 frames per second; --fps or --times give others");
        }
        Ok(FrameTimes::even(rate.unwrap_or(FrameRate::DEFAULT), self.start_s))
    }

    /// A pinhole camera without distortion, with square pixels and its axis through the image's centre.
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

/// Models of the heading.
#[derive(ValueEnum, Clone, Copy, Debug)]
enum HeadingArg {
    /// It keeps its direction in the world: the vehicle goes straight on, however the camera rotates or shakes
    Straight,
    /// It keeps its direction in the camera's frame: the vehicle flies the way its nose points, as a fixed wing does in
    /// its turns
    Turning,
}

impl From<HeadingArg> for HeadingModel {
    fn from(heading: HeadingArg) -> Self {
        match heading {
            HeadingArg::Straight => Self::Straight,
            HeadingArg::Turning => Self::Turning,
        }
    }
}

/// The state of a run.
struct Session {
    pipeline: Pipeline,
    feed: GyroFeed,
    intake: Intake<Source>,
    summary: RunSummary,
}
