//! Data sets: a flight through a simulated world as files, with images, a gyro log, poses and the ground truth of
//! each frame. This module needs the feature `io` beside `sim`.
//!
//! The flight is steered by true depth, so an aircraft could fly it. The same configuration on the same adapter gives
//! the same files. A README.md in the folder documents each file, its units and frames.
//!
//! ```no_run
//! use viewsphere::Backend;
//! use viewsphere::frame::Size;
//! use viewsphere::sim::CourseKind;
//! use viewsphere::sim::data_set::{DataSetConfig, DataSetWriter, Existing, Truth};
//! use viewsphere::sim::flight::camera;
//!
//! # fn main() -> viewsphere::Result<()> {
//! let course = "city".parse::<CourseKind>()?.course(3)?;
//! let config = DataSetConfig { truths: vec![Truth::Flow, Truth::Nearness], ..DataSetConfig::default() };
//! let camera = camera(Size::new(640, 480));
//! let writer = DataSetWriter::new("set", Existing::Refuse, &course, &camera, &config)?;
//! let frames = writer.frames();
//! let summary = writer.write(Backend::Cpu, |written| println!("{written} of {frames}"))?;
//! println!("{:.1} m in {:.1} s", summary.path_m, summary.duration_s);
//! # Ok(())
//! # }
//! ```

mod config;
mod flown;
mod folder;
mod readme;
mod truth;

use std::path::Path;

pub use self::config::{DataSetConfig, Paint, STEPS_PER_S};
pub use self::truth::Truth;

use self::flown::Flown;
use self::folder::Folder;
use self::truth::Writer;
use super::flight::Outcome;
use super::vehicle::GyroErrors;
use super::{Course, Random, Renderer, RendererConfig};
use crate::backend::Backend;
use crate::camera::Camera;
use crate::error::Result;
use crate::io::{camera, gyro_log, picture};

/// What happens to a folder already at the data set's place. An empty folder counts as none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// An existing folder is an error.
    Refuse,
    /// A data set is replaced once the new one is complete; anything else is an error.
    Replace,
}

/// The summary of a data set.
#[derive(Clone, Debug, PartialEq)]
pub struct DataSetSummary {
    /// Number of frames.
    pub frames: usize,
    /// The time from the first frame to the last, seconds.
    pub duration_s: f64,
    /// How the flight ended, if it did so before the requested number of frames.
    pub ended: Option<Outcome>,
    /// Length of the path from the first frame to the last, metres.
    pub path_m: f64,
    /// The least clearance along the path, metres.
    pub least_clearance_m: f64,
    /// The total size of all files.
    pub bytes: u64,
}

impl DataSetSummary {
    /// How the flight ended, as text, if it did so before the requested number of frames.
    pub fn ending(&self) -> Option<&'static str> {
        self.ended.map(flown::ended)
    }
}

/// Writes a data set into a folder beside its final place, which is renamed at the end. A writer dropped earlier
/// leaves nothing.
pub struct DataSetWriter<'a> {
    course: &'a Course,
    camera: &'a Camera,
    config: &'a DataSetConfig,
    truths: Writer<'a>,
    folder: Folder,
    flown: Flown,
}

impl<'a> DataSetWriter<'a> {
    /// Creates the folder and flies the course.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) as in [`DataSetConfig::validate`], for a speed that the airframe
    /// cannot fly at, and for a `folder` that is not empty ([`Existing`]); [`Error::Io`](crate::Error::Io) if it
    /// cannot be created.
    pub fn new(
        folder: impl AsRef<Path>,
        existing: Existing,
        course: &'a Course,
        camera: &'a Camera,
        config: &'a DataSetConfig,
    ) -> Result<Self> {
        config.validate()?;
        let paint = config.paint.map(|paint| (paint, config.speed_m_s));
        let truths = Writer::new(&course.world, camera, &config.truths, config.grid, paint)?;
        let folder = Folder::new(folder.as_ref(), existing)?;
        let flown = Flown::new(course, config.speed_m_s, config.steps_per_frame(), config.frames)?;
        Ok(Self { course, camera, config, truths, folder, flown })
    }

    /// The number of frames that will be written.
    pub fn frames(&self) -> usize {
        self.flown.frames.len()
    }

    /// Renders and writes everything. The images are rendered on `backend`; `progress` is called after each frame
    /// with the number of frames written.
    ///
    /// # Errors
    /// The errors of [`Renderer::new`] and [`Renderer::render`]; [`Error::Io`](crate::Error::Io).
    pub fn write(self, backend: Backend, mut progress: impl FnMut(usize)) -> Result<DataSetSummary> {
        let Self { course, camera, config, truths, mut folder, flown } = self;
        let sight_config = RendererConfig { noise_levels: config.noise_levels, ..RendererConfig::default() };
        let mut renderer = Renderer::new(backend, camera, &course.world, &sight_config)?;
        camera::write(folder.path("camera.yaml"), camera, camera::Format::OpenCv)?;
        folder.make("frames")?;
        config.truths.iter().try_for_each(|truth| folder.make(truth.name()))?;
        let mut random = Random::new(config.seed);
        let seed = random.fork(1).next_u64();
        for (number, state) in flown.frames.iter().enumerate() {
            let image = renderer.render(&state.camera_pose(), seed.wrapping_add(number as u64))?;
            picture::write_png(folder.path(&format!("frames/{number:06}.png")), image)?;
            truths.write(&folder, number, state, flown.frames.get(number + 1))?;
            progress(number + 1);
        }
        let gyro_seed = random.next_u64();
        gyro_log::write(folder.path("gyro.csv"), &flown.gyro(&config.gyro_errors, gyro_seed)?)?;
        gyro_log::write(folder.path("gyro_true.csv"), &flown.gyro(&GyroErrors::NONE, 0)?)?;
        flown.write_tables(&folder)?;
        readme::write(&folder, config, course, camera, &flown)?;
        folder.finish()?;
        Ok(DataSetSummary {
            frames: flown.frames.len(),
            duration_s: flown.frames.len().saturating_sub(1) as f64 / f64::from(config.rate_hz),
            ended: flown.ended,
            path_m: flown.path_m(),
            least_clearance_m: flown.least_clearance_m(course),
            bytes: folder.bytes()?,
        })
    }
}
