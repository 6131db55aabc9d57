//! The engine: streams, their limits, and what happens when things go wrong.

mod begin;
mod limits;
mod loss;
mod pictures;
mod stats;
mod stream;
