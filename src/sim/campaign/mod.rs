//! Many flights, and what they say together.
//!
//! A [`Campaign`] is lists of worlds, sensors, policies and so on; every combination of them is a [`Setting`], and that
//! with a seed is a [`Job`]. [`fly_all`] flies jobs on threads, and a [`Table`] has a row for each setting. `Results`, which
//! needs the features `io` and `serde`, keeps what was flown in a file, so that a campaign can be interrupted, shared out and put
//! together again.

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
