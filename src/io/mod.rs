//! Files: images, videos, flow fields, cameras and gyro logs. Enabled by the feature `io`.
//!
//! Every format has its own module, with `decode` and `encode` over bytes and `read` and `write` over files. Readers
//! check a header against the length of the file before they allocate memory for it. Files are written atomically
//! ([`write_atomic`]).

pub mod camera;
pub mod flo;
mod flow_file;
pub mod frame_times;
mod frames;
pub mod gyro_log;
pub mod kitti;
pub mod npy;
mod npy_header;
mod pattern;
pub mod picture;
pub mod points;
mod raw;
mod read;
pub mod sequence;
mod y4m;
mod y4m_header;
mod y4m_write;

#[cfg(feature = "cli")]
pub(crate) use crate::atomic_file::discard_and_exit;
pub use crate::atomic_file::{check_creatable, check_writable, remove, write_atomic, write_bytes};
pub use flow_file::{read_flow, write_flow};
pub use frames::Frames;
pub use raw::RawReader;
pub(crate) use read::read_file;
pub use y4m::Y4mReader;
pub use y4m_write::Y4mWriter;
