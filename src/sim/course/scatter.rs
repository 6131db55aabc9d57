//! Random positions of obstacles.

use glam::DVec2;

use super::MAX_SURFACES;
use crate::error::{Error, Result};
use crate::sim::Random;

/// The least distance of two positions relative to the mean one, 1/√density. Half of all positions fit at 0.83 and
/// none more; at 0.7 one in thirty throws finds room to the end.
pub(super) const GAP: f64 = 0.7;

/// The most throws per position. At [`GAP`] they are never used up.
const THROWS: usize = 1000;

/// A rectangle of the ground: its range to the north, and to the east.
#[derive(Clone, Copy, Debug)]
pub(super) struct Area {
    pub(super) north_m: [f64; 2],
    pub(super) east_m: [f64; 2],
}

impl Area {
    pub(super) fn square_metres(&self) -> f64 {
        (self.north_m[1] - self.north_m[0]) * (self.east_m[1] - self.east_m[0])
    }
}

/// Positions with a minimum distance: a Poisson-disc distribution by dart throwing. No two are nearer than
/// [`GAP`]/√density, and there are density × area of them, rounded.
pub(super) fn poisson_disc(random: &mut Random, area: Area, density_per_m2: f64) -> Result<Vec<DVec2>> {
    let wanted = count(density_per_m2 * area.square_metres())?;
    let gap_m = GAP / density_per_m2.sqrt();
    // A cell this small holds at most one position.
    let cell_m = gap_m * 0.7;
    let [rows, columns] =
        [area.north_m, area.east_m].map(|[low, high]| ((high - low) / cell_m).floor() as usize + 1);
    let mut cells: Vec<Option<DVec2>> = vec![None; rows * columns];
    let mut places = Vec::with_capacity(wanted);
    for _ in 0..THROWS * wanted {
        if places.len() == wanted {
            break;
        }
        let place = DVec2::new(random.within(area.north_m), random.within(area.east_m));
        let [row, column] = [(place.x - area.north_m[0], rows), (place.y - area.east_m[0], columns)]
            .map(|(from_low, cells)| ((from_low / cell_m) as usize).min(cells - 1));
        let near = |cell: usize, cells: usize| cell.saturating_sub(2)..=(cell + 2).min(cells - 1);
        let taken =
            near(row, rows).flat_map(|row| near(column, columns).map(move |column| row * columns + column));
        if taken.filter_map(|cell| cells[cell]).all(|other| place.distance_squared(other) >= gap_m * gap_m) {
            cells[row * columns + column] = Some(place);
            places.push(place);
        }
    }
    Ok(places)
}

/// Independent positions: a homogeneous Poisson process, from south to north.
pub(super) fn poisson(random: &mut Random, area: Area, density_per_m2: f64) -> Result<Vec<DVec2>> {
    count(density_per_m2 * area.square_metres())?;
    let per_metre = density_per_m2 * (area.east_m[1] - area.east_m[0]);
    let mut places = Vec::new();
    let mut north_m = area.north_m[0];
    loop {
        north_m += random.exponential() / per_metre;
        if !(north_m < area.north_m[1]) {
            return Ok(places);
        }
        places.push(DVec2::new(north_m, random.within(area.east_m)));
    }
}

/// The expected number of obstacles, at most half of what a world can hold, to leave room for chance.
fn count(expected: f64) -> Result<usize> {
    let most = MAX_SURFACES / 2;
    if !(expected <= most as f64) {
        let found = format_args!("{expected:.0} obstacles by length and density");
        return Err(Error::parameter("world", found, format_args!("at most {most}")));
    }
    Ok(expected.round() as usize)
}
