//! Files that are whole or not there: written beside their place, then renamed into it.

use std::collections::BTreeMap;
use std::ffi::{OsStr, OsString};
use std::fs::{self, DirEntry, File, OpenOptions, TryLockError};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use crate::error::{Error, Result};

/// Writes a file so that `path` holds either its old content or all of the new one, never a part.
///
/// `content` is given a buffered writer to a temporary file in the same folder; when it returns, the file is flushed,
/// synchronised and renamed to `path`. If anything fails, the temporary file is removed and `path` is left alone. What a
/// process that was killed has left of the same file is removed, too: a temporary file is locked while it is written, so
/// that it is known whether anyone does.
///
/// A pipe or a device is written to as it stands. Returns what `content` does.
///
/// # Errors
/// What `content` fails with, or [`Error::Io`] naming the folder if the temporary file cannot be made there, or naming
/// `path` if it cannot be finished.
pub fn write_atomic<T>(
    path: impl AsRef<Path>,
    content: impl FnOnce(&mut dyn Write) -> Result<T>,
) -> Result<T> {
    let path = path.as_ref();
    if fs::metadata(path).is_ok_and(|target| !target.is_file() && !target.is_dir()) {
        // A pipe or a device cannot be replaced, only written to.
        let file = OpenOptions::new().write(true).open(path).map_err(|source| Error::io(path, source))?;
        let mut out = BufWriter::new(file);
        let done = content(&mut out)?;
        return out.flush().map(|()| done).map_err(|source| Error::io(path, source));
    }
    // What a link points to is replaced, not the link.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let path = target.as_path();
    let (temporary, file) = create_beside(path)?;
    // Until it has its name the file stays open, and so locked.
    let done = fill(path, file, content).and_then(|(done, _file)| {
        fs::rename(&temporary, path).map(|()| done).map_err(|source| Error::io(path, source))
    });
    if done.is_err() {
        // The first error is the one to report; a temporary that cannot be removed does not change it.
        let _ = fs::remove_file(&temporary);
    }
    done
}

/// [`write_atomic`] of bytes that are already there.
///
/// # Errors
/// As [`write_atomic`].
pub fn write_bytes(path: impl AsRef<Path>, bytes: &[u8]) -> Result<()> {
    let path = path.as_ref();
    write_atomic(path, |out| out.write_all(bytes).map_err(|source| Error::io(path, source)))
}

/// Checks that files can be written into a folder that is there, by writing one and removing it.
///
/// # Errors
/// [`Error::Io`] naming the folder.
pub fn check_writable(folder: impl AsRef<Path>) -> Result<()> {
    let (probe, _file) = create_beside(&folder.as_ref().join("probe"))?;
    fs::remove_file(&probe).map_err(|source| Error::io(&probe, source))
}

/// A new file in the folder of `path`, under a name that no other call of this or another process uses.
fn create_beside(path: &Path) -> Result<(PathBuf, File)> {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let no_name = || Error::io(path, io::Error::new(io::ErrorKind::InvalidInput, "not the name of a file"));
    let name = path.file_name().ok_or_else(no_name)?;
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    remove_left(folder, name);
    loop {
        let mut beside = OsString::from(".");
        beside.push(name);
        beside.push(format!(".{}-{}.tmp", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed)));
        let temporary = folder.join(beside);
        match OpenOptions::new().write(true).create_new(true).open(&temporary) {
            Ok(file) => match file.try_lock() {
                Ok(()) if temporary.exists() => return Ok((temporary, file)),
                // A file system without locks: nobody there takes it for one that was left.
                Err(TryLockError::Error(_)) => return Ok((temporary, file)),
                // Taken for one that was left before it was locked, and removed.
                Ok(()) | Err(TryLockError::WouldBlock) => {}
            },
            // Of a process of the same number.
            Err(source) if source.kind() == io::ErrorKind::AlreadyExists => {}
            Err(source) => return Err(Error::io(folder, source)),
        }
    }
}

/// The temporary files of each folder when this process first wrote into it, and of what: a folder of many thousand files is
/// not to be looked through for each of them.
static LEFT: Mutex<BTreeMap<PathBuf, Vec<(OsString, PathBuf)>>> = Mutex::new(BTreeMap::new());

/// Removes what is left of files of this name that nobody writes any more.
fn remove_left(folder: &Path, name: &OsStr) {
    let mut folders = LEFT.lock().unwrap_or_else(PoisonError::into_inner);
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

fn fill<T>(path: &Path, file: File, content: impl FnOnce(&mut dyn Write) -> Result<T>) -> Result<(T, File)> {
    let mut out = BufWriter::new(file);
    let done = content(&mut out)?;
    // Without the sync a crash soon after the rename could leave an empty file under the final name.
    out.into_inner()
        .map_err(io::IntoInnerError::into_error)
        .and_then(|file| file.sync_all().map(|()| (done, file)))
        .map_err(|source| Error::io(path, source))
}
