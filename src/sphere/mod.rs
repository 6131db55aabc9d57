//! From pixels to the view sphere.

mod motion;

pub(crate) use motion::MOTION_LEN;
pub use motion::{Heading, Motion};
