//! Lists of frame times: EuRoC's `#timestamp [ns],filename`, or one time in seconds per line.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::error::{Error, Result};

/// The most bytes read, so that a file of another kind is not read whole.
const MAX_BYTES: u64 = 1 << 28;

/// Reads the frame times in seconds, one per frame. See [`decode`].
///
/// # Errors
/// [`Error::Io`], and the errors of [`decode`].
pub fn read(path: impl AsRef<Path>) -> Result<Vec<f64>> {
    let path = path.as_ref();
    let mut text = String::new();
    File::open(path)
        .and_then(|file| file.take(MAX_BYTES).read_to_string(&mut text))
        .map_err(|source| Error::io(path, source))?;
    decode(path, &text)
}

/// Decodes frame times in seconds, one per frame: the first column of each line. If the first line does not start
/// with a number, it names the column and its unit (ns, us, ms or s): `#timestamp [ns]`, `time_s`. `path` is the name
/// for error messages.
///
/// # Errors
/// [`Error::Format`] naming the line that does not start with a finite number, for an unknown unit, and for a text
/// without a time.
pub fn decode(path: &Path, text: &str) -> Result<Vec<f64>> {
    let mut times = Vec::new();
    let mut per_second = 1.0;
    for (number, line) in (1..).zip(text.trim_start_matches('\u{feff}').lines()) {
        let first = line.split(',').next().unwrap_or_default().trim();
        if first.is_empty() {
            continue;
        }
        let wrong = |expected: &str| {
            let shown: String = first.chars().take(60).collect();
            Err(Error::format(path, "frame times", format!("{shown:?} in line {number}"), expected))
        };
        match first.parse::<f64>() {
            Ok(time) if time.is_finite() => times.push(time / per_second),
            Err(_) if times.is_empty() => {
                let Some(unit) = unit(first) else { return wrong("#timestamp [ns], or a time in seconds") };
                per_second = unit;
            }
            _ => return wrong("a finite number"),
        }
    }
    if times.is_empty() {
        return Err(Error::format(path, "number of frame times", 0, "at least 1"));
    }
    Ok(times)
}

/// The number of units per second, from a header such as `#timestamp [ns]` or `time_s`.
fn unit(header: &str) -> Option<f64> {
    let name = header.trim_start_matches('#').trim().to_lowercase();
    if !(name.starts_with('t') || name.starts_with("stamp")) {
        return None;
    }
    let unit = name.split(['[', '(', '_', ' ']).next_back().unwrap_or_default();
    match unit.trim_end_matches([']', ')']) {
        "ns" => Some(1e9),
        "us" | "µs" => Some(1e6),
        "ms" => Some(1e3),
        "s" | "sec" => Some(1.0),
        unit if unit == name => Some(1.0),
        _ => None,
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn lists_state_their_unit() {
        let of = |text: &str| decode(Path::new("t.csv"), text);
        assert_eq!(
            of("#timestamp [ns],filename\n1500000000,a.png\n\n2000000000,b.png\n").unwrap(),
            [1.5, 2.0]
        );
        assert_eq!(of("0.5\n0.75\n").unwrap(), [0.5, 0.75]);
        assert_eq!(of("time_s\n0.5\n").unwrap(), [0.5]);
        assert_eq!(of("timestamp\n0.5\n").unwrap(), [0.5]);
        for (text, words) in [
            ("", "number of frame times is 0"),
            ("name\n1\n", "\"name\" in line 1"),
            ("1\nx\n", "\"x\" in line 2"),
            ("1\nNaN\n", "\"NaN\" in line 2"),
            ("#timestamp [h]\n1\n", "in line 1"),
        ] {
            let found = of(text).unwrap_err().to_string();
            assert!(found.contains(words), "{text}: {found}");
        }
    }
}
