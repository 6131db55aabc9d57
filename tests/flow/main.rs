//! From files and frames to flow: readers, cameras, gyros, flow fields compared with OpenCV's and the truth, the
//! engine, the pipeline on recorded flights, and steering.
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

mod atomic;
mod backward;
mod camera;
mod certainty;
mod confidence;
#[path = "../common/data.rs"]
mod data;
mod determinism;
mod energy;
mod engine;
mod estimators;
mod euroc;
mod horn_schunck;
mod imu;
mod increments;
#[path = "../common/need.rs"]
mod need;
mod opencv_fields;
mod opencv_points;
mod pair;
mod public_pairs;
#[path = "../common/quantile.rs"]
mod quantile;
mod readers;
mod robot;
mod steer;
mod tracker;
