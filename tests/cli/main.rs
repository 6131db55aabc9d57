//! The program as its users run it: its files, its output and its exit codes.
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

mod campaign;
mod commands;
mod demo;
mod errors;
mod eval;
mod eval_errors;
mod feed;
mod fly;
mod interrupted;
#[path = "../common/need.rs"]
mod need;
mod program;
mod report;
mod run;
mod simulate;
mod track;
mod undistort;
