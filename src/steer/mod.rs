//! From what the view says to bank and climb: danger over the directions around, and the command that avoids it.
//!
//! All of it is host work on a few hundred sectors, and knows no simulator: an aircraft feeds it its own attitude, airspeed
//! and the sectors of a [`Pipeline`](crate::Pipeline), a frame at a time.
//!
//! Frames: the body's is x forward, y right, z down; the level frame is north, east, down, so that yaw is clockwise from
//! north. Bank is positive with the right wing down, climb upwards.
//!
//! A frame's sectors become a [`DangerMap`], levelled with the horizon and along the direction of motion; its sectors
//! become balls at the distance that the airspeed gives their time to contact; and the balls are what is to be passed.

mod aircraft;
mod arc;
mod command;
mod config;
mod map;
mod names;
mod observation;
mod obstacles;
mod simple;
mod steering;

pub use aircraft::{Aircraft, Response};
pub use arc::Arc;
pub use command::Command;
pub use config::{Danger, OnInvalid, Policy, SteerConfig, SteerParams, Weights};
pub use map::DangerMap;
pub use observation::{Goal, Observation, View};
pub use obstacles::Obstacle;
pub use steering::{Decision, Source, Steering};
