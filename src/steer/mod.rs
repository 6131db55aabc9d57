//! From what the view says to bank and climb: danger over the directions around, and the command that avoids it.
//!
//! All of it is host work on a few hundred sectors, and knows no simulator: an aircraft feeds it its own attitude, airspeed
//! and the sectors of a [`Pipeline`](crate::Pipeline).
//!
//! Frames: the body's is x forward, y right, z down; the level frame is north, east, down, so that yaw is clockwise from
//! north. Bank is positive with the right wing down, climb upwards.

mod command;

pub use command::Command;
