//! A flight frame by frame.

use glam::{DMat3, DVec3};

use super::danger;
use super::map::Map;
use crate::camera::{Camera, FRD_FROM_CAMERA, Pose, world_from_body};
use crate::error::Result;
use crate::frame::{Image, PixelFormat, Size};
use crate::report::Overlay;
use crate::report::canvas::Canvas;
use crate::report::colours::{ARC, DIM, FRAME, TEXT, WRONG};
use crate::report::rectified::Rectified;
use crate::sim::flight::{Flight, FlightFrame, Record};
use crate::sim::{RayTable, World, reference_render};
use crate::steer::Source;

/// About how wide the camera's picture is drawn, and the map beside it.
const PICTURE_PX: u32 = 640;
const MAP_PX: usize = 480;
/// Heights of the map of danger and of the lines of text.
const DANGER_PX: usize = 210;
const TEXT_PX: usize = 54;
/// Between the parts.
const GAP_PX: usize = 8;
/// Half the width of the ribbon along the arc that was chosen, and how far below the vehicle it lies, metres.
const RIBBON_M: f64 = 0.6;
const BELOW_M: f64 = 1.0;

/// Draws the frames of a flight for a video: what the camera sees with what the pipeline makes of it
/// ([`Overlay`]), the horizon and the arc that was chosen; the danger in the directions around; a map; a few figures.
///
/// In the map and in the picture of danger red is what is met within 1 s, orange within 2 s, yellow within 4 s, green within
/// 8 s. In the map the direction of the goal is up, solid things are gray, rings are what the steering takes for obstacles.
///
/// Where the sensor is no camera, the picture is what a camera would see, drawn for the eye alone.
#[derive(Debug)]
pub struct FlightVideo {
    ideal: Camera,
    overlay: Overlay,
    rectified: Rectified,
    scenery: Scenery,
    /// The picture in the ideal camera's size, where there is no cue to draw over it.
    plain: Image,
    map: Map,
    image: Image,
    /// How many pixels wide one of the camera's is drawn.
    scale: usize,
}

/// What a camera would see.
#[derive(Debug)]
struct Scenery {
    world: World,
    rays: Option<RayTable>,
}

impl FlightVideo {
    /// For a flight from its beginning.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) for a camera so large that the video would be too large.
    pub fn new(flight: &Flight) -> Result<Self> {
        let (raw, ideal) = (&flight.config().camera, *flight.ideal());
        let scale = ((PICTURE_PX + ideal.size.width / 2) / ideal.size.width).max(1) as usize;
        let [width, height] = [ideal.size.width, ideal.size.height].map(|side| side as usize * scale);
        let whole = [width + GAP_PX + MAP_PX, height + GAP_PX + DANGER_PX + TEXT_PX];
        let size = Size::new(whole[0] as u32, whole[1] as u32).validate()?;
        let blank = |size: Size| Image { size, format: PixelFormat::Rgb8, data: vec![0; 3 * size.pixels()] };
        Ok(Self {
            overlay: Overlay::new(raw, &ideal)?,
            rectified: Rectified::new(raw, &ideal),
            scenery: Scenery { world: flight.course().world.clone(), rays: None },
            plain: blank(ideal.size),
            map: Map::new(flight.course()),
            image: blank(size),
            scale,
            ideal,
        })
    }

    /// Width and height of the frames.
    pub fn size(&self) -> Size {
        self.image.size
    }

    /// A frame, as [`PixelFormat::Rgb8`]. The way on the map leads through the frames that have been drawn.
    ///
    /// # Errors
    /// [`Error::SizeMismatch`](crate::Error::SizeMismatch) for a picture or a flow of another camera.
    pub fn draw(&mut self, seen: &FlightFrame<'_>) -> Result<&Image> {
        Canvas::new(&mut self.image, [0, 0], [usize::MAX; 2]).fill(FRAME);
        let [width, height] =
            [self.ideal.size.width, self.ideal.size.height].map(|s| s as usize * self.scale);
        let picture = match (seen.image, seen.cue) {
            (Some(image), Some(cue)) => self.overlay.draw(&image.frame()?, cue)?,
            (Some(image), None) => {
                self.rectified.draw(&image.frame()?, &mut self.plain)?;
                &self.plain
            }
            (None, _) => {
                self.scenery.draw(&self.ideal, seen.record, &mut self.plain)?;
                &self.plain
            }
        };
        enlarge(picture, &mut self.image, self.scale);
        let mut canvas = Canvas::new(&mut self.image, [0, 0], [width, height]);
        attitude(&mut canvas, &self.ideal, self.scale as f64, seen);
        let corner = [0, height + GAP_PX];
        danger::draw(&mut Canvas::new(&mut self.image, corner, [width, DANGER_PX]), seen);
        let map = [MAP_PX, height + GAP_PX + DANGER_PX];
        self.map.draw(&mut Canvas::new(&mut self.image, [width + GAP_PX, 0], map), seen);
        let mut text = Canvas::new(&mut self.image, [0, map[1]], [usize::MAX, TEXT_PX]);
        for (row, (line, colour)) in lines(seen.record).into_iter().enumerate() {
            text.text([10.0, 8.0 + 22.0 * row as f64], &line, colour, 3);
        }
        Ok(&self.image)
    }
}

impl Scenery {
    fn draw(&mut self, ideal: &Camera, record: &Record, image: &mut Image) -> Result<()> {
        let rays = match &mut self.rays {
            Some(rays) => rays,
            none => none.insert(RayTable::new(ideal)?),
        };
        let pose =
            Pose { position_world: record.position_ned_m, world_from_camera: world_from_camera(record) };
        let gray = reference_render(&self.world, rays, &pose).image;
        for (pixel, gray) in image.data.as_chunks_mut::<3>().0.iter_mut().zip(gray.data) {
            *pixel = [gray; 3];
        }
        Ok(())
    }
}

fn world_from_camera(record: &Record) -> DMat3 {
    let [roll, pitch, yaw] = record.roll_pitch_yaw_rad;
    world_from_body(roll, pitch, yaw) * FRD_FROM_CAMERA
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

/// The horizon, and the arc that was chosen as a ribbon below the vehicle.
fn attitude(canvas: &mut Canvas<'_>, ideal: &Camera, scale: f64, seen: &FlightFrame<'_>) {
    let camera_from_world = world_from_camera(seen.record).transpose();
    let place = |off_ned: DVec3| {
        let place = ideal.project(camera_from_world * off_ned)?;
        Some(place.map(|c| scale * (c + 0.5)))
    };
    let yaw_rad = seen.record.roll_pitch_yaw_rad[2];
    let horizon = [-20, 20].map(|i| {
        let (sin, cos) = (yaw_rad + 0.05 * f64::from(i)).sin_cos();
        place(DVec3::new(cos, sin, 0.0))
    });
    if let [Some(left), Some(right)] = horizon {
        canvas.stroke(&[left, right], 1.0, DIM);
    }
    let Some(arc) = seen.steering.arc() else { return };
    let mut before: Option<[[f64; 2]; 2]> = None;
    for ends in arc.path_ned_m.windows(2) {
        let aside = RIBBON_M * (ends[1] - ends[0]).cross(DVec3::NEG_Z).normalize_or_zero();
        let sides = [-aside, aside].map(|aside| place(ends[1] + aside + BELOW_M * DVec3::Z));
        if let [Some(left), Some(right)] = sides {
            if let Some([left_before, right_before]) = before {
                canvas.polygon(&[left_before, left, right, right_before], ARC, 0.35);
            }
            canvas.stroke(&[left, right], 1.5, ARC);
            before = Some([left, right]);
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
