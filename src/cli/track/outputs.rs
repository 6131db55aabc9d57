//! The CSV of the tracks, and the overlay as a video or as images.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::cli::place::{Allowed, Folder, Place};
use crate::cli::{input, paths};
use crate::error::{Error, Result};
use crate::frame::{Frame, PixelFormat, Size};
use crate::io::{Y4mWriter, picture, write_atomic};
use crate::report::TrackOverlay;
use crate::tracking::Track;

/// Frames over which the overlay draws a track's path.
const PATH: usize = 20;

/// The destinations of the results, checked before the computation starts.
pub(super) struct Places {
    csv: Option<Place>,
    overlay: Option<Place>,
}

/// The writers of the results.
pub(super) struct Writers<'c, 'o> {
    csv: Option<(&'c mut dyn Write, PathBuf)>,
    overlay: Option<(TrackOverlay, Pictures<'o>)>,
}

/// Where overlays go.
enum Pictures<'a> {
    Video(Y4mWriter<&'a mut dyn Write>),
    Folder(&'a Place),
}

impl Places {
    /// Checks the arguments, of which `inputs` are those that are read, and creates nothing.
    pub(super) fn new<'a>(
        output: Option<&Path>,
        overlay: Option<&Path>,
        json: bool,
        inputs: impl IntoIterator<Item = &'a Path>,
    ) -> Result<Self> {
        let csv = output.map(|path| Allowed::file_or_stdout(&["csv"]).place("-o", path)).transpose()?;
        let pictures = Allowed { files: &["y4m"], folder: Folder::Any("png"), stdout: false };
        let overlay = overlay.map(|path| pictures.place("--overlay", path)).transpose()?;
        let places = Self { csv, overlay };
        if json && places.writes_to_stdout() {
            return Err(Error::parameter("--json", "given", "none where results go to standard output"));
        }
        paths::check(&[("-o", places.csv.as_ref()), ("--overlay", places.overlay.as_ref())], inputs)?;
        Ok(places)
    }

    pub(super) fn writes_to_stdout(&self) -> bool {
        matches!(self.csv, Some(Place::Stdout))
    }

    /// Calls `content` with the writers. Files appear only once they are complete; so does a new folder, unless it holds
    /// something.
    pub(super) fn with_writers(
        &self,
        size: Size,
        rate: (u32, u32),
        content: impl FnOnce(&mut Writers<'_, '_>) -> Result<()>,
    ) -> Result<()> {
        let csv = |overlay: Option<(TrackOverlay, Pictures<'_>)>| match &self.csv {
            None => finish(&mut Writers { csv: None, overlay }, content),
            Some(Place::File(path)) => write_atomic(path, |out| {
                finish(&mut Writers { csv: Some((out, path.clone())), overlay }, content)
            }),
            Some(_) => {
                let mut out = BufWriter::new(io::stdout().lock());
                let name = PathBuf::from("standard output");
                finish(&mut Writers { csv: Some((&mut out, name)), overlay }, content)
            }
        };
        let new = || TrackOverlay::new(PATH);
        match &self.overlay {
            None => csv(None),
            Some(Place::File(path)) => write_atomic(path, |out| {
                let video = Y4mWriter::new(out, path, size, PixelFormat::Rgb8, rate)?;
                csv(Some((new(), Pictures::Video(video))))
            }),
            Some(place @ Place::Folder(folder, _)) => {
                input::within(folder, || csv(Some((new(), Pictures::Folder(place)))))
            }
            Some(Place::Stdout) => unreachable!("it was refused"),
        }
    }
}

fn finish(
    writers: &mut Writers<'_, '_>,
    content: impl FnOnce(&mut Writers<'_, '_>) -> Result<()>,
) -> Result<()> {
    if let Some((out, path)) = &mut writers.csv {
        passed(writeln!(out, "frame,track,x,y,status,fb_error_px,error"), path)?;
    }
    content(writers)?;
    if let Some((out, path)) = &mut writers.csv {
        passed(out.flush(), path)?;
    }
    Ok(())
}

/// Whether writing worked. A reader that closes the pipe early, such as `head`, has seen enough.
fn passed(written: io::Result<()>, path: &Path) -> Result<bool> {
    match written {
        Ok(()) => Ok(true),
        Err(source) if source.kind() == io::ErrorKind::BrokenPipe => Ok(false),
        Err(source) => Err(Error::io(path, source)),
    }
}

impl Writers<'_, '_> {
    /// Writes the tracks of a frame. Returns false if nobody reads them any more.
    pub(super) fn write(&mut self, number: u64, frame: &Frame<'_>, tracks: &[Track]) -> Result<bool> {
        if let Some((out, path)) = &mut self.csv {
            let mut lines = String::new();
            for Track { id, x, y, status, forward_backward_px, error, .. } in tracks {
                let back = forward_backward_px.map(|error| error.to_string()).unwrap_or_default();
                lines.push_str(&format!("{number},{id},{x},{y},{},{back},{error}\n", status.name()));
            }
            if !passed(out.write_all(lines.as_bytes()).and_then(|()| out.flush()), path)? {
                return Ok(false);
            }
        }
        if let Some((overlay, pictures)) = &mut self.overlay {
            let image = overlay.draw(frame, tracks);
            match pictures {
                Pictures::Video(video) => video.write_frame(&image.frame()?)?,
                Pictures::Folder(place) => place.write(number, &picture::encode_png(&image)?)?,
            }
        }
        Ok(true)
    }
}
