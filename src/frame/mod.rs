//! Pictures and flow fields as plain types. The files that hold them are read and written by the module `io`, which needs
//! the feature `io`.

mod size;
mod types;

pub use crate::raster::{PixelFormat, Size};
pub use types::{FlowField, Frame, Image, Plane, UNKNOWN_FLOW};
