//! Steering: from the sectors of the view to commands of bank and climb that avoid obstacles.
//!
//! Steering runs on the host, on a few hundred sectors, and is independent of the simulator: an aircraft passes its
//! own attitude, airspeed and the sectors of a [`Pipeline`](crate::Pipeline), frame by frame.
//!
//! Frames: the body's is x forward, y right, z down; the level frame is north, east, down, so that yaw is clockwise
//! from north. Bank is positive with the right wing down, climb is positive upwards.
//!
//! A frame's sectors update a [`DangerMap`], levelled with the horizon and aligned with the direction of motion. Near
//! sectors become obstacles: balls at the distance that follows from airspeed and time to contact. Whole columns of the map
//! are read at a time ([`Reading::Columns`]), as a thin trunk is not known in all of its sectors.

mod aircraft;
mod arc;
mod columns;
mod command;
mod config;
mod map;
mod names;
mod observation;
mod obstacles;
mod parameters;
mod simple;
mod steering;

pub use aircraft::{Aircraft, Response};
pub use arc::Arc;
pub use command::Command;
pub use config::{Danger, OnInvalid, Policy, Reading, SteerConfig, SteerParams, Weights};
pub use map::DangerMap;
pub use observation::{Goal, Observation, View};
pub use obstacles::Obstacle;
pub use steering::{Decision, Source, Steering};
