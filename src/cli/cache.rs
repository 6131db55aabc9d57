//! The folder that keeps compiled kernels from one run to the next.

use std::env::var_os;
use std::path::PathBuf;

/// The folder that `VIEWSPHERE_CACHE` names, none if that is empty; without it `viewsphere` in the user's folder for caches.
pub(super) fn folder() -> Option<PathBuf> {
    match var_os("VIEWSPHERE_CACHE") {
        Some(chosen) => (!chosen.is_empty()).then(|| chosen.into()),
        None => Some(users()?.join("viewsphere")),
    }
}

/// Where the platform puts a user's caches. A folder that is not absolute is none: XDG's specification says so.
fn users() -> Option<PathBuf> {
    let folder = |name: &str| var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    if cfg!(windows) {
        folder("LOCALAPPDATA")
    } else if cfg!(target_os = "macos") {
        Some(folder("HOME")?.join("Library/Caches"))
    } else {
        folder("XDG_CACHE_HOME").or_else(|| Some(folder("HOME")?.join(".cache")))
    }
}
