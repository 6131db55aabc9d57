//! Cues as an overlay on their frames.

use glam::DVec3;

use super::colour_wheel::colour_wheel;
use super::colours::TIMES;
use super::draw::line;
use super::font::text;
use super::rectified::{Rectified, pixels};
use crate::camera::Camera;
use crate::error::{Error, Result};
use crate::frame::{FlowField, Frame, Image, PixelFormat};
use crate::pipeline::Cue;
use crate::sphere::{Grid, Threat, bearing};

/// The displacement in full colour, relative to the image's width: constant, so that colours are comparable between
/// frames.
const FULL_COLOUR: f32 = 0.01;
/// The opacity of a filled sector.
const FILLED: f32 = 0.45;
/// The opacity of the fullest colour over the gray image.
const OPAQUE: f32 = 0.6;
const HEADING: [u8; 3] = [255; 3];
const HORIZON: [u8; 3] = [0, 220, 255];
const INVALID: [u8; 3] = [200, 0, 0];
/// The sector index of pixels in no sector.
const NO_SECTOR: u32 = u32::MAX;

/// Draws cues over the undistorted images, in which the flow is computed.
///
/// The image is gray. The overlay shows the flow as colours ([`colour_wheel`], from the previous frame to this one;
/// pixels without motion stay gray); an outline around each sector by its time to contact, red within 1 s, orange
/// within 2 s, yellow within 4 s, green within 8 s; a box around the threat, with its time; the direction of motion
/// as a cross; the horizon, if it is known ([`Overlay::set_up`]); the frame's time at the lower left. An image whose
/// cue is invalid has a red border, and nothing else is drawn.
#[derive(Debug)]
pub struct Overlay {
    ideal: Camera,
    picture: Rectified,
    sectors: Sectors,
    up_camera: Option<DVec3>,
    image: Image,
}

/// The layers over an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(
    not(all(feature = "io", feature = "sim")),
    allow(dead_code, reason = "pages of flights show them alone")
)]
pub(super) enum Layers {
    /// Everything, each sector as a frame.
    All,
    /// The flow.
    Flow,
    /// The sectors, filled, the threat and the direction of motion.
    Sectors,
}

/// The sector of each pixel.
#[derive(Debug, Default)]
struct Sectors {
    grid: Option<Grid>,
    of_pixel: Vec<u32>,
}

impl Overlay {
    /// An overlay for frames of the camera `raw` whose flow is computed in images of the camera `ideal`.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a camera that is out of range.
    pub fn new(raw: &Camera, ideal: &Camera) -> Result<Self> {
        raw.validate()?;
        ideal.validate()?;
        let data = vec![0; 3 * ideal.size.pixels()];
        let image = Image { size: ideal.size, format: PixelFormat::Rgb8, data };
        let picture = Rectified::new(raw, ideal);
        Ok(Self { ideal: *ideal, picture, sectors: Sectors::default(), up_camera: None, image })
    }

    /// Sets the up direction in the camera's frame, of any length, from the next drawn frame on; `None` if it is
    /// unknown, and then no horizon is drawn.
    pub fn set_up(&mut self, up_camera: Option<DVec3>) {
        self.up_camera = up_camera;
    }

    /// Draws the frame with its cue, as [`PixelFormat::Rgb8`] in the ideal camera's size. The flow is drawn if the
    /// cue contains it ([`Config::read_flow`](crate::Config::read_flow)).
    ///
    /// # Errors
    /// [`Error::SizeMismatch`] for a frame or a flow of another size.
    pub fn draw(&mut self, frame: &Frame<'_>, cue: &Cue<'_>) -> Result<&Image> {
        self.draw_layers(frame, cue, Layers::All)?;
        let (bottom, scale) = (f64::from(self.ideal.size.height), self.scale());
        text(&mut self.image, [0.0, bottom], &format!("{:.2}s", cue.time_s), [255; 3], scale);
        Ok(&self.image)
    }

    /// Draws without the frame's time, and only the given layers.
    pub(super) fn draw_layers(&mut self, frame: &Frame<'_>, cue: &Cue<'_>, layers: Layers) -> Result<&Image> {
        self.picture.draw(frame, &mut self.image)?;
        let scale = self.scale();
        if cue.invalid.is_some() {
            self.border(2 * scale);
            return Ok(&self.image);
        }
        if let Some(flow) = cue.flow.filter(|_| layers != Layers::Sectors) {
            self.flow(flow)?;
        }
        match layers {
            Layers::All => self.outline(cue),
            Layers::Sectors => self.fill(cue),
            Layers::Flow => return Ok(&self.image),
        }
        if let Some(up) = self.up_camera {
            self.horizon(up);
        }
        if let Some(threat) = &cue.threat {
            self.threat(threat, &cue.sectors.grid, scale);
        }
        if cue.heading.is_known() {
            self.cross(cue.heading.direction, 5.0 * scale as f64);
        }
        Ok(&self.image)
    }

    /// The width of a font's dot and of lines, pixels.
    fn scale(&self) -> usize {
        (self.ideal.size.width as usize / 200).max(1)
    }

    fn flow(&mut self, flow: &FlowField) -> Result<()> {
        if flow.size != self.ideal.size {
            let what = "flow field".to_owned();
            return Err(Error::SizeMismatch { what, found: flow.size, expected: self.ideal.size });
        }
        let scale = (FULL_COLOUR * self.ideal.size.width as f32).max(1.0);
        // The cue's flow points back to the previous frame.
        let forward =
            FlowField { size: flow.size, data: flow.data.iter().map(|uv| uv.map(|c| -c)).collect() };
        let (colours, _) = colour_wheel(&forward, Some(scale))?;
        let colours = colours.data.as_chunks::<3>().0;
        let pixels = self.image.data.as_chunks_mut::<3>().0.iter_mut();
        for ((pixel, colour), uv) in pixels.zip(colours).zip(&flow.data) {
            if FlowField::is_known(*uv) {
                blend(pixel, *colour, OPAQUE * (uv[0].hypot(uv[1]) / scale).min(1.0));
            }
        }
        Ok(())
    }

    /// The colour of each sector's time to contact; `None` without a contact soon.
    fn colours(&mut self, cue: &Cue<'_>) -> Vec<Option<[u8; 3]>> {
        let grid = &cue.sectors.grid;
        if self.sectors.grid != Some(*grid) {
            self.sectors = Sectors { grid: Some(*grid), of_pixel: sector_of_pixels(&self.ideal, grid) };
        }
        let colour = |sector| {
            let time = cue.sectors.time_to_contact_s(sector)[1].unwrap_or(f64::INFINITY);
            TIMES.iter().find(|(limit, _)| time < *limit).map(|(_, colour)| *colour)
        };
        cue.sectors.sectors.iter().map(colour).collect()
    }

    /// Fills each sector that has a contact soon with the colour of its time.
    fn fill(&mut self, cue: &Cue<'_>) {
        let colours = self.colours(cue);
        let pixels = self.image.data.as_chunks_mut::<3>().0.iter_mut();
        for (pixel, sector) in pixels.zip(&self.sectors.of_pixel) {
            if let Some(Some(colour)) = colours.get(*sector as usize) {
                blend(pixel, *colour, FILLED);
            }
        }
    }

    /// Outlines each sector, one pixel wide, in the colour of its time.
    fn outline(&mut self, cue: &Cue<'_>) {
        let colours = self.colours(cue);
        let (width, of) = (self.ideal.size.width as usize, &self.sectors.of_pixel);
        for (i, pixel) in self.image.data.as_chunks_mut::<3>().0.iter_mut().enumerate() {
            let Some(colour) = colours.get(of[i] as usize) else { continue };
            let share = if colour.is_some() { 0.9 } else { 0.25 };
            let x = i % width;
            let beside = [
                (x > 0).then(|| i - 1),
                (x + 1 < width).then_some(i + 1),
                i.checked_sub(width),
                (i + width < of.len()).then_some(i + width),
            ];
            if beside.into_iter().any(|at| at.is_none_or(|at| of[at] != of[i])) {
                blend(pixel, colour.unwrap_or([0; 3]), share);
            }
        }
    }

    /// Draws a box of about the threat's size, with its time above it.
    fn threat(&mut self, threat: &Threat, grid: &Grid, scale: usize) {
        let colour = if threat.alarm { TIMES[0].1 } else { TIMES[1].1 };
        let half = grid.pitch_rad().map(|pitch| 0.5 * pitch * (threat.sectors as f64).sqrt());
        let corner = |right: f64, up: f64| {
            let angles = [threat.azimuth_rad + right * half[0], threat.elevation_rad + up * half[1]];
            self.ideal.project(bearing(angles))
        };
        let corners = [corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)];
        let [Some(a), Some(b), Some(c), Some(d)] = corners else { return };
        for [from, to] in [[a, b], [b, c], [c, d], [d, a]] {
            for shift in 0..=scale {
                let moved = |place: [f64; 2]| place.map(|c| c + shift as f64);
                line(&mut self.image, moved(from), moved(to), colour);
            }
        }
        let above = [a[0], a[1] - 9.0 * scale as f64];
        text(&mut self.image, above, &format!("{:.1}s", threat.time_s), colour, scale);
    }

    /// Draws the horizon: the points (x, y, 1) perpendicular to the up direction.
    fn horizon(&mut self, up: DVec3) {
        let Camera { size, f_u, f_v, u_0, v_0, .. } = self.ideal;
        let (a, b) = (up.x / f_u, up.y / f_v);
        let c = up.z - a * u_0 - b * v_0;
        let last = [size.width, size.height].map(|side| f64::from(side - 1));
        // a u + b v + c = 0, from one side of the image to the other.
        let steep = a.abs() > b.abs();
        let ends = match steep {
            true => [0.0, last[1]].map(|v| [-(b * v + c) / a, v]),
            false => [0.0, last[0]].map(|u| [u, -(a * u + c) / b]),
        };
        // Looking straight up or down there is none.
        if ends.as_flattened().iter().all(|end| end.is_finite()) {
            for shift in [0.0, 1.0] {
                let moved = ends.map(|[u, v]| if steep { [u + shift, v] } else { [u, v + shift] });
                line(&mut self.image, moved[0], moved[1], HORIZON);
            }
        }
    }

    fn cross(&mut self, direction: DVec3, arm: f64) {
        let Some([u, v]) = self.ideal.project(direction) else { return };
        for shift in [0.0, 1.0] {
            line(&mut self.image, [u - arm, v + shift], [u + arm, v + shift], HEADING);
            line(&mut self.image, [u + shift, v - arm], [u + shift, v + arm], HEADING);
        }
    }

    fn border(&mut self, thick: usize) {
        let (width, height) = (self.ideal.size.width as usize, self.ideal.size.height as usize);
        for (i, pixel) in self.image.data.as_chunks_mut::<3>().0.iter_mut().enumerate() {
            let (x, y) = (i % width, i / width);
            if x.min(width - 1 - x).min(y).min(height - 1 - y) < thick {
                *pixel = INVALID;
            }
        }
    }
}

fn sector_of_pixels(ideal: &Camera, grid: &Grid) -> Vec<u32> {
    let sector = |pixel| {
        let [column, row] = grid.sector(ideal.ray(pixel)?)?;
        Some((row * grid.columns + column) as u32)
    };
    pixels(ideal).map(|pixel| sector(pixel).unwrap_or(NO_SECTOR)).collect()
}

fn blend(pixel: &mut [u8; 3], colour: [u8; 3], share: f32) {
    for (below, above) in pixel.iter_mut().zip(colour) {
        *below = ((1.0 - share) * f32::from(*below) + share * f32::from(above)).round() as u8;
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
