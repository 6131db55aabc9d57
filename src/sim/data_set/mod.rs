//! Data sets: a flight through a simulated world as files, with pictures, a gyro's log, poses and the truth of each frame.
//! This module needs the feature `io` beside `sim`.
//!
//! The flight is steered by true depth, so that it is one that an aircraft could fly. The same configuration on the same
//! adapter gives the same files. A README.md in the folder says what each file holds, in which units and frames.
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
//! let writer = DataSetWriter::new("set", Existing::Refuse, &course, &camera(Size::new(640, 480)), &config)?;
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

/// What becomes of what is at the data set's place already. An empty folder is nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// It is an error.
    Refuse,
    /// A data set is replaced once the new one is complete; anything else is an error.
    Replace,
}

/// What a data set holds.
#[derive(Clone, Debug, PartialEq)]
pub struct DataSetSummary {
    /// Number of frames.
    pub frames: usize,
    /// Seconds from the first frame to the last.
    pub duration_s: f64,
    /// How the flight ended, if it did before it had as many frames as were asked for.
    pub ended: Option<Outcome>,
    /// Length of the path from the first frame to the last, metres.
    pub path_m: f64,
    /// The least distance to any surface on the way, metres.
    pub least_clearance_m: f64,
    /// Bytes of all files.
    pub bytes: u64,
}

impl DataSetSummary {
    /// How the flight ended, in words, if it did before it had as many frames as were asked for.
    pub fn ending(&self) -> Option<&'static str> {
        self.ended.map(flown::ended)
    }
}

/// Writes a data set into a folder beside its place, which is renamed at the end. A writer that is dropped before leaves
/// nothing.
pub struct DataSetWriter<'a> {
    course: &'a Course,
    camera: &'a Camera,
    config: &'a DataSetConfig,
    truths: Writer<'a>,
    folder: Folder,
    flown: Flown,
}

impl<'a> DataSetWriter<'a> {
    /// Makes the folder and flies the course.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) for what [`DataSetConfig::validate`] finds, for a speed that the
    /// airframe cannot fly at, and for a `folder` that has something in it ([`Existing`]);
    /// [`Error::Io`](crate::Error::Io) if it cannot be made.
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

    /// Renders and writes everything. The pictures are rendered on `backend`; `progress` is told the number of frames
    /// written after each one.
    ///
    /// # Errors
    /// What [`Renderer::new`] and [`Renderer::render`] fail with; [`Error::Io`](crate::Error::Io).
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
