//! Dense optical flow for vehicles that fly cameras.

pub mod error;
pub mod eval;
pub mod frame;

pub use error::{Error, Result};
