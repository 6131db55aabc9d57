//! Writing YUV4MPEG2, for players and encoders.

use std::io::Write;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::frame::{Frame, PixelFormat, Size};

/// Writes a video frame by frame: gray as `mono`, colour as 4:4:4.
///
/// Gray bytes are written unchanged, so that a reader gets them back exactly. Colour is converted from the full range
/// to the limited range of ITU-R BT.601: luma 16 to 235, chroma 16 to 240.
#[derive(Debug)]
pub struct Y4mWriter<W> {
    writer: W,
    path: PathBuf,
    size: Size,
    format: PixelFormat,
    /// A frame's planes, kept to reuse the memory.
    planes: Vec<u8>,
}

impl<W: Write> Y4mWriter<W> {
    /// Writes the header. `rate` is frames and seconds, for example `(30000, 1001)`; `path` is the name for error
    /// messages. The writer should be buffered.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a size out of range, a rate with a 0, or a format other than [`PixelFormat::Gray8`]
    /// and [`PixelFormat::Rgb8`]; [`Error::Io`].
    pub fn new(
        mut writer: W,
        path: impl AsRef<Path>,
        size: Size,
        format: PixelFormat,
        rate: (u32, u32),
    ) -> Result<Self> {
        let path = path.as_ref().to_owned();
        size.validate()?;
        let space = match format {
            PixelFormat::Gray8 => "mono",
            PixelFormat::Rgb8 => "444",
            other => return Err(Error::parameter("format", other, "gray8 or rgb8")),
        };
        let (frames, seconds) = rate;
        if frames == 0 || seconds == 0 {
            return Err(Error::parameter("rate", format_args!("{frames}:{seconds}"), "two numbers over 0"));
        }
        let Size { width, height } = size;
        writeln!(writer, "YUV4MPEG2 W{width} H{height} F{frames}:{seconds} Ip A1:1 C{space}")
            .map_err(|source| Error::io(&path, source))?;
        Ok(Self { writer, path, size, format, planes: Vec::new() })
    }

    /// Writes a frame.
    ///
    /// # Errors
    /// [`Error::SizeMismatch`] or [`Error::PixelFormat`] if the frame differs from the header, [`Error::Io`].
    pub fn write_frame(&mut self, frame: &Frame<'_>) -> Result<()> {
        if frame.size() != self.size {
            let what = "video frame".to_owned();
            return Err(Error::SizeMismatch { what, found: frame.size(), expected: self.size });
        }
        if frame.format() != self.format {
            return Err(Error::PixelFormat { found: frame.format(), expected: self.format });
        }
        self.planes.clear();
        let rows = || (0..self.size.height).map(|y| frame.row(y));
        match self.format {
            PixelFormat::Rgb8 => {
                for weights in [LUMA, BLUE, RED] {
                    for row in rows() {
                        self.planes.extend(row.as_chunks::<3>().0.iter().map(|&rgb| limited(rgb, weights)));
                    }
                }
            }
            _ => rows().for_each(|row| self.planes.extend(row)),
        }
        self.writer
            .write_all(b"FRAME\n")
            .and_then(|()| self.writer.write_all(&self.planes))
            .map_err(|source| Error::io(&self.path, source))
    }

    /// Flushes, and returns the writer.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn finish(mut self) -> Result<W> {
        self.writer.flush().map_err(|source| Error::io(&self.path, source))?;
        Ok(self.writer)
    }
}

/// The offset, and the weights of red, green and blue between 0 and 1 (ITU-R BT.601, 8 bits).
type Weights = (f32, [f32; 3]);
const LUMA: Weights = (16.0, [65.481, 128.553, 24.966]);
const BLUE: Weights = (128.0, [-37.797, -74.203, 112.0]);
const RED: Weights = (128.0, [112.0, -93.786, -18.214]);

fn limited(rgb: [u8; 3], (offset, weights): Weights) -> u8 {
    let sum: f32 = rgb.iter().zip(weights).map(|(&c, w)| f32::from(c) * w).sum();
    (offset + sum / 255.0).round() as u8
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::frame::Image;
    use crate::io::Y4mReader;

    #[test]
    fn colours_have_the_values_of_bt601() {
        let convert = |rgb| [LUMA, BLUE, RED].map(|w| limited(rgb, w));
        assert_eq!(convert([0, 0, 0]), [16, 128, 128]);
        assert_eq!(convert([255, 255, 255]), [235, 128, 128]);
        assert_eq!(convert([255, 0, 0]), [81, 90, 240]);
        assert_eq!(convert([0, 255, 0]), [145, 54, 34]);
        assert_eq!(convert([0, 0, 255]), [41, 240, 110]);
    }

    #[test]
    fn gray_comes_back_and_colour_comes_back_as_luma() {
        let size = Size::new(3, 2);
        let gray = [0, 50, 100, 150, 200, 255];
        let rgb: Vec<u8> = gray.iter().flat_map(|&g| [g; 3]).collect();
        let luma = gray.map(|g| limited([g; 3], LUMA));
        for (format, data, expected) in
            [(PixelFormat::Gray8, &gray[..], gray), (PixelFormat::Rgb8, &rgb, luma)]
        {
            let mut video = Y4mWriter::new(Vec::new(), "v", size, format, (30, 1)).unwrap();
            for _ in 0..2 {
                video.write_frame(&Frame::new(size, format, data).unwrap()).unwrap();
            }
            let bytes = video.finish().unwrap();
            let (mut video, mut image) = (Y4mReader::new(&bytes[..], "v").unwrap(), Image::default());
            while video.next_frame(&mut image).unwrap() {
                assert_eq!(image.data, expected, "{format}");
            }
            assert_eq!((video.frames_read(), video.rate()), (2, Some((30, 1))));
        }
    }

    #[test]
    fn another_frame_than_announced_is_refused() {
        let mut video =
            Y4mWriter::new(Vec::new(), "v", Size::new(2, 2), PixelFormat::Gray8, (30, 1)).unwrap();
        let wide = Frame::new(Size::new(4, 1), PixelFormat::Gray8, &[0; 4]).unwrap();
        assert!(matches!(video.write_frame(&wide), Err(Error::SizeMismatch { .. })));
        let colour = Frame::new(Size::new(2, 2), PixelFormat::Rgb8, &[0; 12]).unwrap();
        assert!(matches!(video.write_frame(&colour), Err(Error::PixelFormat { .. })));
        assert!(Y4mWriter::new(Vec::new(), "v", Size::new(2, 2), PixelFormat::Gray16, (30, 1)).is_err());
        assert!(Y4mWriter::new(Vec::new(), "v", Size::new(2, 2), PixelFormat::Gray8, (30, 0)).is_err());
    }
}
