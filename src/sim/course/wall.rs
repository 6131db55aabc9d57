use super::field::{self, Field};
use super::{Course, northward, wall_between};
use crate::error::Result;
use crate::sim::Random;
use glam::DVec2;

/// A wall across the way, on open ground. It has to be flown around; the flight has succeeded when it is well past.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall {
    /// From the start to the middle of the wall, to the north. 20 to 1000 m, by default 80 to 100.
    pub distance_m: [f64; 2],
    /// From one end of the wall to the other. 1 to 500 m, by default 40 to 70.
    pub width_m: [f64; 2],
    /// Of the wall's normal to the way: positive if its right end is farther away. Within ±80°, by default ±45.
    pub incidence_deg: [f64; 2],
    /// The middle of the wall to the right of the way. Within ±250 m, by default ±20.
    pub offset_m: [f64; 2],
    /// 1 to 500 m, by default 40: too high to be climbed over within the band of altitude.
    pub height_m: f64,
    /// To be flown beyond the farthest point of the wall. 1 to 1000 m, by default 20.
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
    /// As [`Wall::validate`].
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
