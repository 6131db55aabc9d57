//! The closed loop: what the sensor sees becomes a command, the command moves the vehicle, and the sensor sees
//! something else.
//!
//! A [`Flight`] takes a [`Course`](crate::sim::Course) and a [`FlightConfig`] with the vehicle, the sensor and the
//! steering. It advances frame by frame until the goal is reached or something else ends it. The same course and
//! configuration give the same records, bit for bit, on the same machine and adapter.

mod accuracy;
mod body;
mod camera_sensor;
mod cell_truth;
mod clock;
mod config;
mod cost;
mod fault;
mod measure;
mod perception;
mod record;
mod run;
mod sensor;
mod sensor_model;
mod summary;
mod true_flow;
mod true_sensor;

pub use accuracy::{Divergences, Measured};
pub use body::Body;
pub use clock::FRAME_S;
pub(crate) use config::resized;
pub use config::{FlightConfig, MAX_LATENCY_FRAMES, camera, camera_of_fov};
pub use cost::Cost;
pub use fault::{Fault, FaultKind};
pub use record::Record;
pub use run::{Flight, FlightFrame};
pub use sensor::{FlowNoise, Sensor};
pub use summary::{Outcome, Summary};
