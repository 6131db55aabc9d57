use glam::{DVec2, DVec3};

use super::field::{self, Field};
use super::{Course, northward, wall_between};
use crate::error::Result;
use crate::sim::{Random, Surface};

/// Walls across the path, each with an opening under a beam, like gates: to be flown through, or around.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gates {
    /// From the start to the first gate, and from each gate to the next. 20 to 1000 m, by default 60 to 80.
    pub distance_m: [f64; 2],
    /// Width of the opening. 2 to 100 m, by default 8 to 12.
    pub opening_m: [f64; 2],
    /// Height of the beam's lower edge above the ground. 1 to 100 m, by default 14 to 16.
    pub beam_m: [f64; 2],
    /// Offset of the opening's centre to the right of the path. Within ±100 m, by default ±8.
    pub offset_m: [f64; 2],
    /// Width of the wall to each side of the opening. 0.1 to 200 m, by default 40.
    pub side_m: f64,
    /// Height of the wall, at least that of the beam. 1 to 500 m, by default 40: too high to fly over within the
    /// altitude band.
    pub height_m: f64,
    /// Length to the north. 10 to 2000 m, by default 200.
    pub length_m: f64,
}

impl Default for Gates {
    fn default() -> Self {
        Self {
            distance_m: [60.0, 80.0],
            opening_m: [8.0, 12.0],
            beam_m: [14.0, 16.0],
            offset_m: [-8.0, 8.0],
            side_m: 40.0,
            height_m: 40.0,
            length_m: 200.0,
        }
    }
}

impl Gates {
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
    /// As in [`Gates::validate`].
    pub fn course(&self, seed: u64) -> Result<Course> {
        self.validate()?;
        let mut random = Random::new(seed);
        let mut surfaces = Vec::new();
        let mut north_m = random.within(self.distance_m);
        while north_m < self.length_m {
            let [opening_m, beam_m, offset_m] =
                [self.opening_m, self.beam_m, self.offset_m].map(|range| random.within(range));
            let [left, right] = [-0.5, 0.5].map(|side| offset_m + side * opening_m);
            let at = |east_m: f64| DVec2::new(north_m, east_m);
            surfaces.push(wall_between(at(left - self.side_m), at(left), self.height_m)?);
            surfaces.push(wall_between(at(right), at(right + self.side_m), self.height_m)?);
            if beam_m < self.height_m {
                let half_height_m = 0.5 * (self.height_m - beam_m);
                surfaces.push(Surface::rectangle(
                    at(offset_m).extend(-beam_m - half_height_m),
                    DVec3::Y * 0.5 * opening_m,
                    DVec3::NEG_Z * half_height_m,
                )?);
            }
            north_m += random.within(self.distance_m);
        }
        northward(seed, surfaces, self.length_m, [2.0, 18.0])
    }

    pub(super) fn fields(&mut self) -> Vec<Field<'_>> {
        vec![
            Field::range("distance", &mut self.distance_m, [20.0, 1000.0], "m"),
            Field::range("opening", &mut self.opening_m, [2.0, 100.0], "m"),
            Field::range("beam", &mut self.beam_m, [1.0, 100.0], "m"),
            Field::range("offset", &mut self.offset_m, [-100.0, 100.0], "m"),
            Field::one("side", &mut self.side_m, [0.1, 200.0], "m"),
            Field::one("height", &mut self.height_m, [1.0, 500.0], "m"),
            Field::one("length", &mut self.length_m, [10.0, 2000.0], "m"),
        ]
    }
}
