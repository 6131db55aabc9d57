//! Many flights, and what they say together.
//!
//! A [`Campaign`] is lists of worlds, sensors, policies and so on; every combination of them is a [`Setting`], and that
//! with a seed is a [`Job`]. [`fly_all`] flies jobs on threads, and a [`Table`] has a row for each setting. `Results`, which
//! needs the feature `cli`, keeps what was flown in a file, so that a campaign can be interrupted, shared out and put
//! together again.

mod faults;
#[cfg(feature = "cli")]
mod fingerprint;
mod job;
#[cfg(feature = "cli")]
mod journal;
#[cfg(feature = "cli")]
mod line;
mod plan;
mod result;
#[cfg(feature = "cli")]
mod results;
mod run;
mod statistics;
mod table;
#[cfg(test)]
mod testing;

pub use faults::Faults;
#[cfg(feature = "cli")]
pub use fingerprint::fingerprint;
pub use job::{Job, Setting};
#[cfg(feature = "cli")]
pub use journal::{Journal, Opened};
pub use plan::{Campaign, Shard};
pub use result::{Ended, JobResult};
#[cfg(feature = "cli")]
pub use results::{Configuration, Results};
pub use run::{Open, fly_all};
pub use statistics::wilson;
pub use table::{Row, Table};
