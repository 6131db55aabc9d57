//! Sparse optical flow: points followed from frame to frame (pyramidal Lucas–Kanade), and tracks over a sequence.
//!
//! J.-Y. Bouguet, Pyramidal implementation of the Lucas Kanade feature tracker, 2001, with the parameters and semantics of
//! OpenCV's `calcOpticalFlowPyrLK`. [`PointTracker`] follows given points into the next frame. [`Tracker`] detects
//! [corners](crate::features), follows them over a sequence, ends tracks that are lost or that do not lead back
//! (forward–backward error, Kalal, Mikolajczyk and Matas, ICPR 2010), and detects new corners where too few are left.
//!
//! ```
//! use viewsphere::Backend;
//! use viewsphere::frame::{Frame, PixelFormat, Size};
//! use viewsphere::tracking::{TrackStatus, Tracker, TrackerConfig};
//!
//! # fn main() -> viewsphere::Result<()> {
//! let size = Size::new(96, 80);
//! let texture = |x: u32, y: u32| 128.0 + 60.0 * (f64::from(x) * 0.4).sin() + 60.0 * (f64::from(y) * 0.5).cos();
//! let mut tracker = Tracker::new(&Backend::Cpu, size, PixelFormat::Gray8, &TrackerConfig::default())?;
//! for shift in 0..3 {
//!     let pixels: Vec<u8> = (0..96 * 80).map(|i| texture(i % 96 + shift, i / 96) as u8).collect();
//!     let frame = Frame::new(size, PixelFormat::Gray8, &pixels)?;
//!     for track in tracker.process(&frame, None)? {
//!         if track.status == TrackStatus::Tracked && (20.0..76.0).contains(&track.x) {
//!             // The texture has moved by one pixel to the left since the last frame.
//!             assert!((track.shift[0] + 1.0).abs() < 0.1 && track.shift[1].abs() < 0.1, "{track:?}");
//!         }
//!     }
//! }
//! # Ok(())
//! # }
//! ```

mod parameters;
mod plan;
mod points;
mod tracker;

pub use parameters::TrackParameters;
pub use plan::{MAX_POINTS, plan, pyramid};
pub use points::{PointTracker, TrackedPoint};
pub use tracker::{Track, TrackStatus, Tracker, TrackerConfig};
