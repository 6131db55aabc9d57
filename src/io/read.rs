//! Helpers of the readers: whole files of bounded length, and sizes checked before anything is allocated.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use crate::error::{Error, Result};
use crate::frame::Size;

/// The longest file of one image or flow field: the largest size at 8 bytes per pixel, and room for headers.
const MAX_FILE: u64 = (Size::MAX_SIDE as u64).pow(2) * 8 + (1 << 20);

/// Reads a file that holds one image or flow field.
pub(crate) fn read_file(path: &Path) -> Result<Vec<u8>> {
    let failed = |source| Error::io(path, source);
    let mut bytes = Vec::new();
    File::open(path).map_err(failed)?.take(MAX_FILE + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > MAX_FILE {
        let expected = format!("at most {MAX_FILE} bytes");
        return Err(Error::format(path, "file length", format!("over {MAX_FILE} bytes"), expected));
    }
    Ok(bytes)
}

/// The size that a file's header states, if it is in range.
pub(crate) fn header_size(path: &Path, width: i64, height: i64) -> Result<Size> {
    let size = || Size::new(u32::try_from(width).ok()?, u32::try_from(height).ok()?).validate().ok();
    size().ok_or_else(|| {
        let expected = format!("1×1 to {0}×{0}", Size::MAX_SIDE);
        Error::format(path, "size", format!("{width}×{height}"), expected)
    })
}

/// Checks a file's length against the one that its header requires.
pub(crate) fn check_length(path: &Path, found: usize, expected: u64) -> Result<()> {
    if found as u64 == expected {
        return Ok(());
    }
    Err(Error::format(
        path,
        "file length",
        format!("{found} bytes"),
        format!("{expected} bytes by its header"),
    ))
}

/// Little-endian `f32` values; remaining bytes at the end are ignored.
pub(crate) fn floats(bytes: &[u8]) -> impl Iterator<Item = f32> + '_ {
    bytes.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b))
}

/// Little-endian pairs of `f32`; remaining bytes at the end are ignored.
pub(crate) fn pairs(bytes: &[u8]) -> Vec<[f32; 2]> {
    let pair = |b: &[u8; 8]| [[b[0], b[1], b[2], b[3]], [b[4], b[5], b[6], b[7]]].map(f32::from_le_bytes);
    bytes.as_chunks::<8>().0.iter().map(pair).collect()
}

/// Replaces `data` by the next `count` bytes of a stream, or by fewer at its end. The memory grows with the bytes
/// that arrive, not with what a header promised.
pub(crate) fn fill(reader: &mut impl Read, count: u64, data: &mut Vec<u8>) -> io::Result<bool> {
    data.clear();
    reader.take(count).read_to_end(data)?;
    Ok(data.len() as u64 == count)
}
