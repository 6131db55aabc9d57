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
pub mod kernel;
pub mod kernels;
mod named;
pub mod pipeline;
pub mod plan;
mod quantile;
pub mod report;
pub mod runner;
pub mod sim;
pub mod sphere;
pub mod steer;
pub mod stream;

/// The vectors and matrices of this crate's interface.
pub use glam;

pub use backend::Backend;
pub use engine::{Config, Engine, Extras, Output, OwnedOutput};
pub use error::{Error, Result};
pub use pipeline::{Cue, Pipeline, PipelineConfig};
pub use stream::{OnLoss, StreamConfig, Ticket};
