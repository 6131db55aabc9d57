//! Files that are whole or not there: written beside their place, then renamed into it.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use crate::error::{Error, Result};

/// Writes a file so that `path` holds either its old content or all of the new one, never a part.
///
/// `content` is given a buffered writer to a temporary file in the same folder; when it returns, the file is flushed,
/// synchronised and renamed to `path`. If anything fails, the temporary file is removed and `path` is left alone.
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
    let done = fill(path, file, content).and_then(|done| {
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
    let (probe, _) = create_beside(&folder.as_ref().join("probe"))?;
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
    loop {
        let mut beside = std::ffi::OsString::from(".");
        beside.push(name);
        beside.push(format!(".{}-{}.tmp", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed)));
        let temporary = folder.join(beside);
        match OpenOptions::new().write(true).create_new(true).open(&temporary) {
            Ok(file) => return Ok((temporary, file)),
            // Left behind by a process of the same number that was killed: take the next name.
            Err(source) if source.kind() == io::ErrorKind::AlreadyExists => {}
            Err(source) => return Err(Error::io(folder, source)),
        }
    }
}

fn fill<T>(path: &Path, file: File, content: impl FnOnce(&mut dyn Write) -> Result<T>) -> Result<T> {
    let mut out = BufWriter::new(file);
    let done = content(&mut out)?;
    // Without the sync a crash soon after the rename could leave an empty file under the final name.
    out.into_inner()
        .map_err(io::IntoInnerError::into_error)
        .and_then(|file| file.sync_all())
        .map(|()| done)
        .map_err(|source| Error::io(path, source))
}
