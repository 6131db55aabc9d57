//! The engine: streams, their limits, and what happens when things go wrong.
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

mod begin;
#[path = "../common/mod.rs"]
mod common;
mod figures;
mod limits;
mod loss;
mod pictures;
mod stream;
