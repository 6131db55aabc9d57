use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Write};
use std::marker::PhantomData;
use std::path::{Path, PathBuf};

use super::results::{json, line};
use super::{Configuration, Entry, Results};
use crate::error::{Error, Result};

/// A file to which one process appends results one by one. If that process is stopped at any moment, all lines but
/// the last one are complete.
#[derive(Debug)]
pub struct Journal<T> {
    file: File,
    path: PathBuf,
    of: PhantomData<T>,
}

/// An opened journal.
#[derive(Debug)]
pub struct Opened<T> {
    /// The journal, ready to append.
    pub journal: Journal<T>,
    /// The results already in it.
    pub results: Results<T>,
    /// Whether an incomplete last line was removed.
    pub repaired: bool,
}

impl<T: Entry> Journal<T> {
    /// Opens a journal of this configuration, or creates one together with its folder.
    ///
    /// # Errors
    /// [`Error::Io`], also if another process has it open; as in [`Results::read`]; [`Error::Format`] if it is of
    /// another version or configuration.
    pub fn open(path: impl AsRef<Path>, configuration: &Configuration) -> Result<Opened<T>> {
        let path = path.as_ref();
        let wrong = |source| Error::io(path, source);
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(|source| Error::io(folder, source))?;
        }
        let file = OpenOptions::new().create(true).read(true).append(true).open(path).map_err(wrong)?;
        file.try_lock().map_err(|error| match error {
            TryLockError::WouldBlock => wrong(io::Error::other("another process is appending to it")),
            TryLockError::Error(source) => wrong(source),
        })?;
        let mut journal = Self { file, path: path.to_owned(), of: PhantomData };
        // Read under the lock, when no other process appends to it.
        let mut text = Vec::new();
        journal.file.read_to_end(&mut text).map_err(wrong)?;
        let empty = Results::new(configuration.clone());
        let begun = json(path, configuration)?.into_bytes().starts_with(&text);
        // A journal whose first line is incomplete is empty.
        let (results, whole) = if begun { (empty, 0) } else { Results::parse(path, &text)? };
        configuration.check(path, results.configuration())?;
        let repaired = whole < text.len();
        if repaired {
            journal.file.set_len(whole as u64).map_err(wrong)?;
        }
        if whole == 0 {
            journal.put(json(path, configuration)?)?;
        }
        Ok(Opened { journal, results, repaired })
    }

    /// Appends a result, and passes it to the operating system before returning.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn add(&mut self, result: &T) -> Result<()> {
        self.put(line(&self.path, result)?)
    }

    fn put(&mut self, line: String) -> Result<()> {
        self.file.write_all((line + "\n").as_bytes()).map_err(|source| Error::io(&self.path, source))
    }
}

#[cfg(all(test, feature = "sim"))]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::sim::campaign::JobResult;
    use crate::sim::campaign::testing::{failed, flown};
    use crate::sim::flight::{FlightConfig, Outcome};

    fn configuration() -> Configuration {
        Configuration::new(&FlightConfig::default(), "defaults".to_owned()).unwrap()
    }

    fn reached(seed: u64) -> JobResult {
        flown("wall", seed, Outcome::Reached, seed as f64 / 3.0)
    }

    /// Creates a journal with the results of three flights.
    fn begun(path: &Path) -> String {
        let mut opened: Opened<JobResult> = Journal::open(path, &configuration()).unwrap();
        assert!(!opened.repaired && opened.results.sorted().is_empty());
        (1..=3).for_each(|seed| opened.journal.add(&reached(seed)).unwrap());
        fs::read_to_string(path).unwrap()
    }

    #[test]
    fn a_journal_goes_on_after_whatever_byte_it_was_cut() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/results.jsonl");
        let whole = begun(&path);
        let ends: Vec<usize> = whole.match_indices('\n').map(|(end, _)| end + 1).collect();
        for cut in 0..=whole.len() {
            fs::write(&path, &whole[..cut]).unwrap();
            let mut opened: Opened<JobResult> = Journal::open(&path, &configuration()).unwrap();
            let lines = ends.iter().filter(|&&end| end <= cut).count();
            assert_eq!(opened.results.sorted().len(), lines.saturating_sub(1), "{cut}");
            assert_eq!(opened.repaired, cut > 0 && !ends.contains(&cut), "{cut}");
            for seed in lines.max(1) as u64..=3 {
                opened.journal.add(&reached(seed)).unwrap();
            }
            drop(opened);
            assert_eq!(fs::read_to_string(&path).unwrap(), whole, "{cut}");
        }
    }

    #[test]
    fn what_failed_is_tried_again_and_then_counts_no_more() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.jsonl");
        let mut opened: Opened<JobResult> = Journal::open(&path, &configuration()).unwrap();
        opened.journal.add(&failed("wall", 1)).unwrap();
        opened.journal.add(&reached(1)).unwrap();
        drop(opened);
        assert_eq!(
            Journal::<JobResult>::open(&path, &configuration()).unwrap().results.sorted(),
            [&reached(1)]
        );
    }

    #[test]
    fn what_belongs_to_something_else_is_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.jsonl");
        let whole = begun(&path);
        let base = FlightConfig { radius_m: 0.7, ..FlightConfig::default() };
        let other = Configuration::new(&base, "a large plane".to_owned()).unwrap();
        for text in [whole.clone(), whole[..whole.len() - 5].to_owned(), "something else".to_owned()] {
            fs::write(&path, &text).unwrap();
            let error = Journal::<JobResult>::open(&path, &other).unwrap_err().to_string();
            assert!(error.contains("results.jsonl"), "{error}");
            assert_eq!(fs::read_to_string(&path).unwrap(), text);
        }
    }

    #[test]
    fn two_processes_do_not_write_to_one_journal() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.jsonl");
        let opened: Opened<JobResult> = Journal::open(&path, &configuration()).unwrap();
        let error = Journal::<JobResult>::open(&path, &configuration()).unwrap_err().to_string();
        assert!(error.contains("another process"), "{error}");
        drop(opened);
        assert!(Journal::<JobResult>::open(&path, &configuration()).is_ok());
    }
}
