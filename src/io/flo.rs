//! Middlebury's `.flo`: the number 202021.25 as `f32`, width and height as `i32`, then `u, v` as `f32`, row by row,
//! all little-endian. Described in the `flowIO.cpp` of Baker et al., "A Database and Evaluation Methodology for
//! Optical Flow", IJCV 92 (2011). A component over 1e9 in magnitude marks an unknown displacement.

use std::path::Path;

use super::read::{check_length, header_size, pairs, read_file};
use super::write_bytes;
use crate::error::{Error, Result};
use crate::frame::{FlowField, UNKNOWN_FLOW};

/// The bytes spell `PIEH`.
const MAGIC: [u8; 4] = 202_021.25_f32.to_le_bytes();
const HEADER: usize = 12;

/// Decodes a flow field in pixels from the bytes of a `.flo` file. `path` is the name for error messages.
///
/// The values are returned as stored; ask [`FlowField::is_known`] which of them are unknown.
///
/// # Errors
/// [`Error::Format`] for a wrong magic number, a size out of range, or a length that is not exactly the one that the
/// size requires.
pub fn decode(path: &Path, bytes: &[u8]) -> Result<FlowField> {
    let Some((header, data)) = bytes.split_first_chunk::<HEADER>() else {
        let expected = format!("at least {HEADER} bytes");
        return Err(Error::format(path, "file length", format!("{} bytes", bytes.len()), expected));
    };
    let word = |at: usize| [header[at], header[at + 1], header[at + 2], header[at + 3]];
    if word(0) != MAGIC {
        let found = format!("{:?}", f32::from_le_bytes(word(0)));
        return Err(Error::format(path, "magic number", found, "202021.25"));
    }
    let side = |at| i64::from(i32::from_le_bytes(word(at)));
    let size = header_size(path, side(4), side(8))?;
    check_length(path, bytes.len(), HEADER as u64 + 8 * size.pixels() as u64)?;
    Ok(FlowField { size, data: pairs(data) })
}

/// Encodes a `.flo` file. Unknown displacements, including NaN, are written as [`UNKNOWN_FLOW`] in both components.
///
/// # Errors
/// [`Error::Parameter`] or [`Error::Length`] if size and data contradict each other.
pub fn encode(flow: &FlowField) -> Result<Vec<u8>> {
    flow.validate()?;
    let mut bytes = Vec::with_capacity(HEADER + 8 * flow.data.len());
    bytes.extend(MAGIC);
    bytes.extend(flow.size.width.to_le_bytes());
    bytes.extend(flow.size.height.to_le_bytes());
    for &uv in &flow.data {
        let [u, v] = if FlowField::is_known(uv) { uv } else { [UNKNOWN_FLOW; 2] };
        bytes.extend(u.to_le_bytes());
        bytes.extend(v.to_le_bytes());
    }
    Ok(bytes)
}

/// Reads a `.flo` file.
///
/// # Errors
/// [`Error::Io`], and the errors of [`decode`].
pub fn read(path: impl AsRef<Path>) -> Result<FlowField> {
    decode(path.as_ref(), &read_file(path.as_ref())?)
}

/// Writes a `.flo` file atomically.
///
/// # Errors
/// The errors of [`encode`], and [`Error::Io`].
pub fn write(path: impl AsRef<Path>, flow: &FlowField) -> Result<()> {
    write_bytes(path, &encode(flow)?)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::frame::Size;

    #[test]
    fn bytes_are_those_of_the_format() {
        let flow = FlowField { size: Size::new(2, 1), data: vec![[1.5, -2.0], [f32::NAN, 0.0]] };
        let bytes = encode(&flow).unwrap();
        assert_eq!(&bytes[..12], b"PIEH\x02\0\0\0\x01\0\0\0");
        assert_eq!(bytes[12..16], 1.5_f32.to_le_bytes());
        let back = decode(Path::new("a.flo"), &bytes).unwrap();
        assert_eq!(back.data, [[1.5, -2.0], [UNKNOWN_FLOW; 2]]);
        assert!(!FlowField::is_known(back.data[1]));
    }

    #[test]
    fn a_long_file_is_an_error_that_names_both_lengths() {
        let flow = FlowField { size: Size::new(1, 1), data: vec![[0.0; 2]] };
        let mut bytes = encode(&flow).unwrap();
        bytes.push(0);
        let text = decode(Path::new("a.flo"), &bytes).unwrap_err().to_string();
        assert_eq!(text, "a.flo: file length is 21 bytes, expected 20 bytes by its header");
    }
}
