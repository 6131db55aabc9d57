//! Campaigns: many flights, and their statistics.
//!
//! A [`Campaign`] lists worlds, sensors, policies and so on. Every combination of them is a [`Setting`], and a
//! setting with a seed is a [`Job`]. [`fly_all`] flies jobs on threads, and a [`Table`] has a row per setting. [`compare`]
//! compares two settings on the same seeds.
//! `Results` and `Journal`, which need the features `io` and `serde`, store results in a file, so that a campaign can be
//! interrupted and resumed, or split and merged (`journal`).

mod compare;
mod faults;
mod job;
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
pub(crate) mod testing;

pub use compare::{Comparison, Only, compare};
pub use faults::Faults;
pub use job::{Job, PART_NAMES, Setting};
pub use result::{Ended, JobResult};
#[cfg(all(feature = "io", feature = "serde"))]
pub use results::{Journal, Results};
pub use run::{Open, fly_all};
pub use schedule::Campaign;
pub use statistics::{mcnemar, paired_interval, wilson};
pub use table::{Row, Table};
