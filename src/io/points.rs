//! Lists of points: `x,y` in pixels, one point per line.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::error::{Error, Result};

/// The most bytes read, so that a file of another kind is not read whole.
const MAX_BYTES: u64 = 1 << 26;

/// Reads points, `[x, y]` in pixels. See [`decode`].
///
/// # Errors
/// [`Error::Io`], and the errors of [`decode`].
pub fn read(path: impl AsRef<Path>) -> Result<Vec<[f32; 2]>> {
    let path = path.as_ref();
    let mut text = String::new();
    File::open(path)
        .and_then(|file| file.take(MAX_BYTES).read_to_string(&mut text))
        .map_err(|source| Error::io(path, source))?;
    decode(path, &text)
}

/// Decodes points, `[x, y]` in pixels, from the first two columns of each line. The first line may be a header that begins
/// with `x,y` or `#`; empty lines are skipped. `path` is the name for error messages.
///
/// # Errors
/// [`Error::Format`] naming the line that does not begin with two finite numbers, and for a text without a point.
pub fn decode(path: &Path, text: &str) -> Result<Vec<[f32; 2]>> {
    let mut points = Vec::new();
    for (number, line) in (1..).zip(text.trim_start_matches('\u{feff}').lines().map(str::trim)) {
        let header = number == 1 && (line.starts_with('#') || line.replace(' ', "").starts_with("x,y"));
        if line.is_empty() || header {
            continue;
        }
        let mut columns =
            line.split(',').map(|column| column.trim().parse().ok().filter(|c: &f32| c.is_finite()));
        let (Some(Some(x)), Some(Some(y))) = (columns.next(), columns.next()) else {
            let shown: String = line.chars().take(60).collect();
            let found = format_args!("{shown:?} in line {number}");
            return Err(Error::format(path, "a point", found, "x,y in pixels, two finite numbers"));
        };
        points.push([x, y]);
    }
    if points.is_empty() {
        return Err(Error::format(path, "number of points", 0, "at least 1"));
    }
    Ok(points)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn points_with_and_without_a_header() {
        let expected = [[1.0, 2.5], [3.0, -4.0]];
        for text in ["x,y\n1,2.5\n3,-4\n", "# points\n1, 2.5\n\n3,-4,9\n", "1,2.5\r\n3,-4"] {
            assert_eq!(decode(Path::new("p.csv"), text).unwrap(), expected, "{text}");
        }
    }

    #[test]
    fn other_lines_are_refused() {
        for (text, words) in [
            ("1,2\nx,y\n", "\"x,y\" in line 2"),
            ("1\n", "\"1\" in line 1"),
            ("1,NaN\n", "two finite numbers"),
            ("x,y\n", "number of points is 0"),
        ] {
            let error = decode(Path::new("p.csv"), text).unwrap_err().to_string();
            assert!(error.starts_with("p.csv: ") && error.contains(words), "{error}");
        }
    }
}
