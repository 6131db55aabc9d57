//! Vehicles, wind, and on-board sensors.
//!
//! Worlds are in NED (north, east, down), bodies in FRD (forward, right, down). A [`Vehicle`] follows a
//! [`Command`](crate::steer::Command) step by step: [`CoordinatedTurn`] is a point whose bank follows with a lag,
//! [`Airframe`] a rigid body in the air with an inner control loop.
//!
//! ```
//! use glam::DVec3;
//! use viewsphere::sim::vehicle::{Airframe, AirframeParams, Autopilot, STEP_S, Start, Vehicle, Wind};
//! use viewsphere::steer::Command;
//!
//! # fn main() -> viewsphere::Result<()> {
//! let start = Start { position_ned_m: DVec3::new(0.0, 0.0, -20.0), yaw_rad: 0.0, speed_m_s: 12.0 };
//! let mut plane = Airframe::new(&AirframeParams::default(), &Autopilot::default(), &start, Wind::calm())?;
//! let to_the_right = Command { bank_rad: 45_f64.to_radians(), climb_rad: 0.0 };
//! for _ in 0..480 {
//!     plane.advance(&to_the_right, STEP_S);
//! }
//! // After two seconds it has turned by some 80° and kept its altitude.
//! let state = plane.state();
//! assert!(state.world_from_body.x_axis.y > 0.9);
//! assert!((state.position_ned_m.z + 20.0).abs() < 0.1);
//! # Ok(())
//! # }
//! ```

mod aerodynamics;
mod air_data;
mod airframe;
mod autopilot;
mod dynamics;
mod gyro;
mod params;
mod state;
mod stream;
mod trim;
mod turn;
mod wind;

pub use air_data::{AirspeedModel, VaneErrors, VaneModel, VerticalSpeedErrors, VerticalSpeedModel};
pub use airframe::Airframe;
pub use autopilot::Autopilot;
pub use dynamics::Controls;
pub use gyro::{GyroErrors, GyroModel, MAX_BIAS_RAD_S};
pub use params::AirframeParams;
pub use state::{GRAVITY_M_S2, MAX_STEP_S, STEP_S, Start, Vehicle, VehicleState};
pub use trim::Trim;
pub use turn::{CoordinatedTurn, TurnParams};
pub use wind::{Gusts, MAX_WIND_M_S, Wind};
