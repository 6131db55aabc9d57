//! `viewsphere fly`: a flight through a simulated world, steered by what its sensor sees.

mod cues;
mod log;
mod measured;
mod outputs;
mod recorder;
pub(super) mod setup;
pub(super) mod timing;
mod video;

use std::path::PathBuf;

use clap::Args;

use self::log::End;
use self::measured::MeasureArgs;
use self::outputs::{FILES, Flown, VIDEO};
use self::recorder::Recorder;
use self::setup::SetupArgs;
use self::video::Video;
use super::args::{named_by_flags, whole, whole_within};
use super::backend::BackendArgs;
use super::place::Place;
use super::{Outcome, input, paths, print};
use crate::backend::Backend;
use crate::error::Result;
use crate::frame::Size;
use crate::io::{remove, write_atomic};
use crate::report::flight::FlightVideo;
use crate::sim::campaign::Faults;
use crate::sim::course::file;
use crate::sim::flight::{self, Fault, Flight, FlightConfig, MAX_LATENCY_FRAMES, Sensor, Summary};
use crate::sim::{Course, CourseKind};
use crate::steer::{Danger, Policy, SteerParams};

/// Fly through a simulated world, steered by what the sensor sees, and record the flight.
///
/// Each frame, at 30 Hz, is rendered, its flow computed, and a command derived from it, until the goal is reached or
/// something else ends the flight. Worlds are wall, corridor, city, forest, pillars, poisson-forest, dead-end,
/// wires and gates, with parameters after colons, or a file. The same arguments give the same flight: on the same adapter
/// flight.jsonl and flight.y4m are identical byte for byte. Computing times, in timing.json and report.html, differ.
///
/// Files in the folder: flight.jsonl, one JSON object per line: first the settings (version, world, seed, all options,
/// and a fingerprint of the whole configuration); then each frame (frame, time_s, position_ned_m, velocity_ned_m_s,
/// roll_pitch_yaw_rad, rate_body_rad_s, airspeed_m_s, clearance_m, progress_m, offset_m from the centre line, invalid:
/// null or why there is no valid cue, coverage 0 to 1, heading_error_rad, contact_s and true_contact_s along the
/// motion, measured: null without --measure, command, source: cue, held or recovery, danger 0 to 1, acting: the command
/// in effect after the latency); last how the flight ended (outcome: reached, crashed, left-band or timed-out; and
/// figures). timing.json: the computing times of the parts of a frame on this machine. report.html: the whole flight on
/// one self-contained page. flight.y4m: a video (10 Hz) of the camera's images with the results, a map and figures; it
/// is not compressed, some 25 MB per second of flight.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  viewsphere fly --world forest --seed 7
  viewsphere fly --world wall --sensor depth --policy balance --json
  viewsphere fly --world forest:density=1/64:radius=0.2..0.3 --speed 8 --size 640x480 -o dense/
  viewsphere fly --world city --fault black:2..3 --fault gyro-bias=5:6 -o faults/
  viewsphere fly --world corridor --backend gpu --fault device-lost:3
  viewsphere fly --world wall --measure --picture-at 3 -o wall/
  viewsphere fly --world forest --wind -3,0,0 --gusts light --vanes
  viewsphere fly --world wires --seed 2 --save-world wires.json --no-video
  viewsphere fly --world-file wires.json -o wires/ && ffmpeg -i wires/flight.y4m wires/flight.mp4

Exit codes: 0 the goal was reached, 1 it was not, 2 an error, 130 stopped by a signal.")]
pub(super) struct Fly {
    /// World, with its parameters
    #[arg(long, value_name = "WORLD[:PARAMETER=VALUE]...", default_value = "forest")]
    world: CourseKind,
    /// Seed of the world
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true, value_parser = whole::<u64>)]
    seed: u64,
    /// Read the world from a JSON file, written by --save-world or by hand (format: docs/worlds.md). A small one:
    /// {"format": "viewsphere course", "version": 1, "name": "pole", "start_ned_m": [0, 0, -10], "length_m": 60,
    /// "altitude_m": [2, 30], "surfaces": [{"kind": "ground"}, {"kind": "cylinder", "base_m": [40, 0, 0], "top_m": [40,
    /// 0, -25], "radius_m": 0.5}]}
    #[arg(long, value_name = "FILE", conflicts_with_all = ["world", "seed"])]
    world_file: Option<PathBuf>,
    /// Write the world of --world and --seed to a file for --world-file, then fly
    #[arg(long, value_name = "FILE", conflicts_with = "world_file")]
    save_world: Option<PathBuf>,
    /// Steering policy: none, balance, potential, heading or arc
    #[arg(long, value_name = "POLICY", default_value_t)]
    policy: Policy,
    /// Measure of danger: divergence, nearness or blend
    #[arg(long, value_name = "DANGER", default_value_t)]
    danger: Danger,
    /// What the vehicle steers by: true depth, true flow, noisy-flow, or the flow of images
    #[arg(long, value_name = "SENSOR", default_value_t)]
    sensor: Sensor,
    /// The same as --sensor flow
    #[arg(long, conflicts_with = "sensor")]
    truth_flow: bool,
    /// Airspeed, m/s: the airframe can hold its altitude at 7.7 to 25; with --body turn 0.1 to 1000
    #[arg(long, value_name = "M_S", allow_negative_numbers = true, default_value_t = 12.0)]
    speed: f64,
    /// Image size
    #[arg(long, value_name = "WxH", default_value = "320x240")]
    size: Size,
    /// Frames from an exposure until its command takes effect, at most 30
    #[arg(
        long,
        value_name = "N",
        default_value_t = 1,
        allow_negative_numbers = true,
        value_parser = whole_within(0, MAX_LATENCY_FRAMES)
    )]
    latency_frames: u32,
    /// Fault with its beginning and end in seconds; may be given several times. KIND is frozen, black, dropped[=SHARE]
    /// (share of the frames, 0.2 by default), gyro-lost, gyro-bias[=DEG_S] (5 by default), nan (in the frames' times)
    /// or device-lost (without UNTIL: the device is reopened the first time, not the second). With the sensor depth
    /// only gyro-lost is possible, with true flow also gyro-bias, with images all of them
    #[arg(long = "fault", value_name = "KIND[:FROM[..UNTIL]]")]
    faults: Vec<Fault>,
    /// Folder to write into, created if missing. Files of an earlier flight are replaced, other files of these names
    /// are not
    #[arg(short, long, value_name = "FOLDER", default_value = "flight")]
    output: PathBuf,
    /// Write no flight.y4m, and remove one left by an earlier flight
    #[arg(long)]
    no_video: bool,
    /// Print no progress and no notes
    #[arg(long)]
    quiet: bool,
    /// Print the summary as JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    measure: MeasureArgs,
    #[command(flatten)]
    setup: SetupArgs,
    #[command(flatten)]
    backend: BackendArgs,
}

impl Fly {
    pub(super) fn run(&self) -> Result<Outcome> {
        let config = self.config()?;
        config
            .validate()
            .map_err(|error| named_by_flags(error, &[("speed_m_s", "--speed"), ("size", "--size")]))?;
        self.backend.check()?;
        let course = self.course()?;
        input::folder(&self.output)?;
        outputs::spare(&self.output)?;
        self.check_paths()?;
        let backends = match config.sensor {
            Sensor::Images => self.backend.open_pair(self.quiet)?,
            _ => [Backend::Cpu, Backend::Cpu],
        };
        Faults(self.faults.clone()).check(&backends[1])?;
        let names = (config.sensor == Sensor::Images).then(|| backends.each_ref().map(Backend::name));
        let mut flight = Flight::new(backends, &course, &config)?;
        let drawing = if self.no_video { None } else { Some(FlightVideo::new(&flight)?) };
        let mut recorder = Recorder::new(&course, self.measure.picture(&flight)?, self.quiet);
        let flown = input::within(&self.output, || {
            if let Some(path) = &self.save_world {
                file::write(path, &course)?;
            }
            self.fly(&mut flight, &mut recorder, drawing)
        });
        recorder.finish();
        let summary = flown?;
        let flown = Flown { flight: &flight, recorder: &recorder, summary: &summary, names };
        let told = flown.write(&self.output, &self.setup)?;
        if self.json { print::json(&End::from(&summary)) } else { print::text(&told) }?;
        Ok(match summary.outcome {
            flight::Outcome::Reached => Outcome::Done,
            flight::Outcome::Crashed | flight::Outcome::LeftBand | flight::Outcome::TimedOut => {
                Outcome::CheckFailed
            }
        })
    }

    fn course(&self) -> Result<Course> {
        let Some(path) = &self.world_file else { return self.world.course(self.seed) };
        file::read(path)
    }

    /// Checks that the world's file is none of the flight's.
    fn check_paths(&self) -> Result<()> {
        let own = FILES.map(|name| Place::File(self.output.join(name)));
        let saved = self.save_world.clone().map(Place::File);
        let results = own.iter().map(|own| ("-o", Some(own))).chain([("--save-world", saved.as_ref())]);
        paths::are_apart(&results.collect::<Vec<_>>(), self.world_file.as_deref())
    }

    /// Flies to the end, and writes the video if there is one.
    fn fly(
        &self,
        flight: &mut Flight,
        recorder: &mut Recorder,
        drawing: Option<FlightVideo>,
    ) -> Result<Summary> {
        let path = self.output.join(VIDEO);
        let Some(drawing) = drawing else {
            let summary = recorder.fly(flight, None)?;
            remove(&path)?;
            return Ok(summary);
        };
        write_atomic(&path, |out| {
            let mut video = Video::new(drawing, out, &path)?;
            let summary = recorder.fly(flight, Some(&mut video))?;
            video.finish()?;
            Ok(summary)
        })
    }

    fn config(&self) -> Result<FlightConfig> {
        let base = self.setup.config()?;
        let mut config = FlightConfig {
            speed_m_s: self.speed,
            sensor: if self.truth_flow { Sensor::Flow } else { self.sensor },
            camera: flight::resized(&base.camera, self.size),
            steer: SteerParams { policy: self.policy, danger: self.danger, ..base.steer },
            latency_frames: self.latency_frames,
            faults: self.faults.clone(),
            measure: self.measure.measure,
            ..base
        };
        // The flow is read back for the video only.
        config.pipeline.read_flow = !self.no_video;
        Ok(config)
    }
}

/// A value rounded for display. Adding 0 removes the sign of −0.
fn shown(value: f64) -> f64 {
    value.round() + 0.0
}
