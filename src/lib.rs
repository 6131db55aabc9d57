//! Dense optical flow for vehicles that fly cameras, and what follows from it: time to contact and steering.
//!
//! *Optical flow* is the displacement of each pixel from one frame to the next. With a calibrated camera, and better
//! with a gyro, it tells which way the camera moves and in how many seconds it will touch what it sees, without any
//! distance being measured. viewsphere computes the flow (Farnebäck's method, the same with total-variation smoothness, or dense Lucas–Kanade), carries it to the
//! view sphere, summarizes it in sectors, raises alarms, and steers a fixed wing around what is near.
//!
//! Per-pixel work is done by compute kernels. Each kernel exists twice: in WGSL, for any GPU that `wgpu` reaches, and
//! in Rust, for the CPU. Both executors run the same [`plan`], and each kernel states how far the two may differ.
//!
//! # Flow
//!
//! An [`Engine`] takes the frames of one camera and returns the flow from each frame to the next:
//!
//! ```
//! use viewsphere::frame::{Frame, PixelFormat, Size};
//! use viewsphere::{Backend, Config, Engine};
//!
//! # fn main() -> viewsphere::Result<()> {
//! let size = Size::new(64, 48);
//! let mut engine = Engine::new(Backend::Cpu, size, &Config::default())?;
//! let texture = |x: u32, y: u32| 128.0 + 60.0 * (f64::from(x) * 0.4).sin() + 60.0 * (f64::from(y) * 0.5).cos();
//! for shift in 0..2 {
//!     let pixel = |i: u32| texture(i % 64 + shift, i / 64) as u8;
//!     let pixels: Vec<u8> = (0..64 * 48).map(pixel).collect();
//!     let frame = Frame::new(size, PixelFormat::Gray8, &pixels)?;
//!     // The first frame has no previous one: the result is None.
//!     if let Some(flow) = engine.process(&frame)?.and_then(|output| output.flow) {
//!         // Row 24, column 32: the texture has moved by one pixel to the left.
//!         let [u, v] = flow.data[24 * 64 + 32];
//!         assert!((u + 1.0).abs() < 0.1 && v.abs() < 0.1, "{u} {v}");
//!     }
//! }
//! # Ok(())
//! # }
//! ```
//!
//! With [`Backend::Gpu`] the same frames go through the WGSL kernels. [`Engine::process`] waits for the result; to go
//! on meanwhile, call [`Engine::submit`], then [`Engine::poll`] or [`Engine::wait`].
//!
//! # Time to contact
//!
//! A [`Pipeline`] takes frames with their times, and a gyro's samples where there is a gyro. It returns a [`Cue`] per
//! frame: the time to contact in each sector of the view, the direction of motion, and the threat that will be met
//! first. Here the camera flies at 5 m/s towards a wall 6 m ahead, so that the texture expands about the image centre:
//!
//! ```
//! use viewsphere::camera::{Camera, Lens};
//! use viewsphere::frame::{Frame, PixelFormat, Size};
//! use viewsphere::{Backend, Pipeline, PipelineConfig};
//!
//! # fn main() -> viewsphere::Result<()> {
//! let size = Size::new(320, 240);
//! let camera = Camera { size, f_u: 160.0, f_v: 160.0, u_0: 159.5, v_0: 119.5, lens: Lens::NONE };
//! let mut pipeline = Pipeline::new(Backend::Cpu, &camera, &PipelineConfig::default())?;
//! let mut alarms = 0;
//! for number in 0..4 {
//!     let time_s = f64::from(number) / 30.0;
//!     let distance_m = 6.0 - 5.0 * time_s;
//!     // The wall's texture: waves of these numbers in rad/m.
//!     let waves = [(12.0, 3.0), (-4.0, 11.0), (5.0, 7.0), (-7.0, 4.0), (2.0, -3.0)];
//!     let gray = |i: u32| {
//!         let x_m = distance_m * (f64::from(i % 320) - camera.u_0) / camera.f_u;
//!         let y_m = distance_m * (f64::from(i / 320) - camera.v_0) / camera.f_v;
//!         let sum: f64 = waves.iter().map(|(x, y)| (x * x_m + y * y_m).sin()).sum();
//!         (128.0 + 24.0 * sum).round() as u8
//!     };
//!     let pixels: Vec<u8> = (0..320 * 240).map(gray).collect();
//!     let cue = pipeline.process(&Frame::new(size, PixelFormat::Gray8, &pixels)?, time_s)?;
//!     // An invalid cue must not be acted on. That of the first frame is: it has no previous frame.
//!     assert_eq!(cue.invalid.is_some(), number == 0);
//!     // A threat that is seen in two frames in a row is an alarm.
//!     if let Some(threat) = cue.threat.filter(|threat| threat.alarm) {
//!         let expected_s = distance_m / 5.0;
//!         assert!((threat.time_s - expected_s).abs() < 0.05 * expected_s, "{} s", threat.time_s);
//!         alarms += 1;
//!     }
//! }
//! assert_eq!(alarms, 2);
//! # Ok(())
//! # }
//! ```
//!
//! `examples/onboard.rs` adds a gyro, for a camera that sways.
//!
//! # Steering
//!
//! [`Steering`](steer::Steering) turns the sectors of a cue, the aircraft's attitude and its airspeed into a bank and a
//! climb. Here the sectors are synthetic: at 12 m/s, an obstacle 20 m ahead covers the view's middle and right.
//!
//! ```
//! use viewsphere::camera::{Camera, Lens};
//! use viewsphere::frame::Size;
//! use viewsphere::glam::{DMat3, DVec3};
//! use viewsphere::sphere::{Grid, Heading, Sectors};
//! use viewsphere::steer::{Goal, Observation, Source, SteerConfig, Steering, View};
//!
//! # fn main() -> viewsphere::Result<()> {
//! let size = Size::new(320, 240);
//! let camera = Camera { size, f_u: 160.0, f_v: 160.0, u_0: 159.5, v_0: 119.5, lens: Lens::NONE };
//! let mut sectors = Sectors::unknown(Grid::over(&camera, [32, 24])?);
//! for row in 0..sectors.grid.rows {
//!     for column in 0..sectors.grid.columns {
//!         let [azimuth_rad, elevation_rad] = sectors.grid.angles_rad(column, row);
//!         let blocked = (-0.2..0.6).contains(&azimuth_rad) && elevation_rad.abs() < 0.4;
//!         let sector = &mut sectors.sectors[row * sectors.grid.columns + column];
//!         (sector.coverage, sector.confidence) = (1.0, 1.0);
//!         // The inverse of the time to contact: 20 m at 12 m/s.
//!         sector.nearness_rate_hz = [if blocked { 12.0 / 20.0 } else { 0.0 }; 3];
//!     }
//! }
//! let mut steering = Steering::new(SteerConfig::default())?;
//! for frame in 0..4 {
//!     let decision = steering.update(&Observation {
//!         time_s: f64::from(frame) / 30.0,
//!         ned_from_body: DMat3::IDENTITY,
//!         airspeed_m_s: 12.0,
//!         motion_body: None,
//!         goal: Goal::default(),
//!         view: Some(View {
//!             sectors: &sectors,
//!             heading: Heading { direction: DVec3::Z, error_rad: 0.01 },
//!         }),
//!     });
//!     assert_eq!(decision.source, Source::Cue);
//!     if frame == 3 {
//!         // Left wing down: the left is free.
//!         assert!(decision.command.bank_rad < 0.0, "{decision:?}");
//!     }
//! }
//! # Ok(())
//! # }
//! ```
//!
//! With a pipeline, `View::of(&cue)` gives the view of a valid cue, and None for an invalid one; without a view the
//! last command is held for a moment, then the wings are levelled. `examples/steer.rs` closes the loop in a simulated
//! world.
//!
//! # Modules
//!
//! The modules stand in layers; each layer uses only those below it. `ARCHITECTURE.md` describes them.
//!
//! | layer | modules | what it holds |
//! |---|---|---|
//! | program | `cli` | the command line (feature `cli`) |
//! | reports | `report` | colours, overlays, videos and pages (feature `report`) |
//! | simulation | `sim` | worlds with exact truth, vehicles, flights, campaigns, data sets (feature `sim`) |
//! | messages | `wire` | cues as JSON (feature `serde`) |
//! | checks | [`crosscheck`], [`benchmark`] | a GPU's values against the CPU's; times of frames and kernels |
//! | intake | [`live`] | frames and gyro samples as they arrive, with their times |
//! | steering | [`steer`] | from sectors to bank and climb |
//! | cues | [`pipeline`] | from frames and a gyro to cues |
//! | flow of streams | [`engine`], [`eval`] | flow of a stream of frames; errors of a flow field against the truth |
//! | points of streams | [`features`], [`tracking`] | corners; points and tracks from frame to frame (sparse Lucas–Kanade) |
//! | execution | [`stream`], [`runner`] | a plan on a stream of frames in real time; on single images or pairs |
//! | methods | [`flow`], [`sphere`] | flow estimators and the view sphere, which build plans |
//! | plans | [`plan`] | a frame's computation as data: buffers, steps and ports |
//! | executors | [`gpu`], [`cpu`] | both run any plan |
//! | kernels | [`kernel`], [`kernels`] | the per-pixel computations, each in WGSL and in Rust |
//! | journals | `journal` | results of many jobs in a file that survives an interruption (features `io` and `serde`) |
//! | files | `io` | images, videos, flow fields, cameras, gyro logs (feature `io`) |
//! | plain types | [`frame`], [`camera`], [`imu`], [`error`] | frames, cameras, rotations from a gyro, errors |
//!
//! # Cargo features
//!
//! Without any feature the crate holds what runs on board: everything in the table above that names no feature.
//! `default-features = false` gives just that.
//!
//! | feature | what it adds |
//! |---|---|
//! | `io` | the module `io`: files of images, videos, flow fields, cameras and gyro logs |
//! | `sim` | the module `sim`: simulated worlds, vehicles, flights and campaigns; with `io`, data sets of them |
//! | `report` | the module `report`: flow in colours and arrows, overlays and pages; with `sim`, those of flights |
//! | `serde` | the module `wire`: cues as JSON; with `sim` and `io`, files of worlds and of campaigns |
//! | `cli` (default) | the command line, with all of these |
//! | `metal`, `dx12`, `gles` | wgpu's other back ends; Vulkan is always there |
//!
//! # Glossary
//!
//! - **View sphere**: the unit sphere of viewing directions (*bearings*) around the camera. Flow on it is the rate at
//!   which a bearing moves, in rad/s or, on the device, in radians per frame. Lens and focal length have no part in it.
//! - **Derotation**: removal of the flow that the camera's rotation causes, with the rotation that a gyro measures.
//!   What remains is the translational flow, which depends on distance. See [`Derotation`](sphere::Derotation).
//! - **Heading**: the direction in which the camera moves, a unit vector in the camera's frame with its standard error.
//!   See [`Heading`](sphere::Heading).
//! - **Nearness**: the inverse of the distance along a bearing, ρ = 1/d, in 1/m. Flow alone gives only its product with
//!   the speed, the *nearness rate* ρ‖v‖ in 1/s.
//! - **Looming**: the approach of what is seen, as its image shows it: nearness rate and divergence of the flow on the
//!   view sphere, both in 1/s.
//! - **Time to contact**: the inverse of the nearness rate: the seconds until the distance along a bearing would be
//!   flown at the present speed. No distance and no speed is needed for it.
//! - **Cell**: a square of pixels (8 × 8 by default) over which the flow is averaged. See [`Cells`](sphere::Cells).
//! - **Sector**: a rectangle of azimuth and elevation that summarizes its cells. See [`Sectors`](sphere::Sectors).
//! - **Cue**: the result for a frame: sectors, heading, threat, and the reason if it must not be used. See [`Cue`].
//! - **Confidence**: an output, 0 to 1: how precisely the flow of a pixel, cell or sector is determined. *Certainty* is
//!   an input, 0 to 1: how far a pixel of a frame can be relied on.
//! - **Parity**: 0 or 1, alternating from frame to frame. Buffers exist once per parity, so that the previous frame's
//!   values are still there.
//! - **Port**: a named place where the host writes into a plan (input) or reads from it (output). See
//!   [`Port`](plan::Port).

#[cfg_attr(
    not(feature = "io"),
    allow(
        dead_code,
        unused_imports,
        unreachable_pub,
        reason = "without files, only compiled kernels are kept"
    )
)]
mod atomic_file;
mod backend;
pub mod benchmark;
pub mod camera;
#[cfg(feature = "cli")]
pub mod cli;
pub mod cpu;
pub mod crosscheck;
pub mod engine;
pub mod error;
pub mod eval;
pub mod features;
pub mod flow;
#[cfg(feature = "io")]
mod fnv;
pub mod frame;
pub mod gpu;
pub mod imu;
#[cfg(feature = "io")]
pub mod io;
#[cfg(all(feature = "io", feature = "serde"))]
pub mod journal;
pub mod kernel;
pub mod kernels;
pub mod live;
mod named;
pub mod pipeline;
pub mod plan;
#[cfg_attr(not(feature = "sim"), allow(dead_code, reason = "flights use more of it"))]
mod quantile;
mod raster;
#[cfg(feature = "report")]
pub mod report;
pub mod runner;
#[cfg(feature = "sim")]
pub mod sim;
pub mod sphere;
pub mod steer;
pub mod stream;
#[cfg(any(feature = "report", all(feature = "sim", feature = "io")))]
mod text;
pub mod tracking;
#[cfg(feature = "serde")]
pub mod wire;

/// The vectors and matrices of this crate's interface.
pub use glam;

pub use backend::Backend;
pub use engine::{Config, Engine, FrameInputs, Output, OwnedOutput};
pub use error::{Error, Result};
pub use pipeline::{Cue, OwnedCue, Pipeline, PipelineConfig};
pub use stream::{OnLoss, StreamConfig, Ticket};
