//! Temporary files, in the folder of the file that they will become.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::{OsStr, OsString};
use std::fs::{self, DirEntry, File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::error::{Error, Result};

/// A temporary file that is being written: locked, so that no other process takes it for a leftover, and removed when
/// dropped unless it was renamed.
#[derive(Debug)]
pub(super) struct Temporary {
    path: PathBuf,
    file: File,
}

/// The temporary files that are being written.
static WRITTEN: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

impl Temporary {
    /// Creates a file in the folder of `path`, under a name that no other call of this or another process uses.
    pub(super) fn beside(path: &Path) -> Result<Self> {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        let no_name =
            || Error::io(path, io::Error::new(io::ErrorKind::InvalidInput, "not the name of a file"));
        let name = path.file_name().ok_or_else(no_name)?;
        let folder = folder(path);
        remove_left(folder, name);
        loop {
            let mut beside = OsString::from(".");
            beside.push(name);
            beside.push(format!(".{}-{}.tmp", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed)));
            let temporary = folder.join(beside);
            let mut written = locked(&WRITTEN);
            match OpenOptions::new().write(true).create_new(true).open(&temporary) {
                Ok(file) => match file.try_lock() {
                    // Another process took it for a leftover before it was locked, and removed it.
                    Err(TryLockError::WouldBlock) => {}
                    Ok(()) if !temporary.exists() => {}
                    // Locked; or on a file system without locks, where no process takes it for a leftover.
                    Ok(()) | Err(TryLockError::Error(_)) => {
                        written.insert(temporary.clone());
                        return Ok(Self { path: temporary, file });
                    }
                },
                // A leftover of a process with the same id.
                Err(source) if source.kind() == io::ErrorKind::AlreadyExists => {}
                Err(source) => return Err(Error::io(folder, source)),
            }
        }
    }

    pub(super) fn file(&self) -> &File {
        &self.file
    }

    /// Renames the file to `path`. It stays open, and so locked, until then.
    pub(super) fn put(self, path: &Path) -> io::Result<()> {
        let mut written = locked(&WRITTEN);
        fs::rename(&self.path, path)?;
        written.remove(&self.path);
        drop(written);
        Ok(())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if locked(&WRITTEN).remove(&self.path) {
            // It is dropped because of a more important error; a failure to remove it changes nothing about that.
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// Removes all files that are being written, then exits. No other file is started or completed in between.
#[cfg(feature = "cli")]
pub(crate) fn discard_and_exit(code: i32) -> ! {
    let written = locked(&WRITTEN);
    for path in written.iter() {
        // A file that cannot be removed now is removed by the next write to the same name.
        let _ = fs::remove_file(path);
    }
    std::process::exit(code)
}

/// The folder of a file: its parent, or `.`.
pub(crate) fn folder(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Locks a mutex; a panic in another thread leaves its content valid.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Per folder, the temporary files found when this process first wrote into it, each with the name of its target:
/// scanning a folder of many thousand files for each of them would be slow.
static LEFT: Mutex<BTreeMap<PathBuf, Vec<(OsString, PathBuf)>>> = Mutex::new(BTreeMap::new());

/// Removes the leftover temporary files of `name` that no process holds locked.
pub(super) fn remove_left(folder: &Path, name: &OsStr) {
    let mut folders = locked(&LEFT);
    let left = folders.entry(folder.to_owned()).or_insert_with(|| {
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        entries.filter_map(|entry| Some((written(&entry)?, entry.path()))).collect()
    });
    for (_, temporary) in left.extract_if(.., |(of, _)| of == name) {
        let Ok(file) = OpenOptions::new().write(true).open(&temporary) else { continue };
        if file.try_lock().is_ok() {
            // A file that cannot be removed does no harm.
            let _ = fs::remove_file(&temporary);
        }
    }
}

/// The name of the target, if the entry is a temporary file.
fn written(entry: &DirEntry) -> Option<OsString> {
    let name = entry.file_name();
    let (of, number) = name.to_str()?.strip_prefix('.')?.strip_suffix(".tmp")?.rsplit_once('.')?;
    let (process, count) = number.split_once('-')?;
    let numbers = [process, count].iter().all(|number| number.parse::<u64>().is_ok());
    (numbers && entry.file_type().is_ok_and(|kind| kind.is_file())).then(|| of.into())
}
