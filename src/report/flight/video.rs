//! A flight as a video.

use super::views::{Views, blank};
use crate::error::Result;
use crate::frame::{Image, Size};
use crate::report::canvas::Canvas;
use crate::report::colours::{FRAME, TEXT, WRONG};
use crate::sim::flight::{Flight, FlightFrame, Record};
use crate::steer::Source;

/// The approximate width of the camera's image and of the map, pixels.
const PICTURE_PX: u32 = 640;
const MAP_PX: usize = 480;
/// Heights of the map of danger and of the lines of text, pixels.
const DANGER_PX: usize = 210;
const TEXT_PX: usize = 54;
/// The gap between the parts, pixels.
const GAP_PX: usize = 8;

/// Draws the frames of a flight for a video: the camera's image with the pipeline's results
/// ([`Overlay`](crate::report::Overlay)), the horizon and the chosen arc; the map of danger; a map of the surroundings;
/// and a few figures.
///
/// In both maps, red is a time to contact within 1 s, orange within 2 s, yellow within 4 s, green within 8 s. On the
/// map of the surroundings the goal's direction is up, solids are gray, and rings are the steering's obstacles.
///
/// If the sensor is not a camera, the image is rendered for display only.
#[derive(Debug)]
pub struct FlightVideo {
    views: Views,
    image: Image,
    /// The width of a camera pixel in the frame, pixels.
    scale: usize,
}

impl FlightVideo {
    /// A video of a flight that has not begun.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) for a camera whose video would be too large.
    pub fn new(flight: &Flight) -> Result<Self> {
        let views = Views::new(flight)?;
        let Size { width, height } = views.picture_size();
        let scale = ((PICTURE_PX + width / 2) / width).max(1) as usize;
        let [width, height] = [width, height].map(|side| side as usize * scale);
        let whole = [width + GAP_PX + MAP_PX, height + GAP_PX + DANGER_PX + TEXT_PX];
        let size = Size::new(whole[0] as u32, whole[1] as u32).validate()?;
        Ok(Self { views, image: blank(size), scale })
    }

    /// Width and height of the video's frames.
    pub fn size(&self) -> Size {
        self.image.size
    }

    /// Draws a frame as [`PixelFormat::Rgb8`](crate::frame::PixelFormat::Rgb8). The path on the map connects the frames
    /// drawn so far.
    ///
    /// # Errors
    /// [`Error::SizeMismatch`](crate::Error::SizeMismatch) for an image or a flow of another camera.
    pub fn draw(&mut self, seen: &FlightFrame<'_>) -> Result<&Image> {
        Canvas::new(&mut self.image, [0, 0], [usize::MAX; 2]).fill(FRAME);
        let Size { width, height } = self.views.picture_size();
        let [width, height] = [width, height].map(|side| side as usize * self.scale);
        enlarge(self.views.picture(seen)?, &mut self.image, self.scale);
        let mut canvas = Canvas::new(&mut self.image, [0, 0], [width, height]);
        self.views.attitude(&mut canvas, self.scale as f64, seen);
        let corner = [0, height + GAP_PX];
        self.views.danger(&mut Canvas::new(&mut self.image, corner, [width, DANGER_PX]), seen);
        let map = [MAP_PX, height + GAP_PX + DANGER_PX];
        self.views.map(&mut Canvas::new(&mut self.image, [width + GAP_PX, 0], map), seen);
        let mut text = Canvas::new(&mut self.image, [0, map[1]], [usize::MAX, TEXT_PX]);
        for (row, (line, colour)) in lines(seen.record).into_iter().enumerate() {
            text.text([10.0, 8.0 + 22.0 * row as f64], &line, colour, 3);
        }
        Ok(&self.image)
    }
}

/// Copies an image into the upper left corner of another one, each pixel as a square of `scale` pixels.
fn enlarge(from: &Image, to: &mut Image, scale: usize) {
    let (width, wide) = (from.size.width as usize, to.size.width as usize);
    let from = from.data.as_chunks::<3>().0;
    let to = to.data.as_chunks_mut::<3>().0;
    for (y, row) in to.chunks_exact_mut(wide).take(from.len() / width * scale).enumerate() {
        for (x, pixel) in row[..width * scale].iter_mut().enumerate() {
            *pixel = from[y / scale * width + x / scale];
        }
    }
}

/// The figures of a frame as lines of text.
fn lines(record: &Record) -> [(String, [u8; 3]); 2] {
    let seconds = |time_s: Option<f64>| time_s.map_or("-".to_owned(), |time_s| format!("{time_s:.1}"));
    let [roll_rad, ..] = record.roll_pitch_yaw_rad;
    let flown = format!(
        "{:6.2} s  bank {:+3.0}° of {:+3.0}°  {:4.1} m/s  altitude {:4.1} m  clear {:4.1} m",
        record.time_s,
        roll_rad.to_degrees(),
        record.acting.bank_rad.to_degrees(),
        record.airspeed_m_s,
        -record.position_ned_m.z,
        record.clearance_m,
    );
    let contact =
        format!("contact {:>4} s, true {:>4} s", seconds(record.contact_s), seconds(record.true_contact_s));
    let source = match record.source {
        Source::Cue => "by cue",
        Source::Held => "held",
        Source::Recovery => "recovery",
    };
    let told = match (&record.invalid, record.danger) {
        (Some(invalid), _) => (format!("{source}: {invalid}"), WRONG),
        (None, Some(danger)) => (format!("{contact}  {source}, danger {danger:.2}"), TEXT),
        (None, None) => (format!("{contact}  {source}"), TEXT),
    };
    [(flown, TEXT), told]
}
