//! The obstacles, in view and remembered.

use std::f64::consts::FRAC_PI_2;

use glam::{DMat3, DVec3};

use super::{DangerMap, SteerParams};
use crate::sphere::Grid;

/// An obstacle: a ball to pass at a clearance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Obstacle {
    /// The centre, relative to the aircraft along north, east and down, in metres.
    pub place_ned_m: DVec3,
    /// The radius in metres.
    pub radius_m: f64,
}

/// The known obstacles.
#[derive(Clone, Debug, Default)]
pub(super) struct Obstacles {
    /// Those in view first, then those remembered.
    all: Vec<Obstacle>,
    in_view: usize,
    /// When each remembered obstacle was last seen.
    seen_s: Vec<f64>,
}

impl Obstacles {
    pub(super) fn all(&self) -> &[Obstacle] {
        &self.all
    }

    pub(super) fn reset(&mut self) {
        *self = Self::default();
    }

    /// Shifts all obstacles after the aircraft has moved.
    pub(super) fn moved(&mut self, by_ned_m: DVec3) {
        self.all.iter_mut().for_each(|obstacle| obstacle.place_ned_m -= by_ned_m);
    }

    /// Adds the obstacles of a frame. Earlier ones outside the frame's view are remembered.
    pub(super) fn see(
        &mut self,
        params: &SteerParams,
        map: &DangerMap,
        frame: ViewGeometry<'_>,
        [before_s, now_s]: [f64; 2],
    ) {
        let mut remembered = Vec::new();
        for (i, obstacle) in self.all.iter().enumerate() {
            let seen_s = if i < self.in_view { before_s } else { self.seen_s[i - self.in_view] };
            if now_s - seen_s <= params.memory_s && !frame.shows(obstacle) {
                remembered.push((*obstacle, seen_s));
            }
        }
        self.all.clear();
        for (at, rate) in map.rates_hz.iter().enumerate() {
            if !(*rate >= params.least_rate_hz && map.known[at] > 0.0) {
                continue;
            }
            let distance_m = frame.speed_m_s / rate;
            let bearing = map.grid.bearing(at % map.grid.columns, at / map.grid.columns);
            self.all.push(Obstacle {
                place_ned_m: *frame.ned_from_level * bearing * distance_m,
                radius_m: distance_m * params.half_width_rad.tan(),
            });
        }
        self.in_view = self.all.len();
        self.all.extend(remembered.iter().map(|(obstacle, _)| *obstacle));
        self.seen_s = remembered.into_iter().map(|(_, seen_s)| seen_s).collect();
    }
}

/// The field of view of a frame.
#[derive(Clone, Copy)]
pub(super) struct ViewGeometry<'a> {
    pub(super) ned_from_level: &'a DMat3,
    pub(super) camera_from_ned: &'a DMat3,
    /// The sectors of the view, in the camera's frame.
    pub(super) grid: &'a Grid,
    pub(super) speed_m_s: f64,
}

impl ViewGeometry<'_> {
    /// Whether an obstacle is within the view, or so far behind that it no longer matters.
    fn shows(&self, obstacle: &Obstacle) -> bool {
        let place = obstacle.place_ned_m;
        let ahead = *self.ned_from_level * DVec3::Z;
        ahead.angle_between(place) > FRAC_PI_2 || self.grid.sector(*self.camera_from_ned * place).is_some()
    }
}
