//! A flight's video, written during the flight.

use std::io::Write;
use std::path::Path;

use crate::error::Result;
use crate::frame::PixelFormat;
use crate::io::Y4mWriter;
use crate::report::flight::FlightVideo;
use crate::sim::flight::FlightFrame;

/// Every third frame is drawn: all frames would take three times the space and the time.
const EVERY: u64 = 3;
/// The video's frame rate as a fraction, Hz.
const RATE: (u32, u32) = (10, 1);

/// A video being written.
pub(super) struct Video<'a> {
    drawing: FlightVideo,
    writer: Y4mWriter<&'a mut dyn Write>,
}

impl<'a> Video<'a> {
    /// Starts a video. `path` is the name in error messages.
    pub(super) fn new(drawing: FlightVideo, out: &'a mut dyn Write, path: &Path) -> Result<Self> {
        let writer = Y4mWriter::new(out, path, drawing.size(), PixelFormat::Rgb8, RATE)?;
        Ok(Self { drawing, writer })
    }

    pub(super) fn add(&mut self, seen: &FlightFrame<'_>) -> Result<()> {
        if seen.record.frame.is_multiple_of(EVERY) {
            self.writer.write_frame(&self.drawing.draw(seen)?.frame()?)?;
        }
        Ok(())
    }

    pub(super) fn finish(self) -> Result<()> {
        self.writer.finish().map(|_| ())
    }
}
