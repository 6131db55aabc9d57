use std::cmp::Ordering;
use std::path::Path;

use super::{Ended, JobResult, Table};
use crate::error::{Error, Result};
use crate::journal::{self, Entry};

/// The results of a campaign's jobs.
pub type Results = journal::Results<JobResult>;

/// The journal of a campaign.
pub type Journal = journal::Journal<JobResult>;

impl Entry for JobResult {
    fn key(&self) -> String {
        self.job.key()
    }

    fn is_failure(&self) -> bool {
        matches!(self.ended, Ended::Failed(_))
    }

    fn order(&self, other: &Self) -> Ordering {
        self.job.order(&other.job)
    }

    fn to_line(&self) -> serde_json::Result<String> {
        self.as_line()
    }

    fn from_line(text: &str) -> std::result::Result<Self, String> {
        Self::parsed(text)
    }

    fn differences(&self, other: &Self) -> serde_json::Result<Option<[String; 2]>> {
        self.contradictions(other)
    }
}

impl Results {
    /// Checks that the flow of all flights by images was computed on this adapter, since adapters round differently and
    /// a row of the table must be of one adapter.
    ///
    /// # Errors
    /// [`Error::Format`] naming the file and both adapters.
    pub fn check_adapter(&self, path: impl AsRef<Path>, name: &str) -> Result<()> {
        let flown = self.all().filter(|result| !result.is_failure());
        match flown.filter_map(|result| result.adapter.as_deref()).find(|adapter| *adapter != name) {
            Some(other) => {
                let expected = format!("{name}, the adapter of this run; or another folder");
                Err(Error::format(path, "adapter of its flights", other, expected))
            }
            None => Ok(()),
        }
    }

    /// Whether a job was flown. A failed one counts as not flown, so that it is retried.
    pub fn has_flown(&self, key: &str) -> bool {
        self.get(key).is_some()
    }

    /// The table of the results.
    pub fn table(&self) -> Table {
        Table::of(&self.sorted())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::fs;

    use super::super::testing::{failed, flown};
    use super::*;
    use crate::journal::Configuration;
    use crate::sim::flight::FlightConfig;
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
            let touches = u32::from(outcome == "crashed");
            format!(
                "least_clearance_m {least}, low_clearance_m {low}, outcome \"{outcome}\", touches {touches}"
            )
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
