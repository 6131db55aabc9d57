//! Files that are whole or not there: written beside their place, then renamed into it.

mod temporary;

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::Path;

use temporary::Temporary;
#[cfg(feature = "cli")]
pub(crate) use temporary::discard_and_exit;
pub(crate) use temporary::folder;

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
    let temporary = Temporary::beside(path)?;
    let mut out = BufWriter::new(temporary.file());
    let done = content(&mut out)?;
    // Without the sync a crash soon after the rename could leave an empty file under the final name.
    out.into_inner()
        .map_err(io::IntoInnerError::into_error)
        .and_then(File::sync_all)
        .and_then(|()| temporary.put(path))
        .map_err(|source| Error::io(path, source))?;
    Ok(done)
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
    Temporary::beside(&folder.as_ref().join("probe")).map(drop)
}

/// Checks that a folder can be written into, or can be made, and leaves nothing behind.
///
/// # Errors
/// [`Error::Io`] naming `folder`, be it one above it that is at fault.
pub fn check_creatable(folder: impl AsRef<Path>) -> Result<()> {
    let path = folder.as_ref();
    let there = path.ancestors().find(|folder| folder.exists());
    // An ancestor of no name is the working folder.
    let there = there.filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    check_writable(there).map_err(|error| match error {
        Error::Io { source, .. } => Error::io(path, source),
        error => error,
    })
}

/// Removes a file if it is there, and what a process that was killed has left of it.
///
/// # Errors
/// [`Error::Io`] naming it.
pub fn remove(path: impl AsRef<Path>) -> Result<()> {
    let path = path.as_ref();
    if let Some(name) = path.file_name() {
        temporary::remove_left(temporary::folder(path), name);
    }
    match fs::remove_file(path) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => Err(Error::io(path, source)),
        _ => Ok(()),
    }
}
