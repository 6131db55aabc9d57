use std::f64::consts::FRAC_PI_2;

use glam::{DMat3, DVec3};

use super::field::{self, Field};
use super::scatter::{Area, poisson_disc};
use super::{Course, VISIBLE_M, northward};
use crate::error::Result;
use crate::sim::{Random, Surface};

/// The distance to both sides of the path within which houses stand.
const HALF_WIDTH_M: f64 = 120.0;

/// Houses of random orientation, with streets in between. Flying over them is allowed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct City {
    /// Range of both sides of a house's ground plan. 1 to 100 m, by default 10 to 24.
    pub edge_m: [f64; 2],
    /// Range of the houses' heights. 1 to 200 m, by default 12 to 60.
    pub height_m: [f64; 2],
    /// The mean distance of neighbouring centres: one house per square of it. The least distance is 0.7 of it. 10 to
    /// 500 m, by default 48.
    pub spacing_m: f64,
    /// Length to the north. 10 to 2000 m, by default 400.
    pub length_m: f64,
    /// Radius around the start without houses. 1 to 500 m, by default 40.
    pub free_m: f64,
}

impl Default for City {
    fn default() -> Self {
        Self { edge_m: [10.0, 24.0], height_m: [12.0, 60.0], spacing_m: 48.0, length_m: 400.0, free_m: 40.0 }
    }
}

impl City {
    /// Checks that every parameter is within its range.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) naming the first that is not.
    pub fn validate(&self) -> Result<()> {
        field::check(&{ *self }.fields())
    }

    /// The course of a seed.
    ///
    /// # Errors
    /// As in [`City::validate`].
    pub fn course(&self, seed: u64) -> Result<Course> {
        self.validate()?;
        let random = Random::new(seed);
        let area =
            Area { north_m: [-VISIBLE_M, self.length_m + VISIBLE_M], east_m: [-HALF_WIDTH_M, HALF_WIDTH_M] };
        let places = poisson_disc(&mut random.fork(0), area, self.spacing_m.powi(-2))?;
        let mut houses = Vec::new();
        for (i, place) in places.into_iter().enumerate() {
            let mut random = random.fork(1 + i as u64);
            let edges_m = [self.edge_m, self.edge_m, self.height_m].map(|range| random.within(range));
            let turn = DMat3::from_rotation_z(random.within([0.0, FRAC_PI_2]));
            if place.length() - edges_m[0].hypot(edges_m[1]) / 2.0 >= self.free_m {
                houses.push(Surface::cuboid(place.extend(-edges_m[2] / 2.0), turn, DVec3::from(edges_m))?);
            }
        }
        northward(seed, houses, self.length_m, [2.0, self.height_m[1] + VISIBLE_M])
    }

    pub(super) fn fields(&mut self) -> Vec<Field<'_>> {
        vec![
            Field::range("edge", &mut self.edge_m, [1.0, 100.0], "m"),
            Field::range("height", &mut self.height_m, [1.0, 200.0], "m"),
            Field::one("spacing", &mut self.spacing_m, [10.0, 500.0], "m"),
            Field::one("length", &mut self.length_m, [10.0, 2000.0], "m"),
            Field::one("free", &mut self.free_m, [1.0, 500.0], "m"),
        ]
    }
}
