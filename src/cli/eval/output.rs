//! The results in every format.

use std::path::Path;

use super::json::TableFigures;
use super::literature::NamedTable;
use super::maps::Maps;
use super::{page, text};
use crate::cli::{Outcome, input, print};
use crate::error::{Error, Result};
use crate::eval::{BAD_PX, Ended, PairResult, Table};
use crate::io::{check_writable, write_bytes};
use crate::journal::{Configuration, Results};

/// The results file.
pub(super) const RESULTS: &str = "results.jsonl";

/// Where the results go beside standard output.
pub(super) struct Output<'a> {
    pub(super) folder: Option<&'a Path>,
    /// A file, or `-` for standard output.
    pub(super) json: Option<&'a Path>,
    pub(super) csv: Option<&'a Path>,
    pub(super) html: Option<&'a Path>,
    pub(super) baseline: Option<&'a str>,
    /// What to print in place of the general tables.
    pub(super) table: Option<NamedTable>,
}

/// What all results of a journal have in common.
pub(super) fn configuration(is_timed: bool) -> Result<Configuration> {
    let settings = if is_timed { "with times" } else { "without times" };
    Configuration::new(&("eval", BAD_PX, is_timed), settings.to_owned())
}

impl Output<'_> {
    fn prints_json(&self) -> bool {
        self.json == Some(Path::new(super::STDOUT))
    }

    /// The single files, each with its flag.
    fn files(&self) -> impl Iterator<Item = (&'static str, &Path)> {
        let json = self.json.filter(|_| !self.prints_json());
        let all = [("--json", json), ("--csv", self.csv), ("--html", self.html)];
        all.into_iter().filter_map(|(flag, path)| Some((flag, path?)))
    }

    /// Checks that everything can be written, before anything is computed.
    pub(super) fn check(&self) -> Result<()> {
        for (flag, path) in self.files() {
            let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
            check_writable(folder.unwrap_or(Path::new(".")))?;
            if path.is_dir() {
                return Err(Error::parameter(flag, format_args!("{}, a folder", path.display()), "a file"));
            }
        }
        Ok(())
    }

    /// Writes and prints the tables. A failed evaluation is an error, returned after everything is written.
    pub(super) fn finish(&self, results: &Results<PairResult>, maps: &Maps) -> Result<Outcome> {
        let sorted = results.sorted();
        let table = Table::of(&sorted, self.baseline);
        let html = || page::html(&table, &sorted, maps);
        let json = || Ok::<_, Error>(print::pretty(&TableFigures::of(&table))? + "\n");
        if let Some(folder) = self.folder {
            input::within(folder, || {
                write_bytes(folder.join("table.csv"), text::csv(&table).as_bytes())?;
                write_bytes(folder.join("table.json"), json()?.as_bytes())?;
                write_bytes(folder.join("report.html"), html()?.as_bytes())
            })?;
        }
        for (flag, path) in self.files() {
            let content = match flag {
                "--json" => json()?,
                "--csv" => text::csv(&table),
                _ => html()?,
            };
            write_bytes(path, content.as_bytes())?;
        }
        if self.prints_json() {
            print::json(&TableFigures::of(&table))?;
        } else {
            print::text(&self.table.map_or_else(|| text::text(&table), |named| named.text(&table)))?;
        }
        let mut failed = sorted.into_iter().filter_map(|result| match &result.ended {
            Ended::Failed(reason) => Some((result.job.key(), reason)),
            Ended::Scored { .. } => None,
        });
        match failed.next() {
            None => Ok(Outcome::Done),
            Some((key, reason)) => {
                let expected = format!("none; the first is {key}: {reason}");
                Err(Error::parameter("number of evaluations that failed", failed.count() + 1, expected))
            }
        }
    }
}
