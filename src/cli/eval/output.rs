//! The results in every format.

use std::collections::BTreeSet;
use std::path::Path;

use super::json::TableFigures;
use super::literature::NamedTable;
use super::maps::Maps;
use super::{page, text};
use crate::cli::place::{Allowed, Place};
use crate::cli::{Outcome, input, paths, print};
use crate::error::{Error, Result};
use crate::eval::{BAD_PX, PairResult, Table};
use crate::io::write_bytes;
use crate::journal::{Configuration, Results};

/// The results file.
pub(super) const RESULTS: &str = "results.jsonl";
/// The files in a folder of results.
const FILES: [&str; 4] = [RESULTS, "table.csv", "table.json", "report.html"];

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
    let settings = if is_timed { "times, --repeats 1 or more" } else { "no times, --repeats 0" };
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
        let mut single = Vec::new();
        for (flag, path) in self.files() {
            let kind: &[&str] = match flag {
                "--json" => &["json"],
                "--csv" => &["csv"],
                _ => &["html"],
            };
            single.push((flag, Allowed::file(kind).place(flag, path)?));
        }
        let in_folder = self.folder.map(|folder| FILES.map(|name| Place::File(folder.join(name))));
        let results: Vec<_> = (in_folder.iter().flatten().map(|place| ("-o", Some(place))))
            .chain(single.iter().map(|(flag, place)| (*flag, Some(place))))
            .collect();
        paths::are_apart(&results, [])?;
        let single: Vec<_> = single.iter().map(|(flag, place)| (*flag, Some(place))).collect();
        paths::check(&single, [])?;
        match self.folder {
            None => Ok(()),
            Some(folder) => {
                input::folder(folder)?;
                let is_own = folder.join(RESULTS).is_file();
                paths::of_an_earlier_run(folder, &FILES, is_own, "the results.jsonl of an earlier eval")
            }
        }
    }

    /// Checks that the baseline is among the results.
    pub(super) fn check_baseline(&self, results: &Results<PairResult>) -> Result<()> {
        let known: BTreeSet<&str> = results.all().map(|result| result.job.run.as_str()).collect();
        match self.baseline.filter(|baseline| !known.contains(baseline)) {
            None => Ok(()),
            Some(baseline) => {
                let known: Vec<&str> = known.into_iter().collect();
                let expected = format!("one of the runs: {}", known.join(", "));
                Err(Error::parameter("--baseline", baseline, expected))
            }
        }
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
        let mut failed = sorted.into_iter().filter_map(|result| Some((result.job.key(), result.failure()?)));
        match failed.next() {
            None => Ok(Outcome::Done),
            Some((key, reason)) => {
                let expected = format!("none; the first is {key}: {reason}");
                Err(Error::parameter("number of evaluations that failed", failed.count() + 1, expected))
            }
        }
    }
}
