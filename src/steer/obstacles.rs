//! The obstacles, in view and remembered.

use std::f64::consts::FRAC_PI_2;

use glam::{DMat3, DVec3};

use super::columns::Columns;
use super::{DangerMap, Reading, SteerParams};
use crate::sphere::Sectors;

/// No obstacle is nearer than this, metres.
const NEAREST_M: f64 = 0.3;

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
    columns: Columns,
}

impl Obstacles {
    pub(super) fn all(&self) -> &[Obstacle] {
        &self.all
    }

    pub(super) fn in_view(&self) -> &[Obstacle] {
        &self.all[..self.in_view]
    }

    pub(super) fn reset(&mut self) {
        *self = Self::default();
    }

    /// Shifts all obstacles after the aircraft has moved.
    pub(super) fn moved(&mut self, by_ned_m: DVec3) {
        self.all.iter_mut().for_each(|obstacle| obstacle.place_ned_m -= by_ned_m);
    }

    /// Adds the obstacles of a frame. Earlier ones are remembered where it shows nothing.
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
            if now_s - seen_s <= params.memory_s && !frame.shows(params, obstacle) {
                remembered.push((*obstacle, seen_s));
            }
        }
        self.all.clear();
        let rates_hz = match params.reading {
            Reading::Sectors => &map.rates_hz,
            Reading::Columns => self.columns.read(params, map, frame.speed_m_s),
        };
        // The rates are those at the middle of the interval.
        let since_m = 0.5 * frame.speed_m_s * frame.sectors.interval_s;
        for (at, rate) in rates_hz.iter().enumerate() {
            // A column fills its sectors that are not known.
            let counts = params.reading == Reading::Columns || map.known[at] > 0.0;
            if !(counts && *rate >= params.least_rate_hz) {
                continue;
            }
            let distance_m = (params.distance_scale * frame.speed_m_s / rate - since_m).max(NEAREST_M);
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
    pub(super) sectors: &'a Sectors,
    pub(super) speed_m_s: f64,
}

impl ViewGeometry<'_> {
    /// Whether the view shows what is at an obstacle's place, or that is so far behind that it no longer matters. A
    /// sector without trusted flow shows nothing: the obstacle may still be there.
    fn shows(&self, params: &SteerParams, obstacle: &Obstacle) -> bool {
        let place = obstacle.place_ned_m;
        let ahead = *self.ned_from_level * DVec3::Z;
        let sector = self.sectors.grid.sector(*self.camera_from_ned * place);
        ahead.angle_between(place) > FRAC_PI_2
            || sector.is_some_and(|[column, row]| self.sectors.get(column, row).counts(params.least_coverage))
    }
}
