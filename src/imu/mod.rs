//! Gyros: their samples, and the camera's rotation between two exposures.
//!
//! ```
//! use glam::DVec3;
//! use viewsphere::imu::{Gyro, GyroConfig, GyroFault, GyroSample};
//!
//! # fn main() -> viewsphere::Result<()> {
//! let mut gyro = Gyro::new(GyroConfig::default())?;
//! for i in 0..=20 {
//!     // 200 Hz, 0.5 rad/s about the camera's y axis (down): a rotation to the right.
//!     gyro.push(GyroSample { time_s: f64::from(i) * 0.005, gyro_rad_s: DVec3::new(0.0, 0.5, 0.0) });
//! }
//! let prev_from_cur = gyro.prev_from_cur(0.02, 0.06).expect("covered by the samples");
//! // What is straight ahead now was 0.02 rad to the right in the previous frame.
//! let before = prev_from_cur * DVec3::Z;
//! assert!((before.x.atan2(before.z) - 0.02).abs() < 1e-12);
//! assert!(matches!(gyro.prev_from_cur(0.08, 0.12), Err(GyroFault::NotCovered { .. })));
//! # Ok(())
//! # }
//! ```
//!
//! Log files are read by `io::gyro_log`, which needs the feature `io`.

mod config;
mod fault;
mod gyro;
mod history;

pub use config::{GyroConfig, GyroSample};
pub use fault::GyroFault;
pub use gyro::Gyro;
