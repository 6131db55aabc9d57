//! The map of danger, levelled with the horizon.

use glam::DMat3;

use super::{Danger, SteerParams};
use crate::sphere::{Grid, Sector, Sectors};

/// Samples along each side of a sector of the map.
const SAMPLES: [u32; 2] = [2, 4];

/// The map of danger: the inverse of the time to contact in each direction, levelled with the horizon and aligned
/// with the direction of motion.
///
/// Azimuth and elevation are those of a level camera that looks along the motion: [`Grid`] has the signs.
#[derive(Clone, Debug, PartialEq)]
pub struct DangerMap {
    /// The layout of the sectors.
    pub grid: Grid,
    /// Inverse of the time to contact along each sector's bearing, 1/s, one per sector, row by row; 0 where nothing
    /// is near or known.
    pub rates_hz: Vec<f64>,
    /// The share of each sector that is in view and known, 0 to 1, one per sector, row by row.
    pub known: Vec<f64>,
}

impl DangerMap {
    pub(super) fn new(params: &SteerParams) -> Self {
        let [azimuth, elevation] = params.map_half_rad;
        let count = |half: f64, pitch: f64| ((2.0 * half / pitch).round() as usize).max(1);
        let grid = Grid {
            columns: count(azimuth, params.map_pitch_rad[0]),
            rows: count(elevation, params.map_pitch_rad[1]),
            azimuth_rad: [-azimuth, azimuth],
            elevation_rad: [elevation, -elevation],
        };
        Self { grid, rates_hz: vec![0.0; grid.len()], known: vec![0.0; grid.len()] }
    }

    /// Clears the map.
    pub(super) fn reset(&mut self) {
        self.rates_hz.fill(0.0);
        self.known.fill(0.0);
    }

    /// Updates the map with the sectors of a frame.
    pub(super) fn update(&mut self, params: &SteerParams, sectors: &Sectors, camera_from_level: &DMat3) {
        for at in 0..self.grid.len() {
            let (column, row) = (at % self.grid.columns, at / self.grid.columns);
            let [middle, pitch] = [self.grid.angles_rad(column, row), self.grid.pitch_rad()];
            let (mut rate, mut known) = (0.0_f64, 0);
            for j in 0..SAMPLES[1] {
                for i in 0..SAMPLES[0] {
                    let off = |k: u32, n: u32| (f64::from(k) + 0.5) / f64::from(n) - 0.5;
                    let angles = [
                        middle[0] + pitch[0] * off(i, SAMPLES[0]),
                        middle[1] + pitch[1] * off(j, SAMPLES[1]),
                    ];
                    let bearing = *camera_from_level * crate::sphere::bearing(angles);
                    let Some([column, row]) = sectors.grid.sector(bearing) else { continue };
                    let sector = sectors.get(column, row);
                    if !sector.counts(params.least_coverage) {
                        continue;
                    }
                    known += 1;
                    rate = rate.max(rate_hz(params.danger, sector));
                }
            }
            self.known[at] = f64::from(known) / f64::from(SAMPLES[0] * SAMPLES[1]);
            // Where no flow is known the rate decays to 0: the sky and what is far away have no measurable flow.
            self.rates_hz[at] += params.smoothing * (rate - self.rates_hz[at]);
        }
    }
}

/// The inverse of the time to contact of a sector.
fn rate_hz(danger: Danger, sector: &Sector) -> f64 {
    let (nearness, growth) = (sector.nearness_rate_hz[2], 0.5 * sector.divergence_hz);
    let rate = match danger {
        Danger::Nearness => nearness,
        Danger::Divergence => growth,
        Danger::Blend => nearness.max(growth),
    };
    // NaN and receding surfaces are no danger.
    rate.max(0.0)
}
