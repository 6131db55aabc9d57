//! Images and flow fields as plain types. Their files are read and written by the module `io`, which needs the
//! feature `io`.

mod size;
mod types;

pub use crate::raster::{PixelFormat, Size};
pub use types::{FlowField, Frame, Image, Plane, UNKNOWN_FLOW};
