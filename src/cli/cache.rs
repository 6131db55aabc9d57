//! The folder of the cache of compiled kernels.

use std::ffi::OsString;
use std::path::PathBuf;

/// The folder: what `VIEWSPHERE_CACHE` names (no cache if it is empty), else `viewsphere` in the user's cache folder.
pub(super) fn folder() -> Option<PathBuf> {
    choose(|name| std::env::var_os(name))
}

fn choose(variable: impl Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
    if let Some(chosen) = variable("VIEWSPHERE_CACHE") {
        return (!chosen.is_empty()).then(|| chosen.into());
    }
    // Relative paths are ignored, as XDG's specification requires.
    let folder = |name: &str| variable(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let caches = if cfg!(windows) {
        folder("LOCALAPPDATA")
    } else if cfg!(target_os = "macos") {
        folder("HOME").map(|home| home.join("Library/Caches"))
    } else {
        folder("XDG_CACHE_HOME").or_else(|| Some(folder("HOME")?.join(".cache")))
    };
    Some(caches?.join("viewsphere"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chosen(variables: &[(&str, &str)]) -> Option<PathBuf> {
        choose(|name| variables.iter().find(|(of, _)| *of == name).map(|(_, value)| value.into()))
    }

    #[test]
    fn the_users_choice_comes_first_and_may_be_none() {
        let home = ("HOME", "/home/ada");
        assert_eq!(chosen(&[home, ("VIEWSPHERE_CACHE", "here")]), Some("here".into()));
        assert_eq!(chosen(&[home, ("VIEWSPHERE_CACHE", "")]), None);
        assert_eq!(chosen(&[]), None);
    }

    #[test]
    #[cfg(all(unix, not(target_os = "macos")))]
    fn xdgs_folder_comes_before_that_in_the_home() {
        let home = ("HOME", "/home/ada");
        assert_eq!(chosen(&[home]), Some("/home/ada/.cache/viewsphere".into()));
        assert_eq!(chosen(&[home, ("XDG_CACHE_HOME", "/var/ada")]), Some("/var/ada/viewsphere".into()));
        assert_eq!(chosen(&[home, ("XDG_CACHE_HOME", "ada")]), Some("/home/ada/.cache/viewsphere".into()));
        assert_eq!(chosen(&[("HOME", "ada")]), None);
    }
}
