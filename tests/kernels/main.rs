//! The kernels: each shader is compared with its reference, with deliberate mistakes, and with formulas.
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

mod both_sides;
mod flops;
mod gpu;
mod mutations;
#[path = "../common/need.rs"]
mod need;
mod points;
mod sides;
mod sphere;
