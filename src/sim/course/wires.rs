use glam::{DVec2, DVec3};

use super::field::{self, Field};
use super::{Course, northward, trunk};
use crate::error::Result;
use crate::sim::{Random, Surface};

/// The reach of the wires to both sides of the path.
const HALF_WIDTH_M: f64 = 75.0;
/// Offsets of the poles to the right of the path: none stands on it.
const POLES_M: [f64; 4] = [-75.0, -25.0, 25.0, 75.0];
const POLE_RADIUS_M: f64 = 0.15;

/// Lines of wires on poles across the path, near the altitude of the flight. There is room above and below them, but
/// a wire is thinner than a pixel until it is near. The course exists to show that; failure is expected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wires {
    /// From the start to the first line, and from each line to the next. 20 to 1000 m, by default 50 to 70.
    pub distance_m: [f64; 2],
    /// Height of each wire above the ground. 1 to 100 m, by default 8 to 12.
    pub height_m: [f64; 2],
    /// Radius of a wire. 0.001 to 0.1 m, by default 0.005 to 0.015.
    pub radius_m: [f64; 2],
    /// Wires per line. 1 to 20, by default 3; a fraction is truncated.
    pub wires: f64,
    /// Length to the north. 10 to 2000 m, by default 200.
    pub length_m: f64,
}

impl Default for Wires {
    fn default() -> Self {
        Self {
            distance_m: [50.0, 70.0],
            height_m: [8.0, 12.0],
            radius_m: [0.005, 0.015],
            wires: 3.0,
            length_m: 200.0,
        }
    }
}

impl Wires {
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
    /// As in [`Wires::validate`].
    pub fn course(&self, seed: u64) -> Result<Course> {
        self.validate()?;
        let mut random = Random::new(seed);
        let mut surfaces = Vec::new();
        let mut north_m = random.within(self.distance_m);
        while north_m < self.length_m {
            let mut top_m = 0.0_f64;
            for _ in 0..self.wires as u32 {
                let (height_m, radius_m) = (random.within(self.height_m), random.within(self.radius_m));
                let [left, right] =
                    [-HALF_WIDTH_M, HALF_WIDTH_M].map(|east| DVec3::new(north_m, east, -height_m));
                surfaces.push(Surface::cylinder(left, right, radius_m)?);
                top_m = top_m.max(height_m + radius_m);
            }
            for east_m in POLES_M {
                surfaces.push(trunk(DVec2::new(north_m, east_m), POLE_RADIUS_M, top_m)?);
            }
            north_m += random.within(self.distance_m);
        }
        northward(seed, surfaces, self.length_m, [2.0, 30.0])
    }

    pub(super) fn fields(&mut self) -> Vec<Field<'_>> {
        vec![
            Field::range("distance", &mut self.distance_m, [20.0, 1000.0], "m"),
            Field::range("height", &mut self.height_m, [1.0, 100.0], "m"),
            Field::range("radius", &mut self.radius_m, [0.001, 0.1], "m"),
            Field::one("wires", &mut self.wires, [1.0, 20.0], ""),
            Field::one("length", &mut self.length_m, [10.0, 2000.0], "m"),
        ]
    }
}
