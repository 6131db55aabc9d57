//! Atomic file writes: a file is written under a temporary name in its folder, then renamed.

mod temporary;

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::Path;

use temporary::Temporary;
#[cfg(feature = "cli")]
pub(crate) use temporary::discard_and_exit;
pub(crate) use temporary::folder;

use crate::error::{Error, Result};

/// Writes a file atomically: `path` holds either its old content or all of the new one, never a part.
///
/// `content` receives a buffered writer to a temporary file in the same folder. When it returns, the file is flushed,
/// synchronised and renamed to `path`. On any failure the temporary file is removed and `path` is left alone.
/// Temporary files of the same name that a killed process left behind are removed, too: a temporary file is locked
/// while it is written, so an unlocked one belongs to nobody.
///
/// A pipe or a device is written directly. Returns the value of `content`.
///
/// # Errors
/// The error of `content`, or [`Error::Io`] naming the folder if the temporary file cannot be created there, or
/// naming `path` if it cannot be completed.
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
    // Replace the target of a symbolic link, not the link.
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

/// Writes bytes to a file atomically, as [`write_atomic`] does.
///
/// # Errors
/// As in [`write_atomic`].
pub fn write_bytes(path: impl AsRef<Path>, bytes: &[u8]) -> Result<()> {
    let path = path.as_ref();
    write_atomic(path, |out| out.write_all(bytes).map_err(|source| Error::io(path, source)))
}

/// Checks that an existing folder is writable, by creating a file in it and removing it.
///
/// # Errors
/// [`Error::Io`] naming the folder.
pub fn check_writable(folder: impl AsRef<Path>) -> Result<()> {
    Temporary::beside(&folder.as_ref().join("probe")).map(drop)
}

/// Checks that a folder is writable or can be created, and leaves nothing behind.
///
/// # Errors
/// [`Error::Io`] naming `folder`, even where one above it is the cause.
pub fn check_creatable(folder: impl AsRef<Path>) -> Result<()> {
    let path = folder.as_ref();
    let there = path.ancestors().find(|folder| folder.exists());
    // The ancestor of a relative name without a parent is the working folder.
    let there = there.filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    check_writable(there).map_err(|error| match error {
        Error::Io { source, .. } => Error::io(path, source),
        error => error,
    })
}

/// Removes a file, if it exists, and the temporary files of its name that a killed process left behind.
///
/// # Errors
/// [`Error::Io`] naming the file.
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
