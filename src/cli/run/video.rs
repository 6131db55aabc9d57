//! The overlay as a video.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use super::horizon::Horizon;
use crate::camera::Camera;
use crate::cli::paths;
use crate::cli::place::{Allowed, Place};
use crate::error::{Error, Result};
use crate::frame::PixelFormat;
use crate::io::{Y4mWriter, write_atomic};
use crate::live::TimedFrame;
use crate::pipeline::Cue;
use crate::report::Overlay;

/// The destination of the video, checked before the computation starts. `inputs` are the files that are read.
pub(super) fn target<'a>(
    path: &Path,
    lines: bool,
    inputs: impl IntoIterator<Item = &'a Path>,
) -> Result<Place> {
    let place = Allowed::file_or_stdout(&["y4m"]).place("--overlay", path)?;
    if lines && place == Place::Stdout {
        return Err(Error::parameter("--overlay", "-", "--quiet with it, as lines go there too"));
    }
    paths::check(&[("--overlay", Some(&place))], inputs)?;
    Ok(place)
}

/// Calls `content` with a writer for the video. A file appears only once it is complete.
pub(super) fn write(place: &Place, content: impl FnOnce(&mut dyn Write) -> Result<()>) -> Result<()> {
    match place {
        Place::File(path) => write_atomic(path, content),
        Place::Stdout | Place::Folder(..) => content(&mut BufWriter::new(io::stdout().lock())),
    }
}

/// A video that is being written.
pub(super) struct Video<'a> {
    overlay: Overlay,
    horizon: Horizon,
    writer: Y4mWriter<&'a mut dyn Write>,
    failed: Option<Error>,
}

impl<'a> Video<'a> {
    pub(super) fn new(
        out: &'a mut dyn Write,
        place: &Place,
        [raw, ideal]: [&Camera; 2],
        rate: (u32, u32),
        horizon: Horizon,
    ) -> Result<Self> {
        let path = match place {
            Place::File(path) => path.clone(),
            Place::Stdout | Place::Folder(..) => PathBuf::from("standard output"),
        };
        let writer = Y4mWriter::new(out, path, ideal.size, PixelFormat::Rgb8, rate)?;
        Ok(Self { overlay: Overlay::new(raw, ideal)?, horizon, writer, failed: None })
    }

    /// Adds a frame. Returns false on failure, whose error [`Video::finish`] returns.
    pub(super) fn add(&mut self, taken: &TimedFrame, cue: &Cue<'_>) -> bool {
        let Self { overlay, horizon, writer, failed } = self;
        overlay.set_up(horizon.at(cue));
        let added =
            taken.image.frame().and_then(|frame| writer.write_frame(&overlay.draw(&frame, cue)?.frame()?));
        *failed = added.err();
        failed.is_none()
    }

    /// Completes the video.
    pub(super) fn finish(self) -> Result<()> {
        let end = match self.failed {
            Some(error) => Err(error),
            None => self.writer.finish().map(|_| ()),
        };
        match end {
            // A closed pipe means that the viewer has seen enough.
            Err(Error::Io { source, .. }) if source.kind() == io::ErrorKind::BrokenPipe => Ok(()),
            end => end,
        }
    }
}
