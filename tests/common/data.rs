//! Data sets, which are not part of this crate.

use std::path::{Path, PathBuf};

use crate::need::{self, Without};

/// The folder of a set, in the folder that `VIEWSPHERE_DATA` names or in `../shared/data`. Sets of cases lie beside
/// those of data: `../cases/NAME`. A test that gets none returns.
#[track_caller]
pub(crate) fn set(name: &str) -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    let folder = std::env::var_os("VIEWSPHERE_DATA").map_or_else(beside, PathBuf::from).join(name);
    let found = if folder.is_dir() { Ok(folder) } else { Err(format!("{} is no folder", folder.display())) };
    need::found(&format!("data {name}"), found, Without::Nothing)
}
