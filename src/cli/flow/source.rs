//! The source of frames, all of one size and pixel format.

use std::path::PathBuf;

use crate::error::{Error, Result};
use crate::frame::{Image, PixelFormat, Size};
use crate::io::Frames;
use crate::live::FrameSource;

/// A source of frames of one size and pixel format. An error about one that differs also names the first frame.
pub(in crate::cli) struct Source {
    frames: Frames,
    /// The name by which errors refer to frames that are not files of their own.
    stream: PathBuf,
    first: Option<(PathBuf, PixelFormat)>,
}

impl Source {
    pub(in crate::cli) fn open(inputs: &[String], raw: Option<Size>) -> Result<Self> {
        let frames = Frames::open(inputs, raw)?;
        if raw.is_some() && inputs != ["-"] {
            return Err(Error::parameter("--raw", "given", "none unless the input is -"));
        }
        let stream = if inputs == ["-"] { "standard input".to_owned() } else { inputs.join(" ") };
        Ok(Self { frames, stream: stream.into(), first: None })
    }

    /// The number of frames, where it is known in advance.
    pub(in crate::cli) fn len(&self) -> Option<u64> {
        self.frames.len()
    }

    /// The frame rate as a fraction, where the source states it.
    pub(in crate::cli) fn rate(&self) -> Option<(u32, u32)> {
        self.frames.rate()
    }

    /// The name of the last frame read.
    pub(in crate::cli) fn name(&self) -> PathBuf {
        self.frames.path().map_or_else(|| self.stream.clone(), PathBuf::from)
    }

    /// Reads the next frame into `image`. Returns false after the last one.
    pub(in crate::cli) fn next(&mut self, image: &mut Image) -> Result<bool> {
        let read = self.frames.next_frame(image);
        let more = match (read, &self.first) {
            (Err(Error::SizeMismatch { what, found, expected }), Some((first, _))) => {
                let expected = format!("{expected} as in {}", first.display());
                return Err(Error::format(what, "size", found, expected));
            }
            (read, _) => read?,
        };
        if more {
            let name = self.name();
            let (first, format) = self.first.get_or_insert_with(|| (name.clone(), image.format));
            if image.format != *format {
                let expected = format!("{format} as in {}", first.display());
                return Err(Error::format(name, "pixel format", image.format, expected));
            }
        }
        Ok(more)
    }

    /// Reads the first two frames, the minimum for a flow.
    pub(in crate::cli) fn first_two(&mut self) -> Result<[Image; 2]> {
        let mut images = [Image::default(), Image::default()];
        for (count, image) in images.iter_mut().enumerate() {
            if !self.next(image)? {
                return Err(Error::format(&self.stream, "number of frames", count, "at least 2"));
            }
        }
        Ok(images)
    }

    /// Reads the third frame, the minimum for a flow that counts an older one.
    pub(in crate::cli) fn third(&mut self) -> Result<Image> {
        let mut image = Image::default();
        match self.next(&mut image)? {
            true => Ok(image),
            false => Err(Error::format(&self.stream, "number of frames", 2, "at least 3 for a third frame")),
        }
    }
}

impl FrameSource for Source {
    fn next_frame(&mut self, image: &mut Image) -> Result<bool> {
        self.next(image)
    }
}
