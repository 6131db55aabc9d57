//! Sectors of the view: the flow of their cells, summarized in seconds and radians.

use glam::{DMat3, DVec3};

use super::grid::Grid;
use crate::frame::Size;
use crate::kernels::sectors::CHANNELS;

/// The summary of the flow in one sector of the view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sector {
    /// The share of the sector's cells whose flow is trusted, 0 to 1. At 0 the other fields are unknown.
    pub coverage: f64,
    /// The mean confidence of those cells, 0 to 1.
    pub confidence: f64,
    /// Nearness rate ρ‖v‖ in 1/s, the inverse of the time to contact along the bearing: lower quantile, median and
    /// upper quantile over the sector's cells. Negative where things recede.
    pub nearness_rate_hz: [f64; 3],
    /// Standard error of a single cell's nearness rate, 1/s.
    pub nearness_error_hz: f64,
    /// Upper quantile of the positive part of the divergence of the flow on the sphere, 1/s.
    pub divergence_hz: f64,
    /// Mean derotated flow on the unit sphere in the camera's frame, rad/s.
    pub flow_rad_s: DVec3,
}

impl Sector {
    /// Whether any cell of it is trusted.
    pub fn is_known(&self) -> bool {
        self.coverage > 0.0
    }

    /// Whether any cell of it, and at least this share of them, is trusted.
    pub(crate) fn counts(&self, least_coverage: f64) -> bool {
        self.is_known() && self.coverage >= least_coverage
    }
}

/// The sectors of a pair of frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Sectors {
    /// The grid of the sectors.
    pub grid: Grid,
    /// Seconds between the two frames.
    pub interval_s: f64,
    /// The sectors, row by row from the upper left: `grid.len()` of them.
    pub sectors: Vec<Sector>,
    /// The moment `Σ w n nᵀ` of each sector, as many as [`Sectors::sectors`] and in their order. n = p × F is the
    /// normal of a cell's bearing p and its flow F in radians per frame, w its confidence; the direction of motion is
    /// perpendicular to every n.
    pub moments: Vec<DMat3>,
}

impl Sectors {
    /// Sectors without a trusted cell.
    pub fn unknown(grid: Grid) -> Self {
        let count = grid.len();
        Self {
            grid,
            interval_s: 0.0,
            sectors: vec![Sector::default(); count],
            moments: vec![DMat3::ZERO; count],
        }
    }

    /// Reads the output of the kernel `sectors` for frames this many seconds apart.
    pub(crate) fn read(&mut self, values: &[f32], interval_s: f64) {
        self.interval_s = interval_s;
        let (columns, rate) = (self.grid.columns, 1.0 / interval_s);
        let stride = Size::new(columns as u32, 1).stride();
        for (i, (sector, moment)) in self.sectors.iter_mut().zip(&mut self.moments).enumerate() {
            let at = i / columns * CHANNELS * stride + i % columns;
            let value = |channel: usize| f64::from(values[at + channel * stride]);
            *sector = Sector {
                coverage: value(0),
                confidence: value(5),
                nearness_rate_hz: [1, 2, 3].map(|channel| rate * value(channel)),
                nearness_error_hz: rate * value(15),
                divergence_hz: rate * value(4),
                flow_rad_s: rate * DVec3::new(value(6), value(7), value(8)),
            };
            let [xx, xy, xz, yy, yz, zz] = [9, 10, 11, 12, 13, 14].map(value);
            *moment = DMat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz]);
        }
    }

    /// The sector in a column and row.
    pub fn get(&self, column: usize, row: usize) -> &Sector {
        &self.sectors[row * self.grid.columns + column]
    }

    /// Time to contact along a sector's bearing, in seconds from the later frame, from the earliest to the latest: by
    /// the upper quantile of its nearness rates, by their median, by their lower quantile. `None` where the sector
    /// recedes or is unknown.
    pub fn time_to_contact_s(&self, sector: &Sector) -> [Option<f64>; 3] {
        let [low, median, high] = sector.nearness_rate_hz;
        // The rates are those at the middle of the interval.
        let at_the_later =
            |rate_hz: f64| (rate_hz > 0.0).then(|| (1.0 / rate_hz - 0.5 * self.interval_s).max(0.0));
        [high, median, low].map(|rate_hz| at_the_later(rate_hz).filter(|_| sector.is_known()))
    }

    /// The share of the field of view whose flow is trusted, 0 to 1.
    pub fn coverage(&self) -> f64 {
        self.sectors.iter().map(|sector| sector.coverage).sum::<f64>() / self.sectors.len() as f64
    }
}
