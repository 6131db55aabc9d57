use super::field::{self, Field};
use super::{Course, northward, wall_between};
use crate::error::Result;
use crate::sim::Random;
use glam::DVec2;

/// A wall across the path, on open ground, to be flown around; the goal is well past it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall {
    /// From the start to the centre of the wall, to the north. 20 to 1000 m, by default 80 to 100.
    pub distance_m: [f64; 2],
    /// Width of the wall. 1 to 500 m, by default 40 to 70.
    pub width_m: [f64; 2],
    /// Angle between the wall's normal and the path: positive if its right end is further away. Within ±80°, by
    /// default ±45.
    pub incidence_deg: [f64; 2],
    /// Offset of the wall's centre to the right of the path. Within ±250 m, by default ±20.
    pub offset_m: [f64; 2],
    /// Height of the wall. 1 to 500 m, by default 40: too high to fly over within the altitude band.
    pub height_m: f64,
    /// Distance from the furthest point of the wall to the goal. 1 to 1000 m, by default 20.
    pub past_m: f64,
}

impl Default for Wall {
    fn default() -> Self {
        Self {
            distance_m: [80.0, 100.0],
            width_m: [40.0, 70.0],
            incidence_deg: [-45.0, 45.0],
            offset_m: [-20.0, 20.0],
            height_m: 40.0,
            past_m: 20.0,
        }
    }
}

impl Wall {
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
    /// As in [`Wall::validate`].
    pub fn course(&self, seed: u64) -> Result<Course> {
        self.validate()?;
        let mut random = Random::new(seed);
        let [distance_m, width_m, incidence_deg, offset_m] =
            [self.distance_m, self.width_m, self.incidence_deg, self.offset_m]
                .map(|range| random.within(range));
        let (sin, cos) = incidence_deg.to_radians().sin_cos();
        let middle = DVec2::new(distance_m, offset_m);
        let half = DVec2::new(sin, cos) * width_m / 2.0;
        let wall = wall_between(middle - half, middle + half, self.height_m)?;
        northward(seed, vec![wall], distance_m + half.x.abs() + self.past_m, [2.0, 30.0])
    }

    pub(super) fn fields(&mut self) -> Vec<Field<'_>> {
        vec![
            Field::range("distance", &mut self.distance_m, [20.0, 1000.0], "m"),
            Field::range("width", &mut self.width_m, [1.0, 500.0], "m"),
            Field::range("incidence", &mut self.incidence_deg, [-80.0, 80.0], "degrees"),
            Field::range("offset", &mut self.offset_m, [-250.0, 250.0], "m"),
            Field::one("height", &mut self.height_m, [1.0, 500.0], "m"),
            Field::one("past", &mut self.past_m, [1.0, 1000.0], "m"),
        ]
    }
}
