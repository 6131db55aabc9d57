//! A flight frame by frame, as pictures for a page.

use super::views::{Views, blank};
use crate::error::{Error, Result};
use crate::frame::{Image, Size, picture};
use crate::report::canvas::Canvas;
use crate::sim::flight::{Flight, Record, Seen};

/// Size of the picture of the danger in the directions around, and of the map.
pub(super) const DANGER: Size = Size::new(480, 156);
pub(super) const MAP: Size = Size::new(390, 640);
/// Quality of the camera's pictures: enough to see the texture and the sectors' frames.
const QUALITY: u8 = 72;

/// Pictures of a flight's frames: what the camera sees with what the pipeline makes of it, the danger in the directions
/// around, and a map with the way flown and the arc that was chosen.
///
/// As [`FlightVideo`](super::FlightVideo), but compressed, and with its parts by themselves, so that a page can lay them out.
/// A frame takes some 30 kB.
#[derive(Debug)]
pub struct FlightFilm {
    views: Views,
    every: u64,
    camera: Image,
    danger: Image,
    map: Image,
    stills: Vec<Still>,
}

/// A frame that was drawn.
#[derive(Debug)]
pub(super) struct Still {
    pub(super) record: Record,
    /// JPEG.
    pub(super) camera: Vec<u8>,
    /// PNG.
    pub(super) danger: Vec<u8>,
    /// PNG.
    pub(super) map: Vec<u8>,
}

impl FlightFilm {
    /// For a flight from its beginning, of which each frame whose number `every` divides is drawn.
    ///
    /// # Errors
    /// [`Error::Parameter`] for 0.
    pub fn new(flight: &Flight, every: u64) -> Result<Self> {
        if every == 0 {
            return Err(Error::parameter("every", every, "1 or above"));
        }
        let views = Views::new(flight)?;
        let camera = blank(views.picture_size());
        Ok(Self { views, every, camera, danger: blank(DANGER), map: blank(MAP), stills: Vec::new() })
    }

    /// Draws a frame, if it is one of those that are drawn.
    ///
    /// # Errors
    /// [`Error::SizeMismatch`] for a picture or a flow of another camera.
    pub fn add(&mut self, seen: &Seen<'_>) -> Result<()> {
        if !seen.record.frame.is_multiple_of(self.every) {
            return Ok(());
        }
        let Self { views, camera, danger, map, .. } = self;
        camera.data.copy_from_slice(&views.picture(seen)?.data);
        views.attitude(&mut all(camera), 1.0, seen);
        views.danger(&mut all(danger), seen);
        views.map(&mut all(map), seen);
        self.stills.push(Still {
            record: seen.record.clone(),
            camera: picture::encode_jpeg(camera, QUALITY)?,
            danger: picture::encode_png(danger)?,
            map: picture::encode_png(map)?,
        });
        Ok(())
    }

    /// Width and height of the camera's pictures.
    pub(super) fn camera_size(&self) -> Size {
        self.camera.size
    }

    /// The frames that were drawn.
    pub(super) fn stills(&self) -> &[Still] {
        &self.stills
    }

    /// From one of them to the next, in frames of the flight.
    pub(super) fn every(&self) -> u64 {
        self.every
    }
}

fn all(image: &mut Image) -> Canvas<'_> {
    Canvas::new(image, [0, 0], [usize::MAX; 2])
}
