//! A sequence of frames from any source.

use std::fs::File;
use std::io::{BufReader, Cursor, Read};
use std::path::{Path, PathBuf};

use super::read::fill;
use super::y4m_header::MAGIC;
use super::{RawReader, Y4mReader, picture, sequence};
use crate::error::{Error, Result};
use crate::frame::{Image, Size};

type Stream = Box<dyn Read + Send>;

/// A source of frames of one size: image files, a video file, or a stream.
pub struct Frames(Source);

enum Source {
    Pictures { paths: Vec<PathBuf>, next: usize, size: Option<Size> },
    Y4m(Y4mReader<Stream>),
    Raw(RawReader<Stream>),
}

impl Frames {
    /// Opens the source that the arguments name:
    /// - `-` is standard input, see [`Frames::from_stream`];
    /// - a name that ends in `.y4m` is a video;
    /// - all others are images, in the order given, where each argument may be a pattern ([`sequence::expand`]).
    ///
    /// # Errors
    /// [`Error::Parameter`] if there is no argument, or a video or `-` beside others; the errors of
    /// [`sequence::expand`] and [`Frames::from_stream`]; [`Error::Io`]. Images are opened only when they are read.
    pub fn open(arguments: &[String], raw_size: Option<Size>) -> Result<Self> {
        let video = |argument: &String| {
            let extension = Path::new(argument).extension();
            argument == "-" || extension.is_some_and(|e| e.eq_ignore_ascii_case("y4m"))
        };
        match arguments {
            [] => Err(Error::parameter("input", "missing", "images, a .y4m file, or - for standard input")),
            [one] if one == "-" => {
                Self::from_stream(Box::new(BufReader::new(std::io::stdin())), "standard input", raw_size)
            }
            [one] if video(one) => {
                let file = File::open(one).map_err(|source| Error::io(one, source))?;
                let stream: Stream = Box::new(BufReader::with_capacity(1 << 16, file));
                Ok(Self(Source::Y4m(Y4mReader::new(stream, one)?)))
            }
            many => {
                if let Some(one) = many.iter().find(|argument| video(argument)) {
                    let expected = "a video or a stream alone, or images only";
                    return Err(Error::parameter("input", format_args!("{one} beside others"), expected));
                }
                let lists =
                    many.iter().map(|argument| sequence::expand(argument)).collect::<Result<Vec<_>>>()?;
                Ok(Self(Source::Pictures { paths: lists.concat(), next: 0, size: None }))
            }
        }
    }

    /// Opens a stream, named `path` in error messages: YUV4MPEG2 if it starts with that word, otherwise raw gray
    /// bytes of `raw_size`.
    ///
    /// # Errors
    /// [`Error::Format`] if the stream is empty, [`Error::Parameter`] if a raw size is needed and missing, the errors
    /// of [`Y4mReader::new`], [`Error::Io`].
    pub fn from_stream(
        mut stream: Box<dyn Read + Send>,
        path: impl AsRef<Path>,
        raw_size: Option<Size>,
    ) -> Result<Self> {
        let path = path.as_ref();
        let mut start = Vec::new();
        fill(&mut stream, MAGIC.len() as u64, &mut start).map_err(|source| Error::io(path, source))?;
        if start.is_empty() {
            return Err(Error::format(path, "stream", "empty", "a YUV4MPEG2 video or raw gray frames"));
        }
        let is_video = start == MAGIC.as_bytes();
        let whole: Stream = Box::new(Cursor::new(start).chain(stream));
        if is_video {
            return Ok(Self(Source::Y4m(Y4mReader::new(whole, path)?)));
        }
        let size = raw_size.ok_or_else(|| {
            let expected = "WIDTHxHEIGHT, because the stream does not start with YUV4MPEG2";
            Error::parameter("size of raw frames on standard input", "missing", expected)
        })?;
        Ok(Self(Source::Raw(RawReader::new(whole, path, size)?)))
    }

    /// The total number of frames, where it is known in advance: for image files.
    #[allow(clippy::len_without_is_empty, reason = "a source is never known to be empty")]
    pub fn len(&self) -> Option<u64> {
        match &self.0 {
            Source::Pictures { paths, .. } => Some(paths.len() as u64),
            Source::Y4m(_) | Source::Raw(_) => None,
        }
    }

    /// Frames read so far.
    pub fn frames_read(&self) -> u64 {
        match &self.0 {
            Source::Pictures { next, .. } => *next as u64,
            Source::Y4m(video) => video.frames_read(),
            Source::Raw(video) => video.frames_read(),
        }
    }

    /// The frame rate as a fraction, frames per seconds, where the source states it.
    pub fn rate(&self) -> Option<(u32, u32)> {
        match &self.0 {
            Source::Y4m(video) => video.rate(),
            Source::Pictures { .. } | Source::Raw(_) => None,
        }
    }

    /// The time from the first frame to the last one read, where the source states a rate.
    pub fn time_s(&self) -> Option<f64> {
        match &self.0 {
            Source::Y4m(video) => video.time_s(),
            Source::Pictures { .. } | Source::Raw(_) => None,
        }
    }

    /// The file of the last frame read, for image files.
    pub fn path(&self) -> Option<&Path> {
        match &self.0 {
            Source::Pictures { paths, next, .. } => paths.get(next.checked_sub(1)?).map(PathBuf::as_path),
            Source::Y4m(_) | Source::Raw(_) => None,
        }
    }

    /// Reads the next frame into `image`, whose memory is reused where possible. Returns false after the last one.
    ///
    /// # Errors
    /// The errors of [`picture::read`], [`Y4mReader::next_frame`] or [`RawReader::next_frame`];
    /// [`Error::SizeMismatch`] naming the image that does not have the size of the first one.
    pub fn next_frame(&mut self, image: &mut Image) -> Result<bool> {
        match &mut self.0 {
            Source::Y4m(video) => video.next_frame(image),
            Source::Raw(video) => video.next_frame(image),
            Source::Pictures { paths, next, size } => {
                let Some(path) = paths.get(*next) else { return Ok(false) };
                let read = picture::read(path)?;
                let expected = *size.get_or_insert(read.size);
                if read.size != expected {
                    let what = path.display().to_string();
                    return Err(Error::SizeMismatch { what, found: read.size, expected });
                }
                *image = read;
                *next += 1;
                Ok(true)
            }
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::frame::PixelFormat;
    use crate::io::picture::write_png;

    fn stream(bytes: &'static [u8], size: Option<Size>) -> Result<Frames> {
        Frames::from_stream(Box::new(bytes), "standard input", size)
    }

    fn gray(width: u32, value: u8) -> Image {
        Image { size: Size::new(width, 1), format: PixelFormat::Gray8, data: vec![value; width as usize] }
    }

    #[test]
    fn a_stream_tells_what_it_is() {
        let mut video = stream(b"YUV4MPEG2 W2 H1 F10:1 Cmono\nFRAME\nabFRAME\ncd", None).unwrap();
        let mut image = Image::default();
        assert!(video.next_frame(&mut image).unwrap() && video.next_frame(&mut image).unwrap());
        assert_eq!((&image.data[..], video.time_s(), video.len()), (&b"cd"[..], Some(0.1), None));
        assert!(!video.next_frame(&mut image).unwrap());

        let mut raw = stream(b"abcd", Some(Size::new(2, 2))).unwrap();
        assert!(raw.next_frame(&mut image).unwrap());
        assert_eq!((&image.data[..], raw.time_s()), (&b"abcd"[..], None));
    }

    #[test]
    fn a_stream_without_meaning_is_refused() {
        let text = stream(b"abcd", None).err().unwrap().to_string();
        assert!(text.starts_with("size of raw frames on standard input is missing"), "{text}");
        let text = stream(b"", Some(Size::new(2, 2))).err().unwrap().to_string();
        assert!(text.starts_with("standard input: stream is empty"), "{text}");
    }

    #[test]
    fn pictures_come_in_order_and_of_one_size() {
        let folder = tempfile::tempdir().unwrap();
        let name = |n: &str| folder.path().join(n).to_str().unwrap().to_owned();
        for (file, image) in [("f1.png", gray(2, 1)), ("f2.png", gray(2, 2)), ("x.png", gray(3, 3))] {
            write_png(name(file), &image).unwrap();
        }
        let mut frames = Frames::open(&[name("f%d.png"), name("f1.png"), name("x.png")], None).unwrap();
        assert_eq!((frames.len(), frames.path()), (Some(4), None));
        let mut image = Image::default();
        for value in [1, 2, 1] {
            assert!(frames.next_frame(&mut image).unwrap());
            assert_eq!(image, gray(2, value));
        }
        assert!(frames.path().unwrap().ends_with("f1.png"));
        let text = frames.next_frame(&mut image).unwrap_err().to_string();
        assert!(text.ends_with("x.png is 3×1, expected 2×1"), "{text}");
    }

    #[test]
    fn a_video_stands_alone() {
        for arguments in [vec!["-", "a.png"], vec!["a.png", "b.Y4M"], vec![]] {
            let arguments: Vec<String> = arguments.into_iter().map(str::to_owned).collect();
            assert!(matches!(Frames::open(&arguments, None), Err(Error::Parameter { .. })));
        }
        let text = Frames::open(&["no-such.y4m".to_owned()], None).err().unwrap().to_string();
        assert!(text.starts_with("no-such.y4m: "), "{text}");
    }
}
