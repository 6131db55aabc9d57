//! Dense optical flow for vehicles that fly cameras.

#[cfg(feature = "cli")]
pub mod cli;
pub mod cpu;
pub mod engine;
pub mod error;
pub mod eval;
pub mod flow;
pub mod frame;
pub mod gpu;
pub mod kernel;
pub mod kernels;
pub mod plan;

pub use engine::{Backend, Config, Engine, Extras, OnLoss, Output, Ticket};
pub use error::{Error, Result};
