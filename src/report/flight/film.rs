//! A flight frame by frame, for a page that plays it.

use glam::DVec2;

use super::map::Ground;
use super::views::Views;
use crate::error::{Error, Result};
use crate::frame::Size;
use crate::io::picture;
use crate::report::colours::TIMES;
use crate::report::overlay::Layers;
use crate::sim::flight::{Flight, FlightFrame, Record};

/// Quality of the camera's pictures.
const QUALITY: u8 = 62;

/// What a page shows of a flight's frames: the camera's picture with the flow, the same with the sectors, and what it takes
/// to draw the arc that was chosen and a map.
///
/// As [`FlightVideo`](super::FlightVideo), but compressed and in parts, so that the page can lay them out; a frame takes some
/// 30 kB.
#[derive(Debug)]
pub struct FlightFilm {
    views: Views,
    pub(super) ground: Ground,
    /// From one of the frames to the next, in frames of the flight.
    pub(super) every: u64,
    pub(super) stills: Vec<Still>,
}

/// A frame that was drawn.
#[derive(Debug)]
pub(super) struct Still {
    pub(super) record: Record,
    /// What the camera sees with the flow over it, JPEG.
    pub(super) flow: Vec<u8>,
    /// The same with the sectors, JPEG.
    pub(super) sectors: Vec<u8>,
    /// Both sides of the arc that was chosen, in pixels of the picture.
    pub(super) ribbon: Vec<[[f64; 2]; 2]>,
    /// The arc from above, from the vehicle along north and east, metres.
    pub(super) arc_m: Vec<DVec2>,
    pub(super) obstacles: Vec<Ring>,
}

/// What the steering takes for an obstacle.
#[derive(Debug)]
pub(super) struct Ring {
    /// From the vehicle along north and east, metres.
    pub(super) off_m: DVec2,
    pub(super) radius_m: f64,
    /// Which of [`TIMES`] it is met within; their number if later.
    pub(super) time: usize,
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
        let ground = Ground::new(flight.course());
        Ok(Self { views: Views::new(flight)?, ground, every, stills: Vec::new() })
    }

    /// Draws a frame, if it is one of those that are drawn.
    ///
    /// # Errors
    /// [`Error::SizeMismatch`] for a picture or a flow of another camera.
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

    /// Width and height of the camera's pictures.
    pub(super) fn picture_size(&self) -> Size {
        self.views.picture_size()
    }
}
