//! A folder that appears only when complete.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::Existing;
use crate::error::{Error, Result};
use crate::io::check_creatable;

/// A file in every data set, by which one is recognised.
const MARK: &str = "poses.csv";

/// A folder that is written beside its final place and renamed at the end. If dropped earlier, it is removed.
pub(super) struct Folder {
    place: PathBuf,
    partial: PathBuf,
    /// The path of an earlier set until the new one is in place.
    replaced: PathBuf,
    finished: bool,
}

impl Folder {
    /// Creates the folder beside its final place.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the place is taken, unless by a data set that may be replaced; [`Error::Io`].
    pub(super) fn new(place: &Path, existing: Existing) -> Result<Self> {
        let name = place
            .file_name()
            .ok_or_else(|| Error::parameter("folder", place.display(), "the name of a new folder"))?;
        if place.exists() {
            let empty = fs::read_dir(place).map_err(|source| Error::io(place, source))?.next().is_none();
            if !empty && existing == Existing::Refuse {
                let expected = "an empty folder, or Existing::Replace for a data set";
                return Err(Error::parameter(
                    "folder",
                    format_args!("{}, which is not empty", place.display()),
                    expected,
                ));
            }
            if !empty && !place.join(MARK).is_file() {
                let found = format_args!("{}, which has no {MARK}", place.display()).to_string();
                return Err(Error::parameter(
                    "folder",
                    found,
                    "a data set, as Existing::Replace replaces nothing else",
                ));
            }
        }
        let beside = |ending: &str| {
            let mut name = name.to_owned();
            name.push(ending);
            place.with_file_name(name)
        };
        let (partial, replaced) = (beside(".partial"), beside(".replaced"));
        check_creatable(if place.exists() { &partial } else { place })?;
        for left in [&partial, &replaced] {
            if left.exists() {
                fs::remove_dir_all(left).map_err(|source| Error::io(left, source))?;
            }
        }
        fs::create_dir_all(&partial).map_err(|source| Error::io(&partial, source))?;
        Ok(Self { place: place.to_owned(), partial, replaced, finished: false })
    }

    /// The current path of a file in the folder.
    pub(super) fn path(&self, name: &str) -> PathBuf {
        if self.finished { self.place.join(name) } else { self.partial.join(name) }
    }

    /// Creates a subfolder.
    pub(super) fn make(&self, name: &str) -> Result<()> {
        let path = self.path(name);
        fs::create_dir_all(&path).map_err(|source| Error::io(path, source))
    }

    /// Moves the folder to its final place.
    pub(super) fn finish(&mut self) -> Result<()> {
        let Self { place, partial, replaced, .. } = self;
        let moved = |from: &Path, to: &Path| fs::rename(from, to).map_err(|source| Error::io(to, source));
        if place.exists() {
            // Remove the old one only once the new one is in place.
            moved(place, replaced)?;
            moved(partial, place)?;
            fs::remove_dir_all(&*replaced).map_err(|source| Error::io(&*replaced, source))?;
        } else {
            moved(partial, place)?;
        }
        self.finished = true;
        Ok(())
    }

    /// The total size of its files.
    pub(super) fn bytes(&self) -> Result<u64> {
        fn bytes(folder: &Path) -> io::Result<u64> {
            let mut sum = 0;
            for entry in fs::read_dir(folder)? {
                let entry = entry?;
                let found = entry.metadata()?;
                sum += if found.is_dir() { bytes(&entry.path())? } else { found.len() };
            }
            Ok(sum)
        }
        let folder = self.path("");
        bytes(&folder).map_err(|source| Error::io(folder, source))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        if !self.finished {
            // The next run removes what cannot be removed now.
            let _ = fs::remove_dir_all(&self.partial);
        }
    }
}
