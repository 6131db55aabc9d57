//! Pictures and flow fields as plain types, and the files that hold them.

mod size;
mod types;

pub use size::Size;
pub use types::{FlowField, Frame, Image, PixelFormat, Plane, UNKNOWN_FLOW};
