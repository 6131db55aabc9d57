use glam::DVec2;

use super::field::{self, Field};
use super::scatter::{Area, poisson_disc};
use super::{Course, VISIBLE_M, northward};
use crate::error::Result;
use crate::sim::{Random, Surface};

/// The distance to both sides of the path, and behind the start, within which trees stand.
const HALF_WIDTH_M: f64 = 80.0;
const BEHIND_M: f64 = 20.0;

/// The height at which crowns begin, relative to the tree's.
const CROWN_FROM: f64 = 0.6;

/// Trunks at a minimum distance from each other, higher than the altitude band.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forest {
    /// Trees per square metre: 1/10000 to 1/25, by default 1/100. Two trunks' axes are at least 0.7/√density apart.
    pub density_per_m2: f64,
    /// Range of the trunks' radii. 0.05 to 5 m, by default 0.2 to 0.4.
    pub radius_m: [f64; 2],
    /// Range of the trees' heights. 1 to 100 m, by default 20 to 25.
    pub height_m: [f64; 2],
    /// Range of the trunks' angles from the vertical, each to a side of its own. 0 to 45 degrees, by default 0.
    pub lean_deg: [f64; 2],
    /// Range of the radii of crowns: upright cylinders around the upper two fifths of the trees. 0 to 5 m, by default
    /// 0: no crowns.
    pub crown_m: [f64; 2],
    /// Length to the north; the trees continue beyond. 10 to 1000 m, by default 200.
    pub length_m: f64,
    /// Radius around the start without trees. 1 to 500 m, by default 20.
    pub free_m: f64,
}

impl Default for Forest {
    fn default() -> Self {
        Self {
            density_per_m2: 1.0 / 100.0,
            radius_m: [0.2, 0.4],
            height_m: [20.0, 25.0],
            lean_deg: [0.0; 2],
            crown_m: [0.0; 2],
            length_m: 200.0,
            free_m: 20.0,
        }
    }
}

impl Forest {
    /// Thick trunks further apart: radius 0.8 to 1.2 m, one per 200 m².
    pub const PILLARS: Self = Self {
        density_per_m2: 1.0 / 200.0,
        radius_m: [0.8, 1.2],
        height_m: [20.0, 25.0],
        lean_deg: [0.0; 2],
        crown_m: [0.0; 2],
        length_m: 200.0,
        free_m: 20.0,
    };

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
    /// As in [`Forest::validate`], and for more trees than a world can hold.
    pub fn course(&self, seed: u64) -> Result<Course> {
        self.validate()?;
        let random = Random::new(seed);
        let area =
            Area { north_m: [-BEHIND_M, self.length_m + VISIBLE_M], east_m: [-HALF_WIDTH_M, HALF_WIDTH_M] };
        let mut trees = Vec::new();
        for (i, place) in
            poisson_disc(&mut random.fork(0), area, self.density_per_m2)?.into_iter().enumerate()
        {
            let mut random = random.fork(1 + i as u64);
            let [radius_m, height_m] = [self.radius_m, self.height_m].map(|range| random.within(range));
            if place.length() - radius_m >= self.free_m {
                let [lean_deg, crown_m] = [self.lean_deg, self.crown_m].map(|range| random.within(range));
                let towards = DVec2::from_angle(random.within([0.0, std::f64::consts::TAU]));
                let aside = height_m * lean_deg.to_radians().tan() * towards;
                let base = place.extend(0.0);
                let top = (place + aside).extend(-height_m);
                trees.push(Surface::cylinder(base, top, radius_m)?);
                if crown_m > radius_m {
                    let from = base.lerp(top, CROWN_FROM);
                    trees.push(Surface::cylinder(from, from.with_z(-height_m), crown_m)?);
                }
            }
        }
        northward(seed, trees, self.length_m, [2.0, 18.0])
    }

    pub(super) fn fields(&mut self) -> Vec<Field<'_>> {
        vec![
            Field::one("density", &mut self.density_per_m2, [1e-4, 1.0 / 25.0], "per m²"),
            Field::range("radius", &mut self.radius_m, [0.05, 5.0], "m"),
            Field::range("height", &mut self.height_m, [1.0, 100.0], "m"),
            Field::range("lean", &mut self.lean_deg, [0.0, 45.0], "degrees"),
            Field::range("crown", &mut self.crown_m, [0.0, 5.0], "m"),
            Field::one("length", &mut self.length_m, [10.0, 1000.0], "m"),
            Field::one("free", &mut self.free_m, [1.0, 500.0], "m"),
        ]
    }
}
