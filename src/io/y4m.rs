//! YUV4MPEG2 (`.y4m`), uncompressed video as `ffmpeg … -f yuv4mpegpipe -` writes it: a text header, then frames of
//! planar luma and chroma, each after a line `FRAME`. Described in mjpegtools' `yuv4mpeg(5)`; depths over 8 bits are
//! FFmpeg's extension, little-endian words of 16 bits.

use std::io::{self, Read};
use std::path::{Path, PathBuf};

use super::read::fill;
use super::y4m_header::{Header, MAGIC};
use crate::error::{Error, Result};
use crate::frame::{Image, PixelFormat, Size};

/// The longest accepted header or frame line, in bytes. FFmpeg's are below 200.
const MAX_LINE: usize = 4096;

/// Reads the luma of a video frame by frame. Chroma is skipped, never stored.
///
/// Luma is returned as stored, commonly 16 (black) to 235 (white) of 255. Luma of more than 8 bits becomes
/// [`PixelFormat::Gray16`], shifted up so that the file's highest bit is the highest of the 16.
#[derive(Debug)]
pub struct Y4mReader<R> {
    reader: R,
    path: PathBuf,
    header: Header,
    frames: u64,
}

impl<R: Read> Y4mReader<R> {
    /// Reads the header. `path` is the name for error messages. The reader should be buffered.
    ///
    /// # Errors
    /// [`Error::Format`] unless the header has a size in range and a known colour space, [`Error::Io`].
    pub fn new(mut reader: R, path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref().to_owned();
        // The magic word first, so that other content is not searched for the end of a line.
        let mut magic = Vec::new();
        let whole = fill(&mut reader, MAGIC.len() as u64, &mut magic).map_err(|e| Error::io(&path, e))?;
        if !whole || magic != MAGIC.as_bytes() {
            let found = format!("{:?}", String::from_utf8_lossy(&magic));
            return Err(Error::format(&path, "magic word", found, MAGIC));
        }
        let line = read_line(&mut reader, &path, "header")?;
        let header = Header::parse(&path, line.as_deref().unwrap_or_default())?;
        Ok(Self { reader, path, header, frames: 0 })
    }

    /// Width and height of every frame.
    pub fn size(&self) -> Size {
        self.header.size
    }

    /// The pixel format of the frames.
    pub fn format(&self) -> PixelFormat {
        if self.header.depth > 8 { PixelFormat::Gray16 } else { PixelFormat::Gray8 }
    }

    /// The frame rate as a fraction, frames per seconds, if the header states it.
    pub fn rate(&self) -> Option<(u32, u32)> {
        self.header.rate
    }

    /// The number of whole frames read.
    pub fn frames_read(&self) -> u64 {
        self.frames
    }

    /// The time from the first frame to the last one read, if the rate is known and a frame was read.
    pub fn time_s(&self) -> Option<f64> {
        let (frames, seconds) = self.header.rate?;
        Some(self.frames.checked_sub(1)? as f64 * f64::from(seconds) / f64::from(frames))
    }

    /// Reads the next frame into `image`, whose memory is reused. Returns false at the end of the video; `image` is
    /// left unchanged then.
    ///
    /// # Errors
    /// [`Error::Format`] if a frame does not start with `FRAME` or is truncated, with the number of whole frames
    /// before it; [`Error::Io`]. The content of `image` is unspecified then.
    pub fn next_frame(&mut self, image: &mut Image) -> Result<bool> {
        let Some(line) = read_line(&mut self.reader, &self.path, "frame header")? else { return Ok(false) };
        if line != "FRAME" && !line.starts_with("FRAME ") {
            let found: String = line.chars().take(40).collect();
            let expected = format!("FRAME after {} whole frames", self.frames);
            return Err(Error::format(&self.path, "frame header", format!("{found:?}"), expected));
        }
        let format = self.format();
        let luma = self.header.size.pixels() as u64 * format.bytes() as u64;
        let failed = |source| Error::io(&self.path, source);
        let whole = fill(&mut self.reader, luma, &mut image.data).map_err(failed)?;
        let chroma = self.header.chroma_samples() * format.bytes() as u64;
        let skipped = if whole { skip(&mut self.reader, chroma).map_err(failed)? } else { 0 };
        if !whole || skipped < chroma {
            let found = format!("cut off after {} whole frames", self.frames);
            return Err(Error::format(&self.path, "video", found, "whole frames to its end"));
        }
        if format == PixelFormat::Gray16 {
            let depth = self.header.depth;
            for sample in image.data.as_chunks_mut::<2>().0 {
                // A sample beyond its depth violates the format: white is the nearest meaning.
                let value = u16::from_le_bytes(*sample).min(u16::MAX >> (16 - depth));
                *sample = (value << (16 - depth)).to_ne_bytes();
            }
        }
        (image.size, image.format) = (self.header.size, format);
        self.frames += 1;
        Ok(true)
    }
}

/// A line without its end, or `None` at the regular end of the stream.
fn read_line(reader: &mut impl Read, path: &Path, what: &'static str) -> Result<Option<String>> {
    let mut line = Vec::new();
    let mut byte = Vec::new();
    loop {
        if !fill(reader, 1, &mut byte).map_err(|source| Error::io(path, source))? {
            if line.is_empty() && what != "header" {
                return Ok(None);
            }
            let found = format!("cut off after {} bytes", line.len());
            return Err(Error::format(path, what, found, "a line to its end"));
        }
        match byte[..] {
            [b'\n'] => return Ok(Some(String::from_utf8_lossy(&line).into_owned())),
            _ if line.len() == MAX_LINE => {
                let found = format!("over {MAX_LINE} bytes");
                return Err(Error::format(path, what, found, format!("a line of at most {MAX_LINE} bytes")));
            }
            _ => line.append(&mut byte),
        }
    }
}

fn skip(reader: &mut impl Read, count: u64) -> io::Result<u64> {
    io::copy(&mut reader.take(count), &mut io::sink())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn reader(bytes: &[u8]) -> Y4mReader<&[u8]> {
        Y4mReader::new(bytes, "a.y4m").unwrap()
    }

    #[test]
    fn chroma_of_an_odd_size_is_skipped() {
        let spaces = [("420jpeg", 8), ("422", 12), ("444", 18), ("mono", 0), ("411", 6), ("444alpha", 27)];
        for (space, chroma) in spaces {
            let mut bytes = format!("YUV4MPEG2 W3 H3 F25:1 Ip A1:1 C{space} XA=b\n").into_bytes();
            for frame in 0..2_u8 {
                bytes.extend(b"FRAME Ip\n");
                bytes.extend([frame + 10; 9]);
                bytes.extend(vec![200; chroma]);
            }
            let mut video = reader(&bytes);
            let mut image = Image::default();
            for frame in 0..2_u8 {
                assert!(video.next_frame(&mut image).unwrap(), "{space}");
                assert_eq!(image.data, [frame + 10; 9], "{space}");
                assert_eq!(video.time_s(), Some(f64::from(frame) / 25.0));
            }
            assert!(!video.next_frame(&mut image).unwrap(), "{space}");
            assert_eq!((image.size, image.format), (Size::new(3, 3), PixelFormat::Gray8));
        }
    }

    #[test]
    fn ten_bits_are_shifted_to_the_top_of_sixteen() {
        let mut bytes = b"YUV4MPEG2 W2 H1 C420p10\nFRAME\n".to_vec();
        bytes.extend([0xFF, 0x03, 0x01, 0x00, 9, 9, 9, 9]);
        let (mut video, mut image) = (reader(&bytes), Image::default());
        assert!(video.next_frame(&mut image).unwrap());
        let expected: Vec<u8> = [0xFFC0_u16, 0x0040].iter().flat_map(|v| v.to_ne_bytes()).collect();
        assert_eq!((image.format, image.data.clone()), (PixelFormat::Gray16, expected));
        assert_eq!(video.time_s(), None);
        assert!(!video.next_frame(&mut image).unwrap());
    }

    #[test]
    fn a_cut_frame_says_how_many_were_whole() {
        let bytes = b"YUV4MPEG2 W2 H2 F30:1 Cmono\nFRAME\n1234FRAME\n12";
        let (mut video, mut image) = (reader(bytes), Image::default());
        assert!(video.next_frame(&mut image).unwrap());
        let text = video.next_frame(&mut image).unwrap_err().to_string();
        assert_eq!(text, "a.y4m: video is cut off after 1 whole frames, expected whole frames to its end");
    }

    #[test]
    fn a_line_without_end_is_not_read_for_ever() {
        let mut bytes = b"YUV4MPEG2 W2 H2 ".to_vec();
        bytes.resize(1 << 20, b'X');
        let text = Y4mReader::new(&bytes[..], "a.y4m").unwrap_err().to_string();
        assert!(text.contains("header is over 4096 bytes"), "{text}");
    }
}
