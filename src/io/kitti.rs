//! KITTI's flow images: PNG with 16-bit RGB, `u = (R − 2¹⁵)/64`, `v = (G − 2¹⁵)/64` in pixels, and B = 0 where the
//! displacement is unknown. Described in the development kit of Menze and Geiger, "Object Scene Flow for Autonomous
//! Vehicles", CVPR 2015. The format holds displacements from −512 to 511.984 px, in steps of 1/64 px.

use std::path::Path;

use super::picture::{self, Decoded};
use super::read::read_file;
use super::write_bytes;
use crate::error::{Error, Result};
use crate::frame::{FlowField, UNKNOWN_FLOW};

const ZERO: f32 = 32768.0;
const STEPS: f32 = 64.0;

/// Decodes a flow field in pixels from the bytes of a KITTI PNG. `path` is the name for error messages.
///
/// A pixel that the file marks as invalid becomes [`UNKNOWN_FLOW`] in both components.
///
/// # Errors
/// [`Error::Format`] if the content is not a PNG, not 16-bit RGB, truncated, or of a size out of range.
pub fn decode(path: &Path, bytes: &[u8]) -> Result<FlowField> {
    if !bytes.starts_with(b"\x89PNG\r\n\x1a\n") {
        return Err(picture::unknown_content(path, bytes, "a PNG signature"));
    }
    let Decoded { size, picture } = picture::decode_dynamic(path, bytes)?;
    let image::DynamicImage::ImageRgb16(picture) = picture else {
        let found = format!("{:?}", picture.color());
        return Err(Error::format(path, "pixel format", found, "16-bit RGB of a KITTI flow"));
    };
    let flow = |p: &[u16; 3]| match *p {
        [_, _, 0] => [UNKNOWN_FLOW; 2],
        [r, g, _] => [r, g].map(|c| (f32::from(c) - ZERO) / STEPS),
    };
    let data = picture.as_raw().as_chunks::<3>().0.iter().map(flow).collect();
    Ok(FlowField { size, data })
}

/// Encodes a KITTI PNG. Components are rounded to the nearest 1/64 px; a displacement that is unknown or that the
/// format cannot hold is marked as invalid (0, 0, 0), never clamped to a wrong value.
///
/// # Errors
/// [`Error::Parameter`] or [`Error::Length`] if size and data contradict each other.
pub fn encode(flow: &FlowField) -> Result<Vec<u8>> {
    flow.validate()?;
    let mut bytes = Vec::with_capacity(6 * flow.data.len());
    for &[u, v] in &flow.data {
        let pixel = match (stored(u), stored(v)) {
            (Some(r), Some(g)) => [r, g, 1],
            _ => [0; 3],
        };
        bytes.extend(pixel.iter().flat_map(|c| c.to_ne_bytes()));
    }
    picture::encode_png_as(flow.size, &bytes, image::ExtendedColorType::Rgb16)
}

/// The stored sample of a component; none if it is NaN or out of range.
fn stored(component: f32) -> Option<u16> {
    // 64 is a power of two: the product is exact, and so is the rounding.
    let sample = (component * STEPS).round() + ZERO;
    (0.0..=65535.0).contains(&sample).then_some(sample as u16)
}

/// Reads a KITTI PNG.
///
/// # Errors
/// [`Error::Io`], and the errors of [`decode`].
pub fn read(path: impl AsRef<Path>) -> Result<FlowField> {
    decode(path.as_ref(), &read_file(path.as_ref())?)
}

/// Writes a KITTI PNG atomically.
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
    use crate::frame::{Image, PixelFormat, Size};

    #[test]
    fn rounds_to_a_64th_and_marks_what_it_cannot_hold() {
        let data = vec![
            [0.0, -512.0],
            [512.0 - 1.0 / 64.0, 0.007],
            [0.008, -0.25],
            [512.0, 0.0],
            [0.0, -512.01],
            [f32::NAN, 1.0],
            [f32::INFINITY, 1.0],
            [UNKNOWN_FLOW; 2],
        ];
        let flow = FlowField { size: Size::new(4, 2), data };
        let back = decode(Path::new("a.png"), &encode(&flow).unwrap()).unwrap();
        let none = [UNKNOWN_FLOW; 2];
        let known = [[0.0, -512.0], [512.0 - 1.0 / 64.0, 0.0], [1.0 / 64.0, -0.25]];
        assert_eq!(back.data[..3], known);
        assert_eq!(back.data[3..], [none; 5]);
    }

    #[test]
    fn an_eight_bit_picture_is_refused_by_name() {
        let image = Image { size: Size::new(1, 1), format: PixelFormat::Rgb8, data: vec![1, 2, 3] };
        let bytes = picture::encode_png(&image).unwrap();
        let text = decode(Path::new("a.png"), &bytes).unwrap_err().to_string();
        assert_eq!(text, "a.png: pixel format is Rgb8, expected 16-bit RGB of a KITTI flow");
    }
}
