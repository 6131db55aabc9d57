//! Raw video: gray bytes, frame after frame, without a header.

use std::io::Read;
use std::path::{Path, PathBuf};

use super::read::fill;
use crate::error::{Error, Result};
use crate::frame::{Image, PixelFormat, Size};

/// Reads frames of [`PixelFormat::Gray8`] of a known size, as `ffmpeg … -f rawvideo -pix_fmt gray -` writes them.
#[derive(Debug)]
pub struct RawReader<R> {
    reader: R,
    path: PathBuf,
    size: Size,
    frames: u64,
}

impl<R: Read> RawReader<R> {
    /// A reader of frames of `size`. `path` is the name for error messages.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the size is out of range.
    pub fn new(reader: R, path: impl AsRef<Path>, size: Size) -> Result<Self> {
        Ok(Self { reader, path: path.as_ref().to_owned(), size: size.validate()?, frames: 0 })
    }

    /// Width and height of every frame.
    pub fn size(&self) -> Size {
        self.size
    }

    /// The number of whole frames read.
    pub fn frames_read(&self) -> u64 {
        self.frames
    }

    /// Reads the next frame into `image`, whose memory is reused. Returns false at the end of the stream; `image` is
    /// left unchanged then.
    ///
    /// # Errors
    /// [`Error::Format`] if the last frame is truncated, with the number of whole frames before it; [`Error::Io`].
    /// The content of `image` is unspecified then.
    pub fn next_frame(&mut self, image: &mut Image) -> Result<bool> {
        let count = self.size.pixels() as u64;
        let failed = |source| Error::io(&self.path, source);
        // The first byte separately, so that `image` still holds the last frame at the end of the stream.
        let mut first = Vec::new();
        if !fill(&mut self.reader, 1, &mut first).map_err(failed)? {
            return Ok(false);
        }
        if !fill(&mut first.as_slice().chain(&mut self.reader), count, &mut image.data).map_err(failed)? {
            let found = format!("cut off after {} whole frames and {} bytes", self.frames, image.data.len());
            let expected = format!("whole frames of {count} bytes ({})", self.size);
            return Err(Error::format(&self.path, "video", found, expected));
        }
        (image.size, image.format) = (self.size, PixelFormat::Gray8);
        self.frames += 1;
        Ok(true)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn frames_follow_each_other_to_the_clean_end() {
        let mut video = RawReader::new(&b"abcdef"[..], "v", Size::new(3, 1)).unwrap();
        let mut image = Image::default();
        assert!(video.next_frame(&mut image).unwrap());
        assert_eq!(image.data, b"abc");
        assert!(video.next_frame(&mut image).unwrap());
        assert_eq!(image.data, b"def");
        assert!(!video.next_frame(&mut image).unwrap());
        assert_eq!((video.frames_read(), &image.data[..]), (2, &b"def"[..]));
    }

    #[test]
    fn a_cut_frame_says_how_many_were_whole() {
        let mut video = RawReader::new(&b"abcd"[..], "v", Size::new(3, 1)).unwrap();
        let mut image = Image::default();
        assert!(video.next_frame(&mut image).unwrap());
        let text = video.next_frame(&mut image).unwrap_err().to_string();
        assert_eq!(
            text,
            "v: video is cut off after 1 whole frames and 1 bytes, expected whole frames of 3 bytes (3×1)"
        );
    }
}
