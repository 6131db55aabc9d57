//! Live intake: frames in turn or the newest one, their times, and a gyro's samples in step with them.
//!
//! A camera's thread puts frames into a [`LatestFrame`], and the thread that computes takes the newest:
//!
//! ```
//! use std::sync::Arc;
//! use std::time::Instant;
//! use viewsphere::frame::{Image, PixelFormat, Size};
//! use viewsphere::live::{LatestFrame, TimedFrame};
//!
//! # fn main() -> viewsphere::Result<()> {
//! let latest = Arc::new(LatestFrame::default());
//! let camera = latest.clone();
//! std::thread::spawn(move || {
//!     for number in 0..10 {
//!         let image = Image { size: Size::new(4, 2), format: PixelFormat::Gray8, data: vec![0; 8] };
//!         let time_s = number as f64 / 30.0;
//!         camera.put(&mut TimedFrame { image, number, time_s, arrived: Instant::now() });
//!     }
//!     camera.end(Ok(()));
//! });
//! let (mut frame, mut taken) = (TimedFrame::default(), 0);
//! while latest.take(&mut frame)? {
//!     taken += 1;
//! }
//! assert_eq!((frame.number, taken + latest.dropped()), (9, 10));
//! # Ok(())
//! # }
//! ```
//!
//! [`Intake`] reads a [`FrameSource`], such as the files of `io::Frames` (feature `io`), in the same way.

mod gyro;
mod intake;
mod latest;
mod times;

pub use gyro::GyroFeed;
pub use intake::{FrameSource, Intake, Pace, TimedFrames};
pub use latest::{LatestFrame, TimedFrame};
pub use times::{FrameRate, FrameTimes};
