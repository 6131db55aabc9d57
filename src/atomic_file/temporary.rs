//! Files beside the place that they are written for.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::{OsStr, OsString};
use std::fs::{self, DirEntry, File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::error::{Error, Result};

/// A file that is being written beside its place: locked, so that nobody takes it for one that was left, and removed in
/// the end unless it was put there.
#[derive(Debug)]
pub(super) struct Temporary {
    path: PathBuf,
    file: File,
}

/// Those that are being written.
static WRITTEN: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

impl Temporary {
    /// A new file in the folder of `path`, under a name that no other call of this or another process uses.
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
                    // Taken for one that was left before it was locked, and removed.
                    Err(TryLockError::WouldBlock) => {}
                    Ok(()) if !temporary.exists() => {}
                    // Locked; or on a file system without locks, where nobody takes it for one that was left.
                    Ok(()) | Err(TryLockError::Error(_)) => {
                        written.insert(temporary.clone());
                        return Ok(Self { path: temporary, file });
                    }
                },
                // Of a process of the same number.
                Err(source) if source.kind() == io::ErrorKind::AlreadyExists => {}
                Err(source) => return Err(Error::io(folder, source)),
            }
        }
    }

    pub(super) fn file(&self) -> &File {
        &self.file
    }

    /// Gives it its name. Until then it stays open, and so locked.
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
            // Whoever drops it knows of a more important error; one that cannot be removed does not change that.
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// Removes all files that are being written, then ends the process: nothing is begun or finished in between.
#[cfg(feature = "cli")]
pub(crate) fn discard_and_exit(code: i32) -> ! {
    let written = locked(&WRITTEN);
    for path in written.iter() {
        // One that cannot be removed goes with the next file of its name.
        let _ = fs::remove_file(path);
    }
    std::process::exit(code)
}

/// The folder of a file.
pub(crate) fn folder(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// What was begun by a thread that panicked is as good as any.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The temporary files of each folder when this process first wrote into it, and of what: a folder of many thousand files is
/// not to be looked through for each of them.
static LEFT: Mutex<BTreeMap<PathBuf, Vec<(OsString, PathBuf)>>> = Mutex::new(BTreeMap::new());

/// Removes what is left of files of this name that nobody writes any more.
pub(super) fn remove_left(folder: &Path, name: &OsStr) {
    let mut folders = locked(&LEFT);
    let left = folders.entry(folder.to_owned()).or_insert_with(|| {
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        entries.filter_map(|entry| Some((written(&entry)?, entry.path()))).collect()
    });
    for (_, temporary) in left.extract_if(.., |(of, _)| of == name) {
        let Ok(file) = OpenOptions::new().write(true).open(&temporary) else { continue };
        if file.try_lock().is_ok() {
            // One that cannot be removed is in nobody's way.
            let _ = fs::remove_file(&temporary);
        }
    }
}

/// What a file is the temporary one of, by its name; none if it is no such file.
fn written(entry: &DirEntry) -> Option<OsString> {
    let name = entry.file_name();
    let (of, number) = name.to_str()?.strip_prefix('.')?.strip_suffix(".tmp")?.rsplit_once('.')?;
    let (process, count) = number.split_once('-')?;
    let numbers = [process, count].iter().all(|number| number.parse::<u64>().is_ok());
    (numbers && entry.file_type().is_ok_and(|kind| kind.is_file())).then(|| of.into())
}
