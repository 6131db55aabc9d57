//! The kernels: each shader against its reference, against deliberate mistakes, and against formulas.
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

mod both_sides;
mod mutations;
#[path = "../common/need.rs"]
mod need;
mod sides;
mod sphere;
