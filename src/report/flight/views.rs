//! The views of a frame, for a video and for a page's player.

use glam::{DMat3, DVec3};

use super::danger;
use super::map::Map;
use crate::camera::{Camera, FRD_FROM_CAMERA, Pose, world_from_body};
use crate::error::Result;
use crate::frame::{Image, PixelFormat, Size};
use crate::report::canvas::Canvas;
use crate::report::colours::{ARC, DIM};
#[cfg(feature = "io")]
use crate::report::overlay::Layers;
use crate::report::overlay::Overlay;
use crate::report::rectified::Rectified;
use crate::sim::flight::{Flight, FlightFrame, Record};
use crate::sim::{RayTable, World, reference_render};

/// Half the width of the ribbon along the chosen arc, and its depth below the vehicle, metres.
const RIBBON_M: f64 = 0.6;
const BELOW_M: f64 = 1.0;

/// Draws the camera's image, the map of danger and the map of the surroundings.
#[derive(Debug)]
pub(super) struct Views {
    ideal: Camera,
    overlay: Overlay,
    rectified: Rectified,
    scenery: Scenery,
    /// The gray image in the ideal camera's size, used if there is no cue.
    plain: Image,
    map: Map,
}

/// The camera's view.
#[derive(Debug)]
struct Scenery {
    world: World,
    rays: Option<RayTable>,
}

impl Views {
    /// The views of a flight that has not begun.
    pub(super) fn new(flight: &Flight) -> Result<Self> {
        let (raw, ideal) = (&flight.config().camera, *flight.ideal());
        Ok(Self {
            overlay: Overlay::new(raw, &ideal)?,
            rectified: Rectified::new(raw, &ideal),
            scenery: Scenery { world: flight.course().world.clone(), rays: None },
            plain: blank(ideal.size),
            map: Map::new(flight.course()),
            ideal,
        })
    }

    /// Width and height of the camera's image.
    pub(super) fn picture_size(&self) -> Size {
        self.ideal.size
    }

    /// The camera's image with the pipeline's results.
    pub(super) fn picture(&mut self, seen: &FlightFrame<'_>) -> Result<&Image> {
        match (seen.image, seen.cue) {
            (Some(image), Some(cue)) => self.overlay.draw(&image.frame()?, cue),
            _ => self.plain(seen),
        }
    }

    /// The camera's image with some layers only.
    #[cfg(feature = "io")]
    pub(super) fn layers(&mut self, seen: &FlightFrame<'_>, layers: Layers) -> Result<&Image> {
        match (seen.image, seen.cue) {
            (Some(image), Some(cue)) => self.overlay.draw_layers(&image.frame()?, cue, layers),
            _ => self.plain(seen),
        }
    }

    /// The camera's image without an overlay, used if there is no cue.
    fn plain(&mut self, seen: &FlightFrame<'_>) -> Result<&Image> {
        match seen.image {
            Some(image) => self.rectified.draw(&image.frame()?, &mut self.plain)?,
            None => self.scenery.draw(&self.ideal, seen.record, &mut self.plain)?,
        }
        Ok(&self.plain)
    }

    /// Draws the horizon, and the chosen arc as a ribbon below the vehicle, over an image enlarged by `scale`.
    pub(super) fn attitude(&self, canvas: &mut Canvas<'_>, scale: f64, seen: &FlightFrame<'_>) {
        let scaled = |ends: [[f64; 2]; 2]| ends.map(|place| place.map(|c| scale * c));
        if let Some(ends) = self.horizon(seen.record) {
            canvas.stroke(&scaled(ends), 1.0, DIM);
        }
        let mut before: Option<[[f64; 2]; 2]> = None;
        for sides in self.ribbon(seen).into_iter().map(scaled) {
            let [left, right] = sides;
            if let Some([left_before, right_before]) = before {
                canvas.polygon(&[left_before, left, right, right_before], ARC, 0.35);
            }
            canvas.stroke(&[left, right], 1.5, ARC);
            before = Some(sides);
        }
    }

    /// Both ends of the horizon, in pixels from the image's corner; `None` if it is not in view.
    pub(super) fn horizon(&self, record: &Record) -> Option<[[f64; 2]; 2]> {
        let yaw_rad = record.roll_pitch_yaw_rad[2];
        let [left, right] = [-20, 20].map(|i| {
            let (sin, cos) = (yaw_rad + 0.05 * f64::from(i)).sin_cos();
            self.place(record, DVec3::new(cos, sin, 0.0))
        });
        Some([left?, right?])
    }

    /// Both sides of the visible part of the chosen arc, from near to far, in pixels from the image's corner.
    pub(super) fn ribbon(&self, seen: &FlightFrame<'_>) -> Vec<[[f64; 2]; 2]> {
        let Some(arc) = seen.steering.arc() else { return Vec::new() };
        let sides = |ends: &[DVec3]| {
            let aside = RIBBON_M * (ends[1] - ends[0]).cross(DVec3::NEG_Z).normalize_or_zero();
            let [left, right] =
                [-aside, aside].map(|aside| self.place(seen.record, ends[1] + aside + BELOW_M * DVec3::Z));
            Some([left?, right?])
        };
        arc.path_ned_m.windows(2).filter_map(sides).collect()
    }

    /// The image position of a point relative to the vehicle (north, east, down), in pixels from the image's corner.
    fn place(&self, record: &Record, off_ned: DVec3) -> Option<[f64; 2]> {
        let place = self.ideal.project(world_from_camera(record).transpose() * off_ned)?;
        Some(place.map(|c| c + 0.5))
    }

    /// Draws the map of danger.
    pub(super) fn danger(&self, canvas: &mut Canvas<'_>, seen: &FlightFrame<'_>) {
        danger::draw(canvas, seen);
    }

    /// Draws the map, with the path through the frames whose map has been drawn.
    pub(super) fn map(&mut self, canvas: &mut Canvas<'_>, seen: &FlightFrame<'_>) {
        self.map.draw(canvas, seen);
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

/// A black image.
pub(super) fn blank(size: Size) -> Image {
    Image { size, format: PixelFormat::Rgb8, data: vec![0; 3 * size.pixels()] }
}
