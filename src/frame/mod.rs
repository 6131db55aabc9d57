//! Pictures and flow fields as plain types, and the files that hold them.
//!
//! Every format has its own module, with `decode` and `encode` over bytes and `read` and `write` over files. What is
//! read is checked against the length of the file before memory is taken for it, and files are written whole or not at
//! all.

mod arrows;
mod colour;
mod draw;
pub mod flo;
mod flow_file;
mod frames;
pub mod kitti;
pub mod npy;
mod npy_header;
mod pattern;
pub mod picture;
mod raw;
mod read;
pub mod sequence;
mod size;
mod temporary;
mod types;
mod write;
mod y4m;
mod y4m_header;
mod y4m_write;

pub use arrows::arrows;
pub use colour::colour_wheel;
pub(crate) use draw::{line, luma};
pub use flow_file::{read_flow, write_flow};
pub use frames::Frames;
pub use raw::RawReader;
pub use size::Size;
#[cfg(feature = "cli")]
pub(crate) use temporary::discard_and_exit;
pub use types::{FlowField, Frame, Image, PixelFormat, Plane, UNKNOWN_FLOW};
pub use write::{check_writable, remove, write_atomic, write_bytes};
pub use y4m::Y4mReader;
pub use y4m_write::Y4mWriter;
