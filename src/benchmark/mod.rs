//! Benchmarks: the time of a frame, of each kernel and of whole pipelines, on one backend.
//!
//! Times depend on the machine and on what else it does: compare only those that were measured in one run.

mod copy;
mod figures;
mod pipelines;
mod stream;
mod times;

pub use figures::{KernelFigures, Startup, StreamFigures};
pub use pipelines::{Contender, PipelineFigures, pipelines};
pub use stream::stream;
pub use times::Times;
#[cfg(feature = "cli")]
pub(crate) use times::timed;
