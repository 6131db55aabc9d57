//! Benchmarks: the time of a frame, of a pair, of each kernel and of whole pipelines, on one backend.
//!
//! Times depend on the machine and on what else it does: compare only those that were measured in one run.

mod copy;
mod figures;
mod pair;
mod pipelines;
mod processor_time;
mod stream;
mod times;

pub use figures::{KernelFigures, Startup, StreamFigures};
pub use pair::pair_time;
pub use pipelines::{Contender, PipelineFigures, pipelines};
pub use stream::stream;
pub use times::Times;
pub(crate) use times::timed;
