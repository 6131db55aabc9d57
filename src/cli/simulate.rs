//! `viewsphere simulate`: the data set of a flight through a simulated world, with ground truth.

use std::path::PathBuf;

use clap::builder::PossibleValue;
use clap::{Args, ValueEnum};
use serde::Serialize;

use super::args::{named_by_flags, whole};
use super::backend::BackendArgs;
use super::progress::Progress;
use super::{Outcome, input, paths, print};
use crate::error::{Error, Result};
use crate::frame::Size;
use crate::io;
use crate::report::diverging;
use crate::sim::CourseKind;
use crate::sim::data_set::{DataSetConfig, DataSetSummary, DataSetWriter, Existing, STEPS_PER_S, Truth};
use crate::sim::flight::camera;
use crate::sim::vehicle::{GyroErrors, MAX_BIAS_RAD_S};
use crate::text::counted;

/// The size in bytes from which a set is announced before it is written.
const LARGE: f64 = 1e9;

/// Create a data set: a flight through a simulated world, with images, gyro samples and ground truth.
///
/// The flight is steered by true depth, so an aircraft could fly it. Beside frames/ the folder holds times.csv,
/// camera.yaml (OpenCV's), gyro.csv and gyro_true.csv (body axes: forward, right, down), poses.csv, and a README.md
/// that documents each file, its units and frames, and how it was made. Ground truth, one file per frame: flow/
/// (.flo, pixels to the next frame, unknown where the point is hidden there), depth/ (.npy, metres along the ray),
/// nearness/ (1/m), divergence/ and spherical/ (of the flow on the view sphere, 1/s and rad/s), grid/ (distances by
/// azimuth and elevation, see --grid).
///
/// The same command gives the same files on the same adapter. Files are written into FOLDER.partial, which is renamed
/// at the end; with --force the old folder is FOLDER.replaced for that moment. Both are removed where an earlier,
/// interrupted run has left them.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  viewsphere simulate --world city --seed 3 --seconds 20 -o set/
  viewsphere simulate --world forest:density=1/64 --speed 8 --size 320x240 --truth flow,depth,spherical -o set/
  viewsphere simulate --world wall --truth grid --grid 64x16 -o set/
  viewsphere simulate --world corridor --seconds 3 --truth divergence,nearness --pictures -o set/
  viewsphere flow 'set/frames/%06d.png' -o estimate/ && viewsphere eval --truth set/flow/000010.flo estimate/000010.flo
  viewsphere eval --data set/ --run farneback,farneback-tv:fine
  viewsphere run 'set/frames/%06d.png' --camera set/camera.yaml --times set/times.csv \\
    --gyro set/gyro.csv --camera-from-gyro frd --heading turning")]
pub(super) struct Simulate {
    /// World, with parameters such as forest:density=1/64: wall, corridor, city, forest, pillars, poisson-forest,
    /// dead-end, wires, gates
    #[arg(long, value_name = "WORLD", default_value = "city")]
    world: CourseKind,
    /// Seed of the world and of all other random values
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true, value_parser = whole::<u64>)]
    seed: u64,
    /// Duration of the flight, two frames to 600 s; it ends earlier at the goal
    #[arg(long, value_name = "SECONDS", default_value_t = 20.0, allow_negative_numbers = true)]
    seconds: f64,
    /// Airspeed, m/s: the airframe can hold its altitude at 7.7 to 25
    #[arg(long, value_name = "M_S", default_value_t = 12.0, allow_negative_numbers = true)]
    speed: f64,
    /// Image size
    #[arg(long, value_name = "WxH", default_value = "640x480")]
    size: Size,
    /// Camera file [default: a camera of 96° before its barrel distortion]
    #[arg(long, value_name = "FILE", conflicts_with = "size")]
    camera: Option<PathBuf>,
    /// Frame rate in Hz: a divisor of 240
    #[arg(long, value_name = "RATE", default_value_t = 30, allow_negative_numbers = true)]
    fps: u32,
    /// Ground truth to write; at 640x480 a frame of flow takes 2.4 MB, of spherical 3.7 MB, of the others 1.2 MB
    #[arg(long, value_enum, value_delimiter = ',', default_value = "flow,depth")]
    truth: Vec<Truth>,
    /// Draw an image beside each file of divergence and nearness: 0 is white, what approaches is red; full colour is
    /// what a wall ahead shows one second before contact
    #[arg(long)]
    pictures: bool,
    /// Grid of rays over the field of view, azimuths × elevations, with grid in --truth [default: 32x24]
    #[arg(long, value_name = "AZxEL")]
    grid: Option<Size>,
    /// Standard deviation of the image noise, in gray levels, 0 to 64
    #[arg(long, value_name = "LEVELS", default_value_t = 2.0, allow_negative_numbers = true)]
    noise: f64,
    /// Density of the gyro's white noise, rad/s/√Hz, 0 to 1 [default: 3.4e-4]
    #[arg(long, value_name = "DENSITY", allow_negative_numbers = true)]
    gyro_noise: Option<f64>,
    /// Bias of each gyro axis at the start, °/s, within ±2005
    #[arg(long, value_name = "DEG_S", default_value_t = 0.0, allow_negative_numbers = true)]
    gyro_bias: f64,
    /// Folder to write into; it must be empty or missing
    #[arg(short, long, value_name = "FOLDER")]
    output: PathBuf,
    /// Replace the result of an earlier run
    #[arg(long)]
    force: bool,
    /// Print no progress and no notes
    #[arg(long)]
    quiet: bool,
    /// Print the summary as JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    backend: BackendArgs,
}

/// The summary of a data set.
#[derive(Serialize)]
struct SimulateSummary {
    folder: PathBuf,
    world: String,
    seed: u64,
    frames: usize,
    fps: u32,
    /// The time from the first frame to the last.
    duration_s: f64,
    /// How the flight ended, if it did so before its time was over.
    ended: Option<&'static str>,
    path_m: f64,
    least_clearance_m: f64,
    bytes: u64,
    /// The values shown in full colour, if images of the ground truth are drawn.
    full_colour: Option<String>,
}

impl Simulate {
    pub(super) fn run(&self) -> Result<Outcome> {
        self.check()?;
        let camera = match &self.camera {
            Some(path) => io::camera::read(path)?,
            None => camera(self.size),
        };
        let course = self.world.course(self.seed)?;
        let config = self.config()?;
        config.validate().map_err(named)?;
        self.warn(&config, camera.size);
        input::not_standard_output(&self.output)?;
        if let Some(path) = self.camera.as_ref().filter(|_| self.force) {
            paths::is_outside("--camera", path, &self.output)?;
        }
        let existing = if self.force { Existing::Replace } else { Existing::Refuse };
        let writer = DataSetWriter::new(&self.output, existing, &course, &camera, &config).map_err(named)?;
        let backend = self.backend.open(self.quiet)?;
        let progress = Progress::new(Some(writer.frames() as u64), "frames", self.quiet);
        let written = writer.write(backend, |frames| progress.set(frames as u64));
        progress.finish();
        self.say(&course.name, &config, &written.map_err(named)?)?;
        Ok(Outcome::Done)
    }

    /// Checks what the library does not check, or reports under other names.
    fn check(&self) -> Result<()> {
        if !(self.seconds > 0.0 && self.seconds <= 600.0) {
            return Err(Error::parameter("--seconds", self.seconds, "above 0 and at most 600"));
        }
        if !(self.gyro_bias.to_radians().abs() <= MAX_BIAS_RAD_S) {
            let expected = format!("within ±{:.0} °/s", MAX_BIAS_RAD_S.to_degrees());
            return Err(Error::parameter("--gyro-bias", format_args!("{} °/s", self.gyro_bias), expected));
        }
        if self.fps == 0 || !STEPS_PER_S.is_multiple_of(self.fps) {
            let expected = format!("a divisor of {STEPS_PER_S}");
            return Err(Error::parameter("--fps", self.fps, expected));
        }
        let pictured = |truth: &Truth| truth.full_colour(self.speed).is_some();
        if self.pictures && !self.truth.iter().any(pictured) {
            return Err(Error::parameter("--pictures", "on", "divergence or nearness in --truth"));
        }
        if let Some(grid) = self.grid.filter(|_| !self.truth.contains(&Truth::Grid)) {
            let found = format!("{}x{}", grid.width, grid.height);
            return Err(Error::parameter("--grid", found, "none without grid in --truth"));
        }
        Ok(())
    }

    fn config(&self) -> Result<DataSetConfig> {
        // With fewer than two frames there is no motion.
        let frames = (self.seconds * f64::from(self.fps)).round();
        if !(frames >= 2.0) {
            let found = format_args!("{}, {frames} frames at --fps {}", self.seconds, self.fps);
            let least = format_args!("2 frames and more, from {:.3} s on", 1.5 / f64::from(self.fps));
            return Err(Error::parameter("--seconds", found, least));
        }
        let default = DataSetConfig::default();
        Ok(DataSetConfig {
            seed: self.seed,
            frames: frames as usize,
            rate_hz: self.fps,
            speed_m_s: self.speed,
            noise_levels: self.noise,
            gyro_errors: GyroErrors {
                noise_rad_s_rthz: self.gyro_noise.unwrap_or(default.gyro_errors.noise_rad_s_rthz),
                bias_rad_s: glam::DVec3::splat(self.gyro_bias.to_radians()),
                ..default.gyro_errors
            },
            truths: self.truth.clone(),
            grid: self.grid.unwrap_or(default.grid),
            paint: self.pictures.then_some(diverging),
            made_by: Some(typed()),
        })
    }

    /// Announces the size of a large data set.
    fn warn(&self, config: &DataSetConfig, size: Size) {
        // PNG does not compress a noisy gray image.
        let bytes = config.frames as f64 * config.bytes_per_frame(size);
        if bytes >= LARGE && !self.quiet {
            print::note(format_args!(
                "up to {:.1} GB will be written: {} of {size}",
                1e-9 * bytes,
                counted(config.frames, "frame")
            ));
        }
    }

    fn say(&self, world: &str, config: &DataSetConfig, written: &DataSetSummary) -> Result<()> {
        let summary = SimulateSummary {
            folder: self.output.clone(),
            world: world.to_owned(),
            seed: self.seed,
            frames: written.frames,
            fps: self.fps,
            duration_s: written.duration_s,
            ended: written.ending(),
            path_m: written.path_m,
            least_clearance_m: written.least_clearance_m,
            bytes: written.bytes,
            full_colour: config.scales(),
        };
        if self.json {
            return print::json(&summary);
        }
        let colours = summary.full_colour.as_ref();
        let colours = colours.map_or(String::new(), |scales| format!("\ncolour  full at {scales}"));
        let ended = summary.ended.map_or(String::new(), |ended| format!(", then {ended}"));
        print::text(&format!(
            "world   {}, seed {}\nflight  {:.2} s, {:.1} m{ended}; nearest surface at {:.2} m\n\
             set     {}, {:.1} MB in {}{colours}",
            summary.world,
            summary.seed,
            summary.duration_s,
            summary.path_m,
            summary.least_clearance_m,
            counted(summary.frames, "frame"),
            summary.bytes as f64 / 1e6,
            summary.folder.display(),
        ))
    }
}

/// An error that names the flags.
fn named(error: Error) -> Error {
    let flags = [
        ("speed_m_s", "--speed"),
        ("noise_levels", "--noise"),
        ("noise_rad_s_rthz", "--gyro-noise"),
        ("folder", "-o"),
    ];
    match named_by_flags(error, &flags) {
        Error::Parameter { name, value, expected } => {
            Error::Parameter { name, value, expected: expected.replace("Existing::Replace", "--force") }
        }
        error => error,
    }
}

impl ValueEnum for Truth {
    fn value_variants<'a>() -> &'a [Self] {
        &Self::ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        let about = match self {
            Self::Flow => "Pixels to the next frame, .flo",
            Self::Depth => "Metres along each pixel's ray, .npy",
            Self::Nearness => "Inverse of the depth, 1/m, .npy",
            Self::Divergence => "Divergence of the flow on the view sphere, 1/s, .npy",
            Self::Spherical => "Flow on the view sphere in the camera's frame, rad/s, .npy",
            Self::Grid => "Metres along rays at evenly spaced azimuths and elevations, .npy",
        };
        Some(PossibleValue::new(self.name()).help(about))
    }
}

/// The command line as typed, quoted so that it can be repeated.
fn typed() -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=:,+".contains(c);
    let quoted = |word: String| match !word.is_empty() && word.chars().all(plain) {
        true => word,
        false => format!("'{}'", word.replace('\'', "'\\''").replace(['\n', '\r'], " ")),
    };
    let words = std::env::args_os().skip(1).map(|word| quoted(word.to_string_lossy().into_owned()));
    std::iter::once("viewsphere".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}
