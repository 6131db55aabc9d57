//! The header of `.npy`: a Python dictionary as text, with exactly the three keys of the format.

use std::path::Path;

use crate::error::{Error, Result};

const MAGIC: &[u8] = b"\x93NUMPY";
/// The longest header; NumPy itself refuses longer ones.
const MAX_HEADER: usize = 10_000;

/// What a header of little-endian `float32` in C order states besides: the shape.
pub(super) struct Header {
    pub(super) shape: Vec<u64>,
}

impl Header {
    /// Parses the header, and returns it with the bytes after it.
    pub(super) fn split<'a>(path: &Path, bytes: &'a [u8]) -> Result<(Self, &'a [u8])> {
        let short = || {
            Error::format(
                path,
                "file length",
                format!("{} bytes", bytes.len()),
                "a whole header of NumPy's format",
            )
        };
        if !bytes.starts_with(MAGIC) {
            let found = format!("{:02x?}", &bytes[..bytes.len().min(MAGIC.len())]);
            return Err(Error::format(path, "magic number", found, format!("{MAGIC:02x?} (\\x93NUMPY)")));
        }
        let (version, rest) = bytes[MAGIC.len()..].split_first_chunk::<2>().ok_or_else(short)?;
        let (length, rest) = match version {
            [1, 0] => {
                rest.split_first_chunk::<2>().map(|(n, rest)| (u32::from(u16::from_le_bytes(*n)), rest))
            }
            [2, 0] => rest.split_first_chunk::<4>().map(|(n, rest)| (u32::from_le_bytes(*n), rest)),
            [major, minor] => {
                return Err(Error::format(path, "version", format!("{major}.{minor}"), "1.0 or 2.0"));
            }
        }
        .ok_or_else(short)?;
        let length = length as usize;
        if length > MAX_HEADER {
            let expected = format!("at most {MAX_HEADER} bytes");
            return Err(Error::format(path, "header length", format!("{length} bytes"), expected));
        }
        let (text, data) = rest.split_at_checked(length).ok_or_else(short)?;
        Ok((Self::parse(path, text)?, data))
    }

    /// A whole header of version 1.0. `shape` is the text between the parentheses.
    pub(super) fn bytes(shape: &str) -> Vec<u8> {
        let mut text = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({shape}), }}");
        // The data starts at a multiple of 64 bytes, so that it can be mapped into memory.
        let before = MAGIC.len() + 4;
        let length = (before + text.len() + 1).next_multiple_of(64) - before;
        text.push_str(&" ".repeat(length - text.len() - 1));
        text.push('\n');
        let mut bytes = MAGIC.to_vec();
        bytes.extend([1, 0]);
        bytes.extend((length as u16).to_le_bytes());
        bytes.extend(text.as_bytes());
        bytes
    }

    fn parse(path: &Path, text: &[u8]) -> Result<Self> {
        let text = String::from_utf8_lossy(text);
        let Some((descr, fortran, shape)) = dictionary(text.trim()) else {
            let found: String = text.trim().chars().take(120).collect();
            let expected = "a dictionary of descr, fortran_order and shape";
            return Err(Error::format(path, "header", format!("{found:?}"), expected));
        };
        if descr != "<f4" {
            let expected = "<f4 (little-endian float32)";
            return Err(Error::format(path, "element type", descr.escape_debug(), expected));
        }
        if fortran {
            return Err(Error::format(path, "order", "Fortran", "C (row by row)"));
        }
        Ok(Self { shape })
    }
}

/// The three values of the dictionary, if it has exactly these keys and nothing else.
fn dictionary(text: &str) -> Option<(&str, bool, Vec<u64>)> {
    let (mut descr, mut fortran, mut shape) = (None, None, None);
    let mut rest = text.strip_prefix('{')?.trim_start();
    while !rest.starts_with('}') {
        let (key, after) = quoted(rest)?;
        let value = after.trim_start().strip_prefix(':')?.trim_start();
        rest = match key {
            "descr" => store(&mut descr, quoted(value)?),
            "fortran_order" => store(&mut fortran, boolean(value)?),
            "shape" => store(&mut shape, tuple(value)?),
            _ => return None,
        }?;
        rest = match rest.trim_start() {
            more if more.starts_with(',') => more[1..].trim_start(),
            end if end.starts_with('}') => end,
            _ => return None,
        };
    }
    (rest == "}").then_some((descr?, fortran?, shape?))
}

/// Stores a value and returns the text after it. A repeated key is refused.
fn store<'a, T>(slot: &mut Option<T>, (value, rest): (T, &'a str)) -> Option<&'a str> {
    slot.replace(value).is_none().then_some(rest)
}

fn quoted(text: &str) -> Option<(&str, &str)> {
    let quote = text.chars().next().filter(|c| matches!(c, '\'' | '"'))?;
    text[1..].split_once(quote)
}

fn boolean(text: &str) -> Option<(bool, &str)> {
    let yes = text.strip_prefix("True").map(|rest| (true, rest));
    yes.or_else(|| text.strip_prefix("False").map(|rest| (false, rest)))
}

fn tuple(text: &str) -> Option<(Vec<u64>, &str)> {
    let (inside, rest) = text.strip_prefix('(')?.split_once(')')?;
    let inside = inside.trim();
    // A tuple of one has a trailing comma.
    let inside = inside.strip_suffix(',').unwrap_or(inside);
    let sides = inside.split(',').map(|side| side.trim().parse().ok()).collect::<Option<Vec<u64>>>()?;
    Some((sides, rest))
}
