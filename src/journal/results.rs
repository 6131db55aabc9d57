use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry as Place;
use std::fs;
use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::{fingerprint, problem};
use crate::error::{Error, Result};
use crate::io::write_atomic;

/// The result of a job, which a journal holds as a line.
pub trait Entry: Clone + PartialEq {
    /// The job's unique key.
    fn key(&self) -> String;

    /// Whether the job failed with an error: it is retried, and its result replaced.
    fn is_failure(&self) -> bool;

    /// The order of the results in a file that is complete.
    fn order(&self, other: &Self) -> Ordering;

    /// The result as one line of JSON, without its end.
    ///
    /// # Errors
    /// Those of the serializer.
    fn to_line(&self) -> serde_json::Result<String>;

    /// Parses the output of [`Entry::to_line`].
    ///
    /// # Errors
    /// The reason why the text is no result, in one line.
    fn from_line(text: &str) -> std::result::Result<Self, String>;

    /// The fields in which the results of one job contradict each other, with the values of each; `None` if they agree.
    ///
    /// # Errors
    /// Those of the serializer.
    fn differences(&self, other: &Self) -> serde_json::Result<Option<[String; 2]>>;
}

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
pub struct Results<T> {
    configuration: Configuration,
    by_key: BTreeMap<String, T>,
}

impl Configuration {
    /// The configuration of jobs with everything in `base`, which no job states. `settings` describes the chosen
    /// settings.
    ///
    /// # Errors
    /// As [`fingerprint`].
    pub fn new(base: &impl Serialize, settings: String) -> Result<Self> {
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

impl<T: Entry> Results<T> {
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
            Error::format(path, "results file", found, "a result as viewsphere writes it")
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
            let result = T::from_line(&read(line)?).map_err(|why| wrong(line.0 + 1, why))?;
            results.add(path, result)?;
        }
        Ok((results, whole))
    }

    /// Adds the result of a job. It replaces a failure; an equal one changes nothing.
    ///
    /// # Errors
    /// [`Error::Format`] naming the file if the job has another result already.
    pub fn add(&mut self, path: impl AsRef<Path>, result: T) -> Result<()> {
        match self.by_key.entry(result.key()) {
            Place::Vacant(place) => {
                place.insert(result);
            }
            Place::Occupied(mut place) => match (place.get().is_failure(), result.is_failure()) {
                (true, _) => {
                    place.insert(result);
                }
                (false, true) => (),
                (false, false) => {
                    let broken = |error| Error::io(path.as_ref(), io::Error::other(error));
                    if let Some([before, now]) = place.get().differences(&result).map_err(broken)? {
                        let found = format!("that of {} with {now}", place.key());
                        let expected = format!("the one already present, with {before}");
                        return Err(Error::format(path, "result", found, expected));
                    }
                }
            },
        }
        Ok(())
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

    /// The result of a job, unless it failed.
    pub fn get(&self, key: &str) -> Option<&T> {
        self.by_key.get(key).filter(|result| !result.is_failure())
    }

    /// All results, in no particular order.
    pub fn all(&self) -> impl Iterator<Item = &T> {
        self.by_key.values()
    }

    /// All results, in [their order](Entry::order).
    pub fn sorted(&self) -> Vec<&T> {
        let mut all: Vec<&T> = self.by_key.values().collect();
        all.sort_by(|a, b| a.order(b));
        all
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
pub(super) fn line(path: &Path, result: &impl Entry) -> Result<String> {
    result.to_line().map_err(|error| Error::io(path, io::Error::other(error)))
}

/// The value as JSON on one line; errors name the file.
pub(super) fn json(path: &Path, value: &impl Serialize) -> Result<String> {
    serde_json::to_string(value).map_err(|error| Error::io(path, io::Error::other(error)))
}
