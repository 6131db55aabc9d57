//! The engine: streams, their limits, and what happens when things go wrong.

mod begin;
mod figures;
mod limits;
mod loss;
mod pictures;
mod stream;
