//! Campaigns: many flights, and their statistics.
//!
//! A [`Campaign`] lists worlds, sensors, policies and so on. Every combination of them is a [`Setting`], and a
//! setting with a seed is a [`Job`]. [`fly_all`] flies jobs on threads, and a [`Table`] has a row per setting.
//! `Results`, which needs the features `io` and `serde`, stores results in a file, so that a campaign can be
//! interrupted and resumed, or split and merged.

mod faults;
#[cfg(feature = "serde")]
mod fingerprint;
mod job;
#[cfg(all(feature = "io", feature = "serde"))]
mod journal;
#[cfg(all(feature = "io", feature = "serde"))]
mod line;
mod result;
#[cfg(all(feature = "io", feature = "serde"))]
mod results;
mod run;
mod schedule;
mod statistics;
mod table;
#[cfg(test)]
mod testing;

pub use faults::Faults;
#[cfg(feature = "serde")]
pub use fingerprint::fingerprint;
pub use job::{Job, Setting};
#[cfg(all(feature = "io", feature = "serde"))]
pub use journal::{Journal, Opened};
pub use result::{Ended, JobResult};
#[cfg(all(feature = "io", feature = "serde"))]
pub use results::{Configuration, Results};
pub use run::{Open, fly_all};
pub use schedule::{Campaign, Shard};
pub use statistics::wilson;
pub use table::{Row, Table};
