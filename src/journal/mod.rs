//! Journals: results of many jobs as lines of a file, so that a long run can be interrupted and resumed, or split and
//! merged.
//!
//! A job's result is an [`Entry`]. [`Journal`] appends entries to a file one by one, [`Results`] holds those of distinct
//! jobs, and a [`Shard`] is a part of a list of jobs. The first line of a file is the [`Configuration`] that its entries
//! share. `sim::campaign` keeps flights in a journal, `viewsphere eval` the errors of flow fields.

mod file;
mod fingerprint;
mod results;
mod shard;

pub use file::{Journal, Opened};
pub use fingerprint::fingerprint;
pub use results::{Configuration, Entry, Results};
pub use shard::Shard;

/// The message of a parse error, with the column alone: the parser sees each line as line 1.
pub(crate) fn problem(error: &serde_json::Error) -> String {
    error.to_string().replace(" at line 1 column ", " at column ")
}
