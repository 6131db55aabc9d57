use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::fs;
use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::line::problem;
use super::{Ended, JobResult, Table, fingerprint};
use crate::error::{Error, Result};
use crate::io::write_atomic;
use crate::sim::flight::FlightConfig;

/// The configuration that all results of a file share: its first line.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Configuration {
    /// This crate's version.
    viewsphere: String,
    /// The fingerprint of everything that the jobs do not state.
    fingerprint: String,
    /// The chosen settings, as text for people.
    settings: String,
}

/// The results of distinct jobs.
#[derive(Clone, Debug, PartialEq)]
pub struct Results {
    configuration: Configuration,
    by_key: BTreeMap<String, JobResult>,
}

impl Configuration {
    /// The configuration of flights with the base configuration `base`. `settings` describes the chosen settings.
    ///
    /// # Errors
    /// As [`fingerprint`].
    pub fn new(base: &FlightConfig, settings: String) -> Result<Self> {
        let fingerprint = fingerprint(base)?;
        Ok(Self { viewsphere: env!("CARGO_PKG_VERSION").to_owned(), fingerprint, settings })
    }

    /// Checks that the results of another file have this configuration.
    ///
    /// # Errors
    /// [`Error::Format`] with both versions and configurations.
    pub(super) fn check(&self, path: &Path, found: &Self) -> Result<()> {
        let name =
            |c: &Self| format!("that of version {} with {} ({})", c.viewsphere, c.settings, c.fingerprint);
        if self == found {
            return Ok(());
        }
        Err(Error::format(path, "configuration", name(found), name(self)))
    }
}

impl Results {
    /// An empty set of results.
    pub fn new(configuration: Configuration) -> Self {
        Self { configuration, by_key: BTreeMap::new() }
    }

    /// Reads a file of results. An incomplete last line, left by an interrupted write, is dropped.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Format`] naming the line that is not a result, or that contradicts an earlier one.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let text = fs::read(path).map_err(|source| Error::io(path, source))?;
        Ok(Self::parse(path, &text)?.0)
    }

    /// Parses the content of a file. Also returns the length of its complete lines in bytes.
    pub(super) fn parse(path: &Path, text: &[u8]) -> Result<(Self, usize)> {
        let whole = text.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
        let wrong = |number: usize, why: String| {
            let found = format!("broken in line {number}, {why}");
            Error::format(path, "results file", found, "a result as campaign writes it")
        };
        let mut lines = text[..whole].split_inclusive(|&byte| byte == b'\n').enumerate();
        let read = |(i, line): (usize, &[u8])| {
            let text = std::str::from_utf8(line).map_err(|error| wrong(i + 1, error.to_string()))?;
            Ok(text.trim_end().to_owned())
        };
        let first = lines.next().map(read).transpose()?.unwrap_or_default();
        let configuration = serde_json::from_str(&first)
            .map_err(|error| wrong(1, format!("no configuration: {}", problem(&error))))?;
        let mut results = Self::new(configuration);
        for line in lines {
            let result = JobResult::from_line(&read(line)?).map_err(|why| wrong(line.0 + 1, why))?;
            results.add(path, result)?;
        }
        Ok((results, whole))
    }

    /// Adds the result of a job. A flown result replaces a failed one; an equal one changes nothing.
    ///
    /// # Errors
    /// [`Error::Format`] naming the file if the job was flown before with another result.
    pub fn add(&mut self, path: impl AsRef<Path>, result: JobResult) -> Result<()> {
        match self.by_key.entry(result.job.key()) {
            Entry::Vacant(entry) => {
                entry.insert(result);
            }
            Entry::Occupied(mut entry) => match (&entry.get().ended, &result.ended) {
                (Ended::Failed(_), _) => {
                    entry.insert(result);
                }
                (_, Ended::Failed(_)) => (),
                _ => {
                    let broken = |error| Error::io(path.as_ref(), io::Error::other(error));
                    if let Some([before, now]) = entry.get().differences(&result).map_err(broken)? {
                        let found = format!("that of {} with {now}", entry.key());
                        let expected = format!("the one already present, with {before}");
                        return Err(Error::format(path, "result", found, expected));
                    }
                }
            },
        }
        Ok(())
    }

    /// Checks that the flow of all flights by images was computed on this adapter, since adapters round differently and
    /// a row of the table must be of one adapter.
    ///
    /// # Errors
    /// [`Error::Format`] naming the file and both adapters.
    pub fn check_adapter(&self, path: impl AsRef<Path>, name: &str) -> Result<()> {
        let flown = self.by_key.values().filter(|result| matches!(result.ended, Ended::Flown(_)));
        match flown.filter_map(|result| result.adapter.as_deref()).find(|adapter| *adapter != name) {
            Some(other) => {
                let expected = format!("{name}, the adapter of this run; or another folder");
                Err(Error::format(path, "adapter of its flights", other, expected))
            }
            None => Ok(()),
        }
    }

    /// Adds all results of another file.
    ///
    /// # Errors
    /// As in [`Results::add`]; [`Error::Format`] if they are of another version or configuration.
    pub fn merge(&mut self, path: impl AsRef<Path>, other: Self) -> Result<()> {
        let path = path.as_ref();
        self.configuration.check(path, &other.configuration)?;
        other.by_key.into_values().try_for_each(|result| self.add(path, result))
    }

    /// The shared configuration.
    pub fn configuration(&self) -> &Configuration {
        &self.configuration
    }

    /// Whether a job was flown. A failed one counts as not flown, so that it is retried.
    pub fn has_flown(&self, key: &str) -> bool {
        self.by_key.get(key).is_some_and(|result| matches!(result.ended, Ended::Flown(_)))
    }

    /// All results, in the order of [`Job::order`](super::Job::order).
    pub fn sorted(&self) -> Vec<&JobResult> {
        let mut all: Vec<&JobResult> = self.by_key.values().collect();
        all.sort_by(|a, b| a.job.order(&b.job));
        all
    }

    /// The table of the results.
    pub fn table(&self) -> Table {
        Table::of(&self.sorted())
    }

    /// Writes the results in order, so that the same results give the same file.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn write(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        write_atomic(path, |out| {
            let mut put = |text: String| writeln!(out, "{text}").map_err(|source| Error::io(path, source));
            put(json(path, &self.configuration)?)?;
            self.sorted().into_iter().try_for_each(|result| put(line(path, result)?))
        })
    }
}

/// A result as a line; an error names the file.
pub(super) fn line(path: &Path, result: &JobResult) -> Result<String> {
    result.to_line().map_err(|error| Error::io(path, io::Error::other(error)))
}

/// A value as a line of JSON; an error names the file.
pub(super) fn json(path: &Path, value: &impl Serialize) -> Result<String> {
    serde_json::to_string(value).map_err(|error| Error::io(path, io::Error::other(error)))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::super::testing::{failed, flown};
    use super::*;
    use crate::sim::flight::Outcome;

    fn results(all: impl IntoIterator<Item = JobResult>) -> Results {
        let mut results =
            Results::new(Configuration::new(&FlightConfig::default(), "defaults".to_owned()).unwrap());
        all.into_iter().for_each(|result| results.add("a", result).unwrap());
        results
    }

    fn reached(world: &str, seed: u64) -> JobResult {
        flown(world, seed, Outcome::Reached, seed as f64 / 3.0)
    }

    #[test]
    fn the_same_results_are_the_same_file_in_whatever_order_they_come() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let all: Vec<JobResult> =
            (0..12).map(|seed| reached(["wall", "city"][seed as usize % 2], seed)).collect();
        results(all.clone()).write(path("a")).unwrap();
        let mut merged = results(all[7..].iter().cloned());
        merged.merge("b", results(all[..9].iter().rev().cloned())).unwrap();
        merged.write(path("b")).unwrap();
        let [a, b] = ["a", "b"].map(|name| fs::read_to_string(path(name)).unwrap());
        assert_eq!(a, b);
        assert_eq!(Results::read(path("a")).unwrap(), results(all));
    }

    #[test]
    fn what_was_flown_takes_the_place_of_what_failed() {
        for all in [[failed("wall", 1), reached("wall", 1)], [reached("wall", 1), failed("wall", 1)]] {
            let results = results(all);
            assert!(results.has_flown(&reached("wall", 1).job.key()));
            assert_eq!(results.sorted(), [&reached("wall", 1)]);
        }
        assert!(!results([failed("wall", 1)]).has_flown(&failed("wall", 1).job.key()));
    }

    #[test]
    fn results_that_contradict_each_other_are_refused() {
        let mut one = results([reached("wall", 1)]);
        one.merge("b", results([reached("wall", 1)])).unwrap();
        let other = results([flown("wall", 1, Outcome::Crashed, 0.5)]);
        let error = one.merge("b", other).unwrap_err().to_string();
        let key = reached("wall", 1).job.key();
        let figures = |least, low, outcome| {
            format!("least_clearance_m {least}, low_clearance_m {low}, outcome \"{outcome}\"")
        };
        let expected = format!(
            "b: result is that of {key} with {}, expected the one already present, with {}",
            figures("0.5", "0.8333333333333333", "crashed"),
            figures("0.3333333333333333", "0.6666666666666666", "reached"),
        );
        assert_eq!(error, expected);
    }

    #[test]
    fn results_of_another_configuration_are_refused() {
        let mut one = results([]);
        let base = FlightConfig { radius_m: 0.7, ..FlightConfig::default() };
        let other = Results::new(Configuration::new(&base, "a large plane".to_owned()).unwrap());
        let error = one.merge("b", other).unwrap_err().to_string();
        assert!(error.starts_with("b: configuration") && error.contains("a large plane"), "{error}");
    }

    #[test]
    fn a_line_that_is_no_result_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        results([reached("wall", 1), reached("wall", 2)]).write(&path).unwrap();
        let text = fs::read_to_string(&path).unwrap();
        for (wrong, words) in [
            (text.replacen("\"seed\":2", "\"seed\":x", 1), "broken in line 3, expected value at column "),
            (text.replacen("viewsphere", "v", 1), "broken in line 1, no configuration: unknown field `v`"),
            (String::new(), "broken in line 1"),
            ("{\"viewsphere\"".to_owned(), "broken in line 1"),
            (text.clone() + "{\"world\":\n", "broken in line 4, EOF while parsing a value at column 9"),
        ] {
            fs::write(&path, wrong).unwrap();
            let error = Results::read(&path).unwrap_err().to_string();
            assert!(error.contains(words) && !error.contains('\n'), "{error}");
        }
    }

    #[test]
    fn flights_of_another_adapter_are_told_from_those_without_one_and_those_that_failed() {
        let by = |mut result: JobResult, adapter: Option<&str>| {
            result.adapter = adapter.map(str::to_owned);
            result
        };
        let all = [
            by(reached("wall", 1), None),
            by(reached("wall", 2), Some("one")),
            by(failed("wall", 3), Some("other")),
        ];
        let results = results(all);
        assert!(results.check_adapter("a", "one").is_ok());
        let error = results.check_adapter("a/results.jsonl", "other").unwrap_err().to_string();
        assert!(["a/results.jsonl", "one", "other"].iter().all(|word| error.contains(word)), "{error}");
    }
}
