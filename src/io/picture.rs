//! Images in PNG, JPEG and PNM files. The content tells the format; the name does not matter.

use std::io::Cursor;
use std::path::Path;

use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::PngEncoder;
use image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder, ImageFormat, ImageReader, Limits};

use super::read::{header_size, read_file};
use super::write_bytes;
use crate::error::{Error, Result};
use crate::frame::{Image, PixelFormat, Size};

/// A decoder's image, its size checked.
pub(super) struct Decoded {
    pub(super) size: Size,
    pub(super) picture: DynamicImage,
}

/// Decodes an image from the bytes of a PNG, JPEG or PNM (PBM, PGM, PPM, PAM) file. `path` is the name for error
/// messages.
///
/// Gray stays gray ([`PixelFormat::Gray8`] or [`PixelFormat::Gray16`], alpha dropped); palettes and colour become
/// [`PixelFormat::Rgb8`] or [`PixelFormat::Rgba8`], with 16-bit colour rounded to 8. PNM samples are scaled so that
/// the file's largest value is white.
///
/// # Errors
/// [`Error::Format`] if the content is none of these formats, is truncated or damaged, or has a size out of range.
pub fn decode(path: &Path, bytes: &[u8]) -> Result<Image> {
    let Decoded { size, picture } = decode_dynamic(path, bytes)?;
    let wide = |samples: Vec<u16>| samples.into_iter().flat_map(u16::to_ne_bytes).collect();
    let (format, data) = match picture {
        DynamicImage::ImageLuma8(_) | DynamicImage::ImageLumaA8(_) => {
            (PixelFormat::Gray8, picture.into_luma8().into_raw())
        }
        DynamicImage::ImageLuma16(_) | DynamicImage::ImageLumaA16(_) => {
            (PixelFormat::Gray16, wide(picture.into_luma16().into_raw()))
        }
        picture if picture.color().has_alpha() => (PixelFormat::Rgba8, picture.into_rgba8().into_raw()),
        picture => (PixelFormat::Rgb8, picture.into_rgb8().into_raw()),
    };
    Ok(Image { size, format, data })
}

/// Reads an image. See [`decode`].
///
/// # Errors
/// [`Error::Io`], and the errors of [`decode`].
pub fn read(path: impl AsRef<Path>) -> Result<Image> {
    decode(path.as_ref(), &read_file(path.as_ref())?)
}

/// Reads two images of one size and pixel format.
///
/// # Errors
/// As [`read`]; [`Error::Format`] naming both if the second one's size or format differs from the first one's.
pub fn read_pair(first: impl AsRef<Path>, second: impl AsRef<Path>) -> Result<[Image; 2]> {
    let (first, second) = (first.as_ref(), second.as_ref());
    let images = [read(first)?, read(second)?];
    let [one, two] = &images;
    if two.size != one.size {
        let expected = format_args!("{} as in {}", one.size, first.display());
        return Err(Error::format(second, "size", two.size, expected));
    }
    if two.format != one.format {
        let expected = format_args!("{} as in {}", one.format, first.display());
        return Err(Error::format(second, "pixel format", two.format, expected));
    }
    Ok(images)
}

/// Encodes a PNG file, in the image's own pixel format.
///
/// # Errors
/// As in [`Image::frame`], if the image contradicts itself.
pub fn encode_png(image: &Image) -> Result<Vec<u8>> {
    image.frame()?;
    let colour = match image.format {
        PixelFormat::Gray8 => ExtendedColorType::L8,
        PixelFormat::Gray16 => ExtendedColorType::L16,
        PixelFormat::Rgb8 => ExtendedColorType::Rgb8,
        PixelFormat::Rgba8 => ExtendedColorType::Rgba8,
    };
    encode_png_as(image.size, &image.data, colour)
}

/// The bytes of a JPEG file of 8-bit gray or RGB, at a quality from 1 to 100.
///
/// # Errors
/// [`Error::Parameter`] for another pixel format or quality; as [`Image::frame`], if the image contradicts itself.
pub fn encode_jpeg(image: &Image, quality: u8) -> Result<Vec<u8>> {
    image.frame()?;
    if !(1..=100).contains(&quality) {
        return Err(Error::parameter("quality", quality, "1 to 100"));
    }
    let colour = match image.format {
        PixelFormat::Gray8 => ExtendedColorType::L8,
        PixelFormat::Rgb8 => ExtendedColorType::Rgb8,
        other => return Err(Error::parameter("pixel format", other, "8-bit gray or RGB")),
    };
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, quality)
        .write_image(&image.data, image.size.width, image.size.height, colour)
        .map_err(|problem| Error::io("JPEG encoder", std::io::Error::other(problem)))?;
    Ok(bytes)
}

/// Writes a PNG file atomically.
///
/// # Errors
/// The errors of [`encode_png`], and [`Error::Io`].
pub fn write_png(path: impl AsRef<Path>, image: &Image) -> Result<()> {
    write_bytes(path, &encode_png(image)?)
}

pub(super) fn encode_png_as(size: Size, data: &[u8], colour: ExtendedColorType) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes)
        .write_image(data, size.width, size.height, colour)
        .map_err(|problem| Error::io("PNG encoder", std::io::Error::other(problem)))?;
    Ok(bytes)
}

pub(super) fn decode_dynamic(path: &Path, bytes: &[u8]) -> Result<Decoded> {
    match image::guess_format(bytes) {
        Ok(format @ (ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::Pnm)) => {
            match format {
                ImageFormat::Jpeg => check_jpeg_end(path, bytes)?,
                ImageFormat::Png => check_png_size(path, bytes)?,
                _ => {}
            }
            let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
            reader.limits(limits());
            let decoder = reader.into_decoder().map_err(|e| broken(path, &e))?;
            let (width, height) = decoder.dimensions();
            let size = header_size(path, width.into(), height.into())?;
            let most = most_pixels(format, bytes);
            if size.pixels() as u64 > most {
                let expected = format!("at most {most} pixels in a file of {} bytes", bytes.len());
                return Err(Error::format(path, "size", size, expected));
            }
            let picture = DynamicImage::from_decoder(decoder).map_err(|e| broken(path, &e))?;
            Ok(Decoded { size, picture })
        }
        _ => Err(unknown_content(path, bytes, "a PNG, JPEG, PGM or PPM picture")),
    }
}

/// The most pixels that a file of this length can hold, so that a short file cannot claim much memory.
fn most_pixels(format: ImageFormat, bytes: &[u8]) -> u64 {
    let bits = bytes.len() as u64 * 8;
    match format {
        // Deflate compresses by 1032 at best. Bits per sample and colour type are at the end of the first chunk.
        ImageFormat::Png => {
            let channels = [1, 1, 3, 1, 2, 1, 4];
            let depth = bytes.get(24).map_or(1, |&depth| u64::from(depth).max(1));
            let kind = bytes.get(25).map_or(0, |&kind| usize::from(kind));
            bits * 1032 / (depth * channels.get(kind).copied().unwrap_or(1))
        }
        // A block of 8×8 pixels takes at least one bit.
        ImageFormat::Jpeg => bits * 64,
        // A bitmap takes one bit per pixel, everything else more.
        _ => bits,
    }
}

fn limits() -> Limits {
    let mut limits = Limits::default();
    limits.max_image_width = Some(Size::MAX_SIDE);
    limits.max_image_height = Some(Size::MAX_SIDE);
    limits.max_alloc = Some(u64::from(Size::MAX_SIDE).pow(2) * 8 + (1 << 20));
    limits
}

/// Checks the size in a PNG's header: the decoder refuses a bad one without naming it.
fn check_png_size(path: &Path, bytes: &[u8]) -> Result<()> {
    let side = |at: usize| Some(u32::from_be_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    match (side(16), side(20)) {
        (Some(width), Some(height)) => header_size(path, width.into(), height.into()).map(|_| ()),
        // Too short for a header, which the decoder reports.
        _ => Ok(()),
    }
}

/// Checks that the scans of a JPEG are followed by the end marker. The decoder itself would fill the missing rest of
/// a truncated file with gray, which is worse than an error.
fn check_jpeg_end(path: &Path, bytes: &[u8]) -> Result<()> {
    let mut at = 2;
    // Skip segments by their length, because a thumbnail inside one has an end marker of its own.
    while let Some(&[0xFF, kind, high, low]) = bytes.get(at..at + 4) {
        if kind == 0xFF {
            at += 1;
            continue;
        }
        at += 2 + usize::from(u16::from_be_bytes([high, low]));
        if kind == 0xDA {
            break;
        }
    }
    let scans = bytes.get(at..).unwrap_or_default();
    if scans.windows(2).any(|pair| pair == [0xFF, 0xD9]) {
        return Ok(());
    }
    Err(Error::format(path, "picture", "cut off", "a JPEG with its end marker"))
}

/// The error for content in none of the accepted formats.
pub(super) fn unknown_content(path: &Path, bytes: &[u8], expected: &'static str) -> Error {
    let found = match bytes {
        [] => "an empty file".to_owned(),
        _ => format!("{:02x?}", &bytes[..bytes.len().min(8)]),
    };
    Error::format(path, "content", found, expected)
}

fn broken(path: &Path, problem: &image::ImageError) -> Error {
    // Some of the decoder's messages have several lines; an error has one.
    let found = problem.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
    Error::format(path, "picture", format!("damaged ({found})"), "a whole one")
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn load(bytes: &[u8]) -> Image {
        decode(Path::new("a"), bytes).unwrap()
    }

    #[test]
    fn a_png_of_no_legal_size_is_refused_with_its_size() {
        let mut bytes = encode_png(&load(b"P5\n3 1\n255\n\x00\x32\x64")).unwrap();
        for (side, size) in [(0_u32, "0×1"), (20000, "20000×1")] {
            bytes[16..20].copy_from_slice(&side.to_be_bytes());
            let text = decode(Path::new("a.png"), &bytes).unwrap_err().to_string();
            assert_eq!(text, format!("a.png: size is {size}, expected 1×1 to 16384×16384"));
        }
    }

    #[test]
    fn pnm_in_8_and_16_bits_is_scaled_to_its_white() {
        let gray = load(b"P5\n3 1\n100\n\x00\x32\x64");
        assert_eq!((gray.format, gray.data), (PixelFormat::Gray8, vec![0, 128, 255]));
        let wide = load(b"P5\n2 1\n1023\n\x03\xff\x00\x01");
        let expected: Vec<u8> = [65535_u16, 64].iter().flat_map(|v| v.to_ne_bytes()).collect();
        assert_eq!((wide.format, wide.data), (PixelFormat::Gray16, expected));
        let colour = load(b"P6 1 1 255\n\x01\x02\x03");
        assert_eq!((colour.format, colour.data), (PixelFormat::Rgb8, vec![1, 2, 3]));
        let bits = load(b"P1\n2 1\n1 0\n");
        assert_eq!((bits.format, bits.data), (PixelFormat::Gray8, vec![0, 255]));
    }

    #[test]
    fn png_of_every_kind_finds_its_format() {
        let size = Size::new(1, 1);
        let cases: [(&[u8], ExtendedColorType, PixelFormat, &[u8]); 5] = [
            (&[7, 9], ExtendedColorType::La8, PixelFormat::Gray8, &[7]),
            (&[7, 7, 9, 9], ExtendedColorType::La16, PixelFormat::Gray16, &[7, 7]),
            (&[9, 9, 0, 0, 255, 255], ExtendedColorType::Rgb16, PixelFormat::Rgb8, &[9, 0, 255]),
            (&[8; 8], ExtendedColorType::Rgba16, PixelFormat::Rgba8, &[8; 4]),
            (&[3; 4], ExtendedColorType::Rgba8, PixelFormat::Rgba8, &[3; 4]),
        ];
        for (data, colour, format, expected) in cases {
            let image = load(&encode_png_as(size, data, colour).unwrap());
            assert_eq!((image.format, &image.data[..]), (format, expected), "{colour:?}");
        }
    }

    #[test]
    fn what_we_write_we_read() {
        for format in [PixelFormat::Gray8, PixelFormat::Gray16, PixelFormat::Rgb8, PixelFormat::Rgba8] {
            let data = (0..15 * format.bytes()).map(|i| i as u8).collect();
            let image = Image { size: Size::new(5, 3), format, data };
            assert_eq!(load(&encode_png(&image).unwrap()), image);
        }
    }

    #[test]
    fn a_jpeg_is_nearly_the_picture() {
        for format in [PixelFormat::Gray8, PixelFormat::Rgb8] {
            let ramp = (0..64).flat_map(|i| std::iter::repeat_n(4 * i as u8, format.bytes()));
            let image = Image { size: Size::new(8, 8), format, data: ramp.collect() };
            let found = load(&encode_jpeg(&image, 95).unwrap());
            assert_eq!((found.format, found.size), (format, image.size));
            let worst = found.data.iter().zip(&image.data).map(|(a, b)| a.abs_diff(*b)).max();
            // Quantisation steps are 1 to 10 at this quality, and the ramp has few of the coarse ones.
            assert!(worst.is_some_and(|worst| worst <= 6), "{worst:?}");
        }
        let deep = Image { size: Size::new(1, 1), format: PixelFormat::Gray16, data: vec![0; 2] };
        assert!(matches!(encode_jpeg(&deep, 90), Err(Error::Parameter { name: "pixel format", .. })));
        assert!(matches!(encode_jpeg(&deep, 0), Err(Error::Parameter { name: "quality", .. })));
    }

    #[test]
    fn unknown_content_is_named() {
        let text = decode(Path::new("a.png"), b"hello").unwrap_err().to_string();
        assert!(text.starts_with("a.png: content is [68, 65, 6c, 6c, 6f], expected a PNG"), "{text}");
    }
}
