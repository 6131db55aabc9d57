//! Image sequences on disk: numbered names as in `frames/%04d.png`, and names with `*` and `?`.

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::pattern::{Numbered, glob_matches};
use crate::atomic_file::folder;
use crate::error::{Error, Result};

/// The files that an argument stands for.
///
/// The name of an existing file stands for itself. Otherwise, in the file name but not in its folder:
/// - `%d`, `%4d` or `%04d` stands for a number as `printf` writes it (`%%` is a percent sign). The sequence starts at
///   the lowest number in the folder and ends at the first gap.
/// - `*` stands for any text and `?` for one character. All matching files are taken, in the order of [`natural`];
///   hidden ones only if the pattern starts with a dot.
///
/// A name with neither is returned unchanged, so that opening it gives the error.
///
/// # Errors
/// [`Error::Io`] naming the folder if it cannot be listed; [`Error::Format`] naming the pattern if nothing matches,
/// if it is malformed, or if it is a folder.
pub fn expand(argument: &str) -> Result<Vec<PathBuf>> {
    let path = Path::new(argument);
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    let globbed = name.contains(['*', '?']);
    if path.is_dir() {
        let [all, numbered] = ["*.png", "%04d.png"].map(|pattern| path.join(pattern));
        let expected = format_args!("files, such as '{}' or '{}'", all.display(), numbered.display());
        return Err(Error::format(path, "input", "a folder", expected));
    }
    if path.exists() || !(globbed || name.contains('%')) {
        return Ok(vec![path.to_owned()]);
    }
    let names = if name.contains('%') {
        if globbed {
            return Err(Error::format(path, "pattern", name, "either % or * and ?, not both"));
        }
        let pattern = Numbered::parse(path, name)?;
        let numbers: BTreeMap<u64, String> =
            list(path)?.into_iter().filter_map(|name| Some((pattern.number(&name)?, name))).collect();
        let first = numbers.keys().next().copied().unwrap_or(0);
        (first..).zip(numbers).take_while(|(due, (number, _))| due == number).map(|(_, (_, n))| n).collect()
    } else {
        let mut names = list(path)?;
        names.retain(|found| glob_matches(name, found) && path.with_file_name(found).is_file());
        names.sort_by(|a, b| natural(a, b));
        names
    };
    if names.is_empty() {
        return Err(Error::format(path, "number of matching files", 0, "at least 1"));
    }
    Ok(names.into_iter().map(|name| path.with_file_name(name)).collect())
}

/// The file names in a pattern's folder. Names that are not UTF-8 cannot match, as patterns are UTF-8.
fn list(pattern: &Path) -> Result<Vec<String>> {
    let folder = folder(pattern);
    let failed = |source| Error::io(folder, source);
    let mut names = Vec::new();
    for entry in folder.read_dir().map_err(failed)? {
        names.extend(entry.map_err(failed)?.file_name().into_string());
    }
    Ok(names)
}

/// Compares names so that numbers inside them count as numbers: `a2` before `a10`.
pub fn natural(a: &str, b: &str) -> Ordering {
    let (mut left, mut right) = (a, b);
    loop {
        let (one, two) = (digits(left), digits(right));
        let order = if one > 0 && two > 0 {
            let (n, m) = (left[..one].trim_start_matches('0'), right[..two].trim_start_matches('0'));
            (left, right) = (&left[one..], &right[two..]);
            // Numbers may have any length, so they are not parsed: the longer one is the larger.
            n.len().cmp(&m.len()).then_with(|| n.cmp(m))
        } else {
            let (mut one, mut two) = (left.chars(), right.chars());
            let order = match (one.next(), two.next()) {
                // Equal up to leading zeros; `01` and `1` still need an order.
                (None, None) => return a.cmp(b),
                (n, m) => n.cmp(&m),
            };
            (left, right) = (one.as_str(), two.as_str());
            order
        };
        if order.is_ne() {
            return order;
        }
    }
}

fn digits(text: &str) -> usize {
    text.bytes().take_while(u8::is_ascii_digit).count()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn found(names: &[&str], pattern: &str) -> Result<Vec<String>> {
        let folder = tempfile::tempdir().unwrap();
        for name in names {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let paths = expand(folder.path().join(pattern).to_str().unwrap())?;
        Ok(paths.iter().map(|p| p.file_name().unwrap().to_str().unwrap().to_owned()).collect())
    }

    #[test]
    fn numbers_begin_at_the_lowest_and_end_at_the_gap() {
        let names =
            ["0007.png", "0008.png", "0009.png", "0010.png", "0012.png", "00011.png", "7.png", "a.png"];
        assert_eq!(found(&names, "%04d.png").unwrap(), ["0007.png", "0008.png", "0009.png", "0010.png"]);
        assert_eq!(found(&names, "%d.png").unwrap(), ["7.png"]);
    }

    #[test]
    fn globs_are_sorted_by_their_numbers() {
        let names = ["f10.png", "f9.png", "f1.png", "g1.png", "f1.jpg", ".f1.png"];
        assert_eq!(found(&names, "f*.png").unwrap(), ["f1.png", "f9.png", "f10.png"]);
        assert_eq!(found(&names, "?1.png").unwrap(), ["f1.png", "g1.png"]);
        assert_eq!(found(&names, "*").unwrap(), ["f1.jpg", "f1.png", "f9.png", "f10.png", "g1.png"]);
    }

    #[test]
    fn nothing_found_names_the_pattern() {
        for pattern in ["%04d.png", "*.png"] {
            let text = found(&["a.jpg"], pattern).unwrap_err().to_string();
            let expected = format!("{pattern}: number of matching files is 0, expected at least 1");
            assert!(text.ends_with(&expected), "{text}");
        }
        let text = expand("no-such-folder/*.png").unwrap_err().to_string();
        assert!(text.starts_with("no-such-folder: "), "{text}");
    }

    #[test]
    fn a_name_that_exists_is_itself() {
        assert_eq!(found(&["a*.png", "ab.png"], "a*.png").unwrap(), ["a*.png"]);
        assert_eq!(expand("plain.png").unwrap(), [Path::new("plain.png")]);
    }

    #[test]
    fn natural_is_an_order_of_numbers() {
        let mut names = ["a10", "a2", "a02", "b", "a", "a2b", "", "a99999999999999999999999", "10", "9"];
        names.sort_by(|a, b| natural(a, b));
        assert_eq!(names, ["", "9", "10", "a", "a02", "a2", "a2b", "a10", "a99999999999999999999999", "b"]);
    }
}
