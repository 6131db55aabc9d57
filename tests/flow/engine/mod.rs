//! The engine: streams, their limits, and their failures.

mod begin;
mod limits;
mod loss;
mod pictures;
mod stats;
mod stream;
