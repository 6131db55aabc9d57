//! Checks of everything that a command writes: no result takes the path of an input or of another result, and each can be
//! written.
//!
//! One rule holds for all commands. A file named on the command line is replaced, and so are numbered files in a folder named
//! there. Files whose names the program chooses are replaced only in a folder that an earlier run has written
//! ([`of_an_earlier_run`]).

use std::fs;
use std::path::{Path, PathBuf};

use super::input;
use super::place::{Place, extension};
use crate::error::{Error, Result};
use crate::io::{check_writable, sequence};

/// A file that a command reads.
struct Input {
    /// The path without symbolic links.
    file: PathBuf,
    /// The same with the name that it has in its folder.
    entry: PathBuf,
    /// Whether it is one of many that a pattern stands for, which might match results, too.
    is_of_pattern: bool,
}

/// Checks the destinations of a command's results, each with its flag, before anything is computed. `inputs` are files, and
/// patterns of files; `-` and files that do not exist are skipped.
///
/// # Errors
/// [`Error::Parameter`] if a result would replace an input or another result; [`Error::Io`] for a folder that cannot be
/// written or created.
pub(super) fn check<'a>(
    results: &[(&'static str, Option<&Place>)],
    inputs: impl IntoIterator<Item = &'a Path>,
) -> Result<()> {
    are_apart(results, inputs)?;
    results.iter().filter_map(|(_, place)| *place).try_for_each(can_be_written)
}

/// The same for results whose folders may be created later: checks only that they are apart from each other and the inputs.
///
/// # Errors
/// [`Error::Parameter`].
pub(super) fn are_apart<'a>(
    results: &[(&'static str, Option<&Place>)],
    inputs: impl IntoIterator<Item = &'a Path>,
) -> Result<()> {
    let results: Vec<(&'static str, &Place)> =
        results.iter().filter_map(|(flag, place)| Some((*flag, (*place)?))).collect();
    if results.is_empty() {
        return Ok(());
    }
    let inputs: Vec<Input> = inputs.into_iter().flat_map(Input::all).collect();
    for (i, &(flag, place)) in results.iter().enumerate() {
        if let Some(input) = inputs.iter().find(|input| replaces(place, input)) {
            let expected = format!("a path other than that of the input {}", shown(&input.entry).display());
            return Err(Error::parameter(flag, name(place), expected));
        }
        if let Some((other, _)) = results[..i].iter().find(|(_, other)| meet(place, other)) {
            return Err(Error::parameter(
                flag,
                name(place),
                format_args!("a path other than that of {other}"),
            ));
        }
    }
    Ok(())
}

/// Checks that files to be replaced in a folder belong to an earlier run of the same command. `is_own` tells whether the
/// folder is one that it has written; `mark` names the file that shows it.
///
/// # Errors
/// [`Error::Parameter`] naming the file.
pub(super) fn of_an_earlier_run(folder: &Path, names: &[&str], is_own: bool, mark: &str) -> Result<()> {
    match names.iter().map(|name| folder.join(name)).find(|path| path.is_file()) {
        Some(path) if !is_own => {
            let expected = format_args!("a folder without it, or one with {mark}");
            Err(Error::parameter("-o", format_args!("a folder with {}", path.display()), expected))
        }
        _ => Ok(()),
    }
}

/// Checks that an input does not lie in a folder that is to be replaced as a whole.
///
/// # Errors
/// [`Error::Parameter`].
pub(super) fn is_outside(flag: &'static str, input: &Path, folder: &Path) -> Result<()> {
    if !resolved(input).starts_with(resolved(folder)) {
        return Ok(());
    }
    let expected = format_args!("a file outside {}, which is replaced", folder.display());
    Err(Error::parameter(flag, input.display(), expected))
}

impl Input {
    /// The files that an argument stands for.
    fn all(argument: &Path) -> Vec<Self> {
        let is_of_pattern = !argument.exists();
        let files = match argument.to_str().filter(|text| is_of_pattern && *text != "-") {
            Some(pattern) => sequence::expand(pattern).unwrap_or_default(),
            None => vec![argument.to_owned()],
        };
        let found = |file: PathBuf| {
            let entry = match (file.parent(), file.file_name()) {
                (Some(folder), Some(name)) => resolved(folder).join(name),
                _ => file.clone(),
            };
            Some(Self { file: file.canonicalize().ok()?, entry, is_of_pattern })
        };
        files.into_iter().filter_map(found).collect()
    }
}

/// Whether a result would take the place of an input.
fn replaces(place: &Place, input: &Input) -> bool {
    match place {
        Place::Stdout => false,
        Place::File(path) => resolved(path) == input.file,
        Place::Folder(folder, kind) => [&input.file, &input.entry].into_iter().any(|file| {
            extension(file) == *kind
                && file.parent() == Some(&resolved(folder))
                && (input.is_of_pattern || is_numbered(file))
        }),
    }
}

/// Whether two results would share a file, or one would be a file where the other needs a folder.
fn meet(a: &Place, b: &Place) -> bool {
    match (a, b) {
        (Place::Stdout, other) | (other, Place::Stdout) => matches!(other, Place::Stdout) && a == b,
        (Place::File(a), Place::File(b)) => {
            let (a, b) = (resolved(a), resolved(b));
            a.starts_with(&b) || b.starts_with(&a)
        }
        (Place::Folder(a, kind), Place::Folder(b, other)) => kind == other && resolved(a) == resolved(b),
        (Place::File(file), Place::Folder(folder, kind))
        | (Place::Folder(folder, kind), Place::File(file)) => {
            let (file, folder) = (resolved(file), resolved(folder));
            folder.starts_with(&file)
                || file.parent() == Some(&folder) && is_numbered(&file) && extension(&file) == *kind
        }
    }
}

fn can_be_written(place: &Place) -> Result<()> {
    match place {
        Place::Stdout => Ok(()),
        Place::Folder(folder, _) => input::folder(folder),
        Place::File(path) => {
            // A pipe or a device is written to directly.
            let is_special = fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir());
            let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
            if is_special { Ok(()) } else { check_writable(folder.unwrap_or(Path::new("."))) }
        }
    }
}

/// Whether a file's name is a number, as those of results in folders are.
fn is_numbered(file: &Path) -> bool {
    let stem = file.file_stem().unwrap_or_default().as_encoded_bytes();
    !stem.is_empty() && stem.iter().all(u8::is_ascii_digit)
}

/// A path without symbolic links, as far as it exists, so that different names of one file compare as equal.
fn resolved(path: &Path) -> PathBuf {
    let (mut there, mut missing) = (path, Vec::new());
    loop {
        let folder = if there.as_os_str().is_empty() { Path::new(".") } else { there };
        if let Ok(found) = folder.canonicalize() {
            return missing.iter().rev().fold(found, |whole, name| whole.join(name));
        }
        match (there.parent(), there.file_name()) {
            (Some(parent), Some(name)) => {
                missing.push(name);
                there = parent;
            }
            _ => return path.to_owned(),
        }
    }
}

/// A path below the working folder without that.
fn shown(path: &Path) -> &Path {
    std::env::current_dir().ok().and_then(|here| path.strip_prefix(here).ok()).unwrap_or(path)
}

fn name(place: &Place) -> String {
    match place {
        Place::Stdout => "-".to_owned(),
        Place::File(path) | Place::Folder(path, _) => path.display().to_string(),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn results_that_meet_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let at = folder.path();
        fs::create_dir(at.join("there")).unwrap();
        let file = |name: &str| Place::File(at.join(name));
        let inside = |name: &str, kind| Place::Folder(at.join(name), kind);
        for (a, b, expected) in [
            (file("a"), file("./a"), true),
            (file("a"), file("b"), false),
            (file("there/a"), file("there/../there/a"), true),
            (file("new"), file("new/a"), true),
            (Place::Stdout, Place::Stdout, true),
            (Place::Stdout, file("a"), false),
            (file("a"), inside("a", "png"), true),
            (file("a"), inside("a/b", "png"), true),
            (file("new/000007.png"), inside("new", "png"), true),
            (file("new/000007.flo"), inside("new", "png"), false),
            (file("new/a.png"), inside("new", "png"), false),
            (inside("new", "png"), inside("new/", "png"), true),
            (inside("new", "png"), inside("new", "flo"), false),
        ] {
            for (a, b) in [(&a, &b), (&b, &a)] {
                assert_eq!(meet(a, b), expected, "{a:?} {b:?}");
                let checked = are_apart(&[("-a", Some(a)), ("-b", Some(b)), ("-c", None)], []);
                let text = checked.err().map(|error| error.to_string()).unwrap_or_default();
                let is_told = text.starts_with("-b is ") && text.ends_with("a path other than that of -a");
                assert_eq!(is_told, expected, "{text}");
            }
        }
    }

    #[test]
    fn results_that_replace_an_input_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let at = folder.path();
        for name in ["000000.png", "a.png", "b.png"] {
            fs::write(at.join(name), "").unwrap();
        }
        let check = |place: Place, input: &str| check(&[("-o", Some(&place))], [at.join(input).as_path()]);
        let inside = |kind| Place::Folder(at.to_owned(), kind);
        for (place, input, expected) in [
            (Place::File(at.join("./a.png")), "a.png", true),
            (Place::File(at.join("a.png")), "?.png", true),
            (Place::File(at.join("c.png")), "a.png", false),
            (inside("png"), "000000.png", true),
            (inside("png"), "%06d.png", true),
            // The next run would read the results.
            (inside("png"), "?.png", true),
            (inside("png"), "a.png", false),
            (inside("flo"), "000000.png", false),
            (Place::File(at.join("a.csv")), "missing", false),
        ] {
            let text = check(place, input).err().map(|error| error.to_string()).unwrap_or_default();
            assert_eq!(text.contains("a path other than that of the input"), expected, "{input}: {text}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn symbolic_links_are_followed() {
        let folder = tempfile::tempdir().unwrap();
        let at = folder.path();
        fs::write(at.join("a.png"), "").unwrap();
        std::os::unix::fs::symlink(at.join("a.png"), at.join("link.png")).unwrap();
        let place = Place::File(at.join("link.png"));
        assert!(check(&[("-o", Some(&place))], [at.join("a.png").as_path()]).is_err());
        assert!(is_outside("--camera", &at.join("link.png"), at).is_err());
        assert!(is_outside("--camera", &at.join("a.png"), &at.join("other")).is_ok());
    }
}
