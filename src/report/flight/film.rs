//! A flight as a film, for a page that plays it.

use glam::DVec2;

use super::map::Ground;
use super::views::Views;
use crate::error::{Error, Result};
use crate::frame::Size;
use crate::io::picture;
use crate::report::colours::TIMES;
use crate::report::overlay::Layers;
use crate::sim::flight::{Flight, FlightFrame, Record};

/// JPEG quality of the camera's images.
const QUALITY: u8 = 62;

/// The film of a flight for a page: per frame the camera's image with the flow, the same with the sectors, and the data
/// from which the page draws the chosen arc and a map.
///
/// It shows the same as [`FlightVideo`](super::FlightVideo), but compressed and in parts that the page lays out. A
/// frame takes some 30 kB.
#[derive(Debug)]
pub struct FlightFilm {
    views: Views,
    pub(super) ground: Ground,
    /// The distance of the film's frames, in frames of the flight.
    pub(super) every: u64,
    pub(super) stills: Vec<Still>,
}

/// A frame of the film.
#[derive(Debug)]
pub(super) struct Still {
    pub(super) record: Record,
    /// The camera's image with the flow, JPEG.
    pub(super) flow: Vec<u8>,
    /// The camera's image with the sectors, JPEG.
    pub(super) sectors: Vec<u8>,
    /// Both sides of the chosen arc, in pixels of the image.
    pub(super) ribbon: Vec<[[f64; 2]; 2]>,
    /// The chosen arc from above: points relative to the vehicle along north and east, metres.
    pub(super) arc_m: Vec<DVec2>,
    pub(super) obstacles: Vec<Ring>,
}

/// An obstacle of the steering.
#[derive(Debug)]
pub(super) struct Ring {
    /// The position relative to the vehicle along north and east, metres.
    pub(super) off_m: DVec2,
    pub(super) radius_m: f64,
    /// The index of the first of [`TIMES`] that exceeds its time to contact; their number if none does.
    pub(super) time: usize,
}

impl FlightFilm {
    /// A film of a flight that has not begun. It takes the frames whose number is a multiple of `every`.
    ///
    /// # Errors
    /// [`Error::Parameter`] if `every` is 0.
    pub fn new(flight: &Flight, every: u64) -> Result<Self> {
        if every == 0 {
            return Err(Error::parameter("every", every, "at least 1"));
        }
        let ground = Ground::new(flight.course());
        Ok(Self { views: Views::new(flight)?, ground, every, stills: Vec::new() })
    }

    /// Adds a frame, if its number is a multiple of `every`.
    ///
    /// # Errors
    /// [`Error::SizeMismatch`] for an image or a flow of another camera.
    pub fn add(&mut self, seen: &FlightFrame<'_>) -> Result<()> {
        if !seen.record.frame.is_multiple_of(self.every) {
            return Ok(());
        }
        let views = &mut self.views;
        let mut jpeg = |layers| picture::encode_jpeg(views.layers(seen, layers)?, QUALITY);
        let [flow, sectors] = [jpeg(Layers::Flow)?, jpeg(Layers::Sectors)?];
        let speed_m_s = seen.record.airspeed_m_s.max(0.1);
        let obstacles = seen.steering.obstacles().iter().map(|obstacle| {
            let time_s = obstacle.place_ned_m.length() / speed_m_s;
            let time = TIMES.iter().position(|(limit, _)| time_s < *limit).unwrap_or(TIMES.len());
            Ring { off_m: obstacle.place_ned_m.truncate(), radius_m: obstacle.radius_m, time }
        });
        let arc = seen.steering.arc();
        self.stills.push(Still {
            record: seen.record.clone(),
            flow,
            sectors,
            ribbon: views.ribbon(seen),
            arc_m: arc.map_or(Vec::new(), |arc| arc.path_ned_m.map(|place| place.truncate()).to_vec()),
            obstacles: obstacles.collect(),
        });
        Ok(())
    }

    /// Width and height of the camera's images.
    pub(super) fn picture_size(&self) -> Size {
        self.views.picture_size()
    }
}
