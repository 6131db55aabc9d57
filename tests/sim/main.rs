//! The simulator and its users: ground truth, renderer, courses and vehicles, the pipeline on rendered images, and
//! whole flights.
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

mod approach;
mod courses;
mod flight;
mod flow_filter;
mod measured_flow;
#[path = "../common/need.rs"]
mod need;
mod pipeline;
#[path = "../common/quantile.rs"]
mod quantile;
mod renderer;
mod sample;
mod straight;
mod truth;
mod turning;
mod vehicle;
