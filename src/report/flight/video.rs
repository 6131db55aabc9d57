//! A flight frame by frame.

use super::views::{Views, blank};
use crate::error::Result;
use crate::frame::{Image, Size};
use crate::report::canvas::Canvas;
use crate::report::colours::{FRAME, TEXT, WRONG};
use crate::sim::flight::{Flight, FlightFrame, Record};
use crate::steer::Source;

/// About how wide the camera's picture is drawn, and the map beside it.
const PICTURE_PX: u32 = 640;
const MAP_PX: usize = 480;
/// Heights of the map of danger and of the lines of text.
const DANGER_PX: usize = 210;
const TEXT_PX: usize = 54;
/// Between the parts.
const GAP_PX: usize = 8;

/// Draws the frames of a flight for a video: what the camera sees with what the pipeline makes of it
/// ([`Overlay`](crate::report::Overlay)), the horizon and the arc that was chosen; the danger in the directions around; a map; a few figures.
///
/// In the map and in the picture of danger red is what is met within 1 s, orange within 2 s, yellow within 4 s, green within
/// 8 s. In the map the direction of the goal is up, solid things are gray, rings are what the steering takes for obstacles.
///
/// Where the sensor is no camera, the picture is what a camera would see, drawn for the eye alone.
#[derive(Debug)]
pub struct FlightVideo {
    views: Views,
    image: Image,
    /// How many pixels wide one of the camera's is drawn.
    scale: usize,
}

impl FlightVideo {
    /// For a flight from its beginning.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) for a camera so large that the video would be too large.
    pub fn new(flight: &Flight) -> Result<Self> {
        let views = Views::new(flight)?;
        let Size { width, height } = views.picture_size();
        let scale = ((PICTURE_PX + width / 2) / width).max(1) as usize;
        let [width, height] = [width, height].map(|side| side as usize * scale);
        let whole = [width + GAP_PX + MAP_PX, height + GAP_PX + DANGER_PX + TEXT_PX];
        let size = Size::new(whole[0] as u32, whole[1] as u32).validate()?;
        Ok(Self { views, image: blank(size), scale })
    }

    /// Width and height of the frames.
    pub fn size(&self) -> Size {
        self.image.size
    }

    /// A frame, as [`PixelFormat::Rgb8`](crate::frame::PixelFormat::Rgb8). The way on the map leads through the frames that
    /// have been drawn.
    ///
    /// # Errors
    /// [`Error::SizeMismatch`](crate::Error::SizeMismatch) for a picture or a flow of another camera.
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

/// Copies a picture into the upper left corner of another one, each of its pixels as a square.
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

/// The figures of a frame.
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
