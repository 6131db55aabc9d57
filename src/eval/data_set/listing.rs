//! Lists of files and folders, sorted by name.

use std::fs;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};

fn entries(folder: &Path) -> Result<Vec<PathBuf>> {
    let wrong = |source| Error::io(folder, source);
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder).map_err(wrong)? {
        paths.push(entry.map_err(wrong)?.path());
    }
    paths.sort();
    Ok(paths)
}

/// The folders in a folder, hidden ones left out.
pub(super) fn folders(folder: &Path) -> Result<Vec<PathBuf>> {
    let is_shown = |path: &PathBuf| !name(path).starts_with('.');
    Ok(entries(folder)?.into_iter().filter(|path| path.is_dir() && is_shown(path)).collect())
}

/// The files in a folder with one of these extensions, in any case. None if there is no such folder.
pub(super) fn files(folder: &Path, extensions: &[&str]) -> Result<Vec<PathBuf>> {
    if !folder.is_dir() {
        return Ok(Vec::new());
    }
    let extension =
        |path: &PathBuf| path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let is_one = |path: &PathBuf| path.is_file() && extensions.contains(&extension(path).as_str());
    Ok(entries(folder)?.into_iter().filter(is_one).collect())
}

/// A path's last part.
pub(super) fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// A path's last part without its extension.
pub(super) fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}
