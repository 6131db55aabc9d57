//! Dense optical flow for vehicles that fly cameras: Farnebäck's method on the GPU and on the CPU, from one plan.
//!
//! An [`Engine`] takes a stream of frames and gives the flow from each one to the next:
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
//!     // None for the first frame: there is no pair yet.
//!     if let Some(flow) = engine.process(&frame)?.and_then(|output| output.flow) {
//!         let [u, v] = flow.data[24 * 64 + 32];
//!         assert!((u + 1.0).abs() < 0.1 && v.abs() < 0.1, "one pixel to the left, not {u} {v}");
//!     }
//! }
//! # Ok(())
//! # }
//! ```
//!
//! With [`Backend::Gpu`] the same frames go through WGSL kernels on any GPU that `wgpu` reaches; a stated bound holds
//! between the two (see [`kernels`] and `viewsphere crosscheck`). The layers are described in `ARCHITECTURE.md`.
//!
//! # Cargo features
//!
//! Without any feature the crate holds what runs on board: [`frame`]s, [`camera`]s, the [`imu`], the [`engine`], the
//! [`pipeline`] from frames and a gyro to cues, [`live`] intake and [`steer`]ing. `default-features = false` gives just that.
//!
//! | feature | what it adds |
//! |---|---|
//! | `io` | the module `io`: files of pictures, videos, flow fields, cameras and gyro logs |
//! | `sim` | the module `sim`: simulated worlds, vehicles, flights and campaigns; with `io`, data sets of them |
//! | `report` | the module `report`: flow in colours and arrows, overlays and pages; with `sim`, those of flights |
//! | `serde` | the module `wire`: cues as JSON; with `sim` and `io`, files of worlds and of campaigns |
//! | `cli` (default) | the command line, with all of these |
//! | `metal`, `dx12`, `gles` | wgpu's other back ends; Vulkan is always there |

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
pub mod camera;
#[cfg(feature = "cli")]
pub mod cli;
pub mod cpu;
pub mod engine;
pub mod error;
pub mod eval;
pub mod flow;
pub mod frame;
pub mod gpu;
pub mod imu;
#[cfg(feature = "io")]
pub mod io;
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
#[cfg(feature = "serde")]
pub mod wire;

/// The vectors and matrices of this crate's interface.
pub use glam;

pub use backend::Backend;
pub use engine::{Config, Engine, FrameInputs, Output, OwnedOutput};
pub use error::{Error, Result};
pub use pipeline::{Cue, OwnedCue, Pipeline, PipelineConfig};
pub use stream::{OnLoss, StreamConfig, Ticket};
