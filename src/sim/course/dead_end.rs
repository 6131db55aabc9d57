use glam::DVec2;

use super::field::{self, Field};
use super::{Course, northward, wall_between};
use crate::error::Result;
use crate::sim::Random;

/// Two parallel walls closed by a third: a trap. A policy without memory flies in and does not come out. The course
/// exists to show that; failure is expected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeadEnd {
    /// From the start to the mouth of the trap. 20 to 1000 m, by default 60 to 80.
    pub distance_m: [f64; 2],
    /// Distance between the two walls. 2 to 500 m, by default 24 to 40: wide enough to turn around.
    pub width_m: [f64; 2],
    /// From the mouth to the end. 1 to 500 m, by default 40 to 60.
    pub depth_m: [f64; 2],
    /// Offset of the trap's centre to the right of the path. Within ±250 m, by default ±5.
    pub offset_m: [f64; 2],
    /// Height of the walls. 1 to 500 m, by default 40: too high to fly over within the altitude band.
    pub height_m: f64,
    /// Distance from the end of the trap to the goal. 1 to 1000 m, by default 20.
    pub past_m: f64,
}

impl Default for DeadEnd {
    fn default() -> Self {
        Self {
            distance_m: [60.0, 80.0],
            width_m: [24.0, 40.0],
            depth_m: [40.0, 60.0],
            offset_m: [-5.0, 5.0],
            height_m: 40.0,
            past_m: 20.0,
        }
    }
}

impl DeadEnd {
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
    /// As in [`DeadEnd::validate`].
    pub fn course(&self, seed: u64) -> Result<Course> {
        self.validate()?;
        let mut random = Random::new(seed);
        let [distance_m, width_m, depth_m, offset_m] =
            [self.distance_m, self.width_m, self.depth_m, self.offset_m].map(|range| random.within(range));
        let end_m = distance_m + depth_m;
        let [left, right] = [-0.5, 0.5].map(|side| offset_m + side * width_m);
        let corners = [(distance_m, left), (end_m, left), (end_m, right), (distance_m, right)];
        let corners = corners.map(|(north, east)| DVec2::new(north, east));
        let walls = corners.windows(2).map(|ends| wall_between(ends[0], ends[1], self.height_m));
        northward(seed, walls.collect::<Result<_>>()?, end_m + self.past_m, [2.0, 30.0])
    }

    pub(super) fn fields(&mut self) -> Vec<Field<'_>> {
        vec![
            Field::range("distance", &mut self.distance_m, [20.0, 1000.0], "m"),
            Field::range("width", &mut self.width_m, [2.0, 500.0], "m"),
            Field::range("depth", &mut self.depth_m, [1.0, 500.0], "m"),
            Field::range("offset", &mut self.offset_m, [-250.0, 250.0], "m"),
            Field::one("height", &mut self.height_m, [1.0, 500.0], "m"),
            Field::one("past", &mut self.past_m, [1.0, 1000.0], "m"),
        ]
    }
}
