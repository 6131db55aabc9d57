//! The simulator, and what flies in it: its truth, its renderer, courses and vehicles, the pipeline on rendered pictures,
//! and whole flights.
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

mod approach;
mod courses;
mod flight;
mod measured_flow;
#[path = "../common/need.rs"]
mod need;
mod pipeline;
#[path = "../common/quantile.rs"]
mod quantile;
mod sample;
mod sight;
mod straight;
mod truth;
mod turning;
mod vehicle;
