//! Lists of points: `x,y` in pixels, one point per line.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::error::{Error, Result};

/// The most bytes read, so that a file of another kind is not read whole.
const MAX_BYTES: u64 = 1 << 26;

/// A point of a list.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ListedPoint {
    /// Its column and row, in pixels.
    pub place: [f32; 2],
    /// The number of its line, counted from 1.
    pub line: usize,
}

/// Reads points. See [`decode`].
///
/// # Errors
/// [`Error::Io`], and the errors of [`decode`].
pub fn read(path: impl AsRef<Path>) -> Result<Vec<ListedPoint>> {
    let path = path.as_ref();
    let mut text = String::new();
    File::open(path)
        .and_then(|file| file.take(MAX_BYTES).read_to_string(&mut text))
        .map_err(|source| Error::io(path, source))?;
    decode(path, &text)
}

/// Decodes points from lines of two numbers, the column and the row in pixels. The first line may be the header `x,y`, or
/// begin with `#`; empty lines are skipped. `path` is the name for error messages.
///
/// # Errors
/// [`Error::Format`] naming the line that does not hold two finite numbers, and for a text without a point.
pub fn decode(path: &Path, text: &str) -> Result<Vec<ListedPoint>> {
    let mut points = Vec::new();
    for (number, line) in (1..).zip(text.trim_start_matches('\u{feff}').lines().map(str::trim)) {
        let header = number == 1 && (line.starts_with('#') || line.replace(' ', "") == "x,y");
        if line.is_empty() || header {
            continue;
        }
        let mut columns =
            line.split(',').map(|column| column.trim().parse().ok().filter(|c: &f32| c.is_finite()));
        let (Some(Some(x)), Some(Some(y)), None) = (columns.next(), columns.next(), columns.next()) else {
            let shown: String = line.chars().take(60).collect();
            let found = format_args!("{shown:?} in line {number}");
            return Err(Error::format(
                path,
                "a point",
                found,
                "x,y in pixels, two finite numbers and no more",
            ));
        };
        points.push(ListedPoint { place: [x, y], line: number });
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
        for (text, lines) in [
            ("x,y\n1,2.5\n3,-4\n", [2, 3]),
            ("# points\n1, 2.5\n\n3,-4\n", [2, 4]),
            ("1,2.5\r\n3,-4", [1, 2]),
        ] {
            let points = decode(Path::new("p.csv"), text).unwrap();
            let listed = |place, line| ListedPoint { place, line };
            assert_eq!(points, [listed([1.0, 2.5], lines[0]), listed([3.0, -4.0], lines[1])], "{text}");
        }
    }

    #[test]
    fn other_lines_are_refused() {
        for (text, words) in [
            ("1,2\nx,y\n", "\"x,y\" in line 2"),
            ("1\n", "\"1\" in line 1"),
            ("1,2\n3,-4,9\n", "\"3,-4,9\" in line 2"),
            ("x,y,size\n1,2,3\n", "\"x,y,size\" in line 1"),
            ("1,NaN\n", "two finite numbers"),
            ("x,y\n", "number of points is 0"),
        ] {
            let error = decode(Path::new("p.csv"), text).unwrap_err().to_string();
            assert!(error.starts_with("p.csv: ") && error.contains(words), "{error}");
        }
    }
}
