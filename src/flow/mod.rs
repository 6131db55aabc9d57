//! Estimators of optical flow. Each one builds a [`Plan`](crate::plan::Plan) and reads like its paper.

mod farneback;
mod levels;

pub use farneback::{Farneback, Outside, Update, Window};
pub(crate) use farneback::{Parts, gray_step};
pub use levels::{Level, levels};
