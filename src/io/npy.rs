//! NumPy's `.npy`, the subset for flow and planes: `float32`, little-endian, row by row (C order), of shape
//! height × width × 2 or height × width. Versions 1.0 and 2.0 of the header are read, 1.0 is written.
//! Described in NumPy's documentation, `numpy.lib.format`.

use std::path::Path;

use super::npy_header::Header;
use super::read::{check_length, floats, header_size, pairs, read_file};
use super::write_bytes;
use crate::error::{Error, Result};
use crate::frame::{FlowField, Plane, Size};

/// Decodes a flow field in pixels from an array of height × width × 2. `path` is the name for error messages.
///
/// # Errors
/// [`Error::Format`] if the content is no such array of little-endian `float32` in C order, if its size is out of
/// range, or if the length is not exactly the one that the shape requires.
pub fn decode(path: &Path, bytes: &[u8]) -> Result<FlowField> {
    let (size, data) = split(path, bytes, &[2])?;
    Ok(FlowField { size, data: pairs(data) })
}

/// Encodes a flow field as an array of height × width × 2. Every value is kept, including NaN.
///
/// # Errors
/// [`Error::Parameter`] or [`Error::Length`] if size and data contradict each other.
pub fn encode(flow: &FlowField) -> Result<Vec<u8>> {
    flow.validate()?;
    Ok(join(flow.size, ", 2", flow.data.as_flattened()))
}

/// Decodes a plane from an array of height × width. `path` is the name for error messages.
///
/// # Errors
/// As in [`decode`], for the other shape.
pub fn decode_plane(path: &Path, bytes: &[u8]) -> Result<Plane> {
    let (size, data) = split(path, bytes, &[])?;
    Ok(Plane { size, data: floats(data).collect() })
}

/// Encodes a plane as an array of height × width. Every value is kept, including NaN.
///
/// # Errors
/// [`Error::Parameter`] or [`Error::Length`] if size and data contradict each other.
pub fn encode_plane(plane: &Plane) -> Result<Vec<u8>> {
    plane.validate()?;
    Ok(join(plane.size, "", &plane.data))
}

/// Encodes three values per pixel as an array of height × width × 3. `triples` holds one triple per pixel, row by
/// row. Every value is kept, including NaN.
///
/// # Errors
/// [`Error::Parameter`] for a size out of range, [`Error::Length`] if there are not as many triples as pixels.
pub fn encode_triples(size: Size, triples: &[[f32; 3]]) -> Result<Vec<u8>> {
    size.validate()?;
    if triples.len() != size.pixels() {
        return Err(Error::Length { what: "triples", found: triples.len(), expected: size.pixels() });
    }
    Ok(join(size, ", 3", triples.as_flattened()))
}

/// Reads a flow field. See [`decode`].
///
/// # Errors
/// [`Error::Io`], and the errors of [`decode`].
pub fn read(path: impl AsRef<Path>) -> Result<FlowField> {
    decode(path.as_ref(), &read_file(path.as_ref())?)
}

/// Writes a flow field atomically.
///
/// # Errors
/// The errors of [`encode`], and [`Error::Io`].
pub fn write(path: impl AsRef<Path>, flow: &FlowField) -> Result<()> {
    write_bytes(path, &encode(flow)?)
}

/// Reads a plane. See [`decode_plane`].
///
/// # Errors
/// [`Error::Io`], and the errors of [`decode_plane`].
pub fn read_plane(path: impl AsRef<Path>) -> Result<Plane> {
    decode_plane(path.as_ref(), &read_file(path.as_ref())?)
}

/// Writes a plane atomically.
///
/// # Errors
/// The errors of [`encode_plane`], and [`Error::Io`].
pub fn write_plane(path: impl AsRef<Path>, plane: &Plane) -> Result<()> {
    write_bytes(path, &encode_plane(plane)?)
}

/// The size and values of an array whose shape is height, width and then `inner`.
fn split<'a>(path: &Path, bytes: &'a [u8], inner: &[u64]) -> Result<(Size, &'a [u8])> {
    let (header, data) = Header::split(path, bytes)?;
    let size = match header.shape[..] {
        [height, width, ref rest @ ..] if rest == inner => {
            let side = |s: u64| i64::try_from(s).unwrap_or(i64::MAX);
            header_size(path, side(width), side(height))?
        }
        _ => {
            let expected = if inner.is_empty() { "(height, width)" } else { "(height, width, 2)" };
            return Err(Error::format(path, "shape", format!("{:?}", header.shape), expected));
        }
    };
    let values = size.pixels() as u64 * inner.iter().product::<u64>();
    check_length(path, bytes.len(), (bytes.len() - data.len()) as u64 + 4 * values)?;
    Ok((size, data))
}

fn join(size: Size, inner: &str, values: &[f32]) -> Vec<u8> {
    let mut bytes = Header::bytes(&format!("{}, {}{inner}", size.height, size.width));
    bytes.reserve_exact(4 * values.len());
    bytes.extend(values.iter().flat_map(|v| v.to_le_bytes()));
    bytes
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn array(header: &str, data: &[u8]) -> Vec<u8> {
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(data);
        bytes
    }

    fn refusal(header: &str) -> String {
        decode(Path::new("a.npy"), &array(header, &[0; 16])).unwrap_err().to_string()
    }

    #[test]
    fn a_header_as_numpy_writes_it_is_read() {
        let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 2, 2), }      \n";
        let data: Vec<u8> = [1.0_f32, -2.5, f32::NAN, 0.25].iter().flat_map(|v| v.to_le_bytes()).collect();
        let flow = decode(Path::new("a.npy"), &array(header, &data)).unwrap();
        assert_eq!((flow.size, flow.data[0]), (Size::new(2, 1), [1.0, -2.5]));
        assert!(flow.data[1][0].is_nan());
        assert_eq!(flow.data[1][1], 0.25);
    }

    #[test]
    fn what_is_written_begins_at_a_multiple_of_64_and_is_read_back() {
        let plane = Plane { size: Size::new(3, 2), data: vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0] };
        let bytes = encode_plane(&plane).unwrap();
        assert_eq!((bytes.len() - 24) % 64, 0);
        assert!(bytes[10..].starts_with(b"{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }"));
        assert_eq!(decode_plane(Path::new("a.npy"), &bytes).unwrap(), plane);
        assert!(decode(Path::new("a.npy"), &bytes).unwrap_err().to_string().contains("shape is [2, 3]"));
    }

    #[test]
    fn triples_have_three_values_a_pixel() {
        let bytes = encode_triples(Size::new(2, 1), &[[1.0, 2.0, 3.0], [4.0, 5.0, f32::NAN]]).unwrap();
        assert!(bytes[10..].starts_with(b"{'descr': '<f4', 'fortran_order': False, 'shape': (1, 2, 3), }"));
        assert_eq!(
            (&bytes[bytes.len() - 24..bytes.len() - 20], bytes.len() % 64),
            (&1_f32.to_le_bytes()[..], 24)
        );
        assert!(encode_triples(Size::new(2, 1), &[[0.0; 3]]).is_err());
    }

    #[test]
    fn a_version_2_header_is_read() {
        let header = b"{\"shape\":(1,1),\"fortran_order\":False,\"descr\":\"<f4\"}\n";
        let mut bytes = b"\x93NUMPY\x02\x00".to_vec();
        bytes.extend((header.len() as u32).to_le_bytes());
        bytes.extend(header);
        bytes.extend(7.5_f32.to_le_bytes());
        assert_eq!(decode_plane(Path::new("a.npy"), &bytes).unwrap().data, [7.5]);
    }

    #[test]
    fn other_arrays_are_refused_by_what_they_are() {
        let cases = [
            (
                "{'descr': '<f8', 'fortran_order': False, 'shape': (1, 2, 2)}",
                "element type is <f8, expected <f4",
            ),
            (
                "{'descr': '>f4', 'fortran_order': False, 'shape': (1, 2, 2)}",
                "element type is >f4, expected <f4",
            ),
            ("{'descr': '<f4', 'fortran_order': True, 'shape': (1, 2, 2)}", "order is Fortran, expected C"),
            ("{'descr': '<f4', 'fortran_order': False, 'shape': (1, 2, 3)}", "shape is [1, 2, 3], expected"),
            ("{'descr': '<f4', 'fortran_order': False, 'shape': (9, 9, 2)}", "file length is"),
            ("{'descr': '<f4', 'fortran_order': False, 'shape': (0, 9, 2)}", "size is 9×0, expected"),
            ("{'descr': '<f4', 'fortran_order': False, 'shape': (99999, 99999, 2)}", "size is 99999×99999"),
            ("{'descr': [('x', '<f4')], 'fortran_order': False, 'shape': (1, 2, 2)}", "header is"),
            ("{'descr': '<f4', 'shape': (1, 2, 2)}", "header is"),
            ("{'descr': '<f4', 'fortran_order': False, 'shape': (1, 2, 99999999999999999999)}", "header is"),
            ("[]", "header is"),
        ];
        for (header, expected) in cases {
            let text = refusal(header);
            assert!(text.contains(expected), "{header}: {text}");
        }
    }
}
