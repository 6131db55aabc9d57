use std::f64::consts::TAU;

use glam::DVec2;

use super::field::{self, Field};
use super::{Course, VISIBLE_M, northward, wall_between};
use crate::error::Result;
use crate::sim::Random;

/// The ranges of the wavelengths of the two waves whose sum is the centre line, metres.
const WAVELENGTHS_M: [[f64; 2]; 2] = [[70.0, 100.0], [100.0, 150.0]];
/// The length of a wall's link, to the north.
const LINK_M: f64 = 4.0;
/// The distance before the start at which the walls begin.
const BEHIND_M: f64 = 32.0;
/// Half the overlap of links, so that rounding leaves no gap.
const OVERLAP_M: f64 = 1e-6;

/// A winding corridor between two high walls. The flight starts on its centre line, in its direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corridor {
    /// Distance between the walls. 2 to 50 m, by default 20; 14 and 30 are the others in use.
    pub width_m: f64,
    /// The largest curvature of the centre line, the inverse of its least radius. 0 to 1/35 1/m, by default 1/35.
    pub curvature_per_m: f64,
    /// Length to the north. 10 to 2000 m, by default 300.
    pub length_m: f64,
    /// Height of the walls. 1 to 500 m, by default 40: too high to fly over within the altitude band.
    pub height_m: f64,
}

impl Default for Corridor {
    fn default() -> Self {
        Self { width_m: 20.0, curvature_per_m: 1.0 / 35.0, length_m: 300.0, height_m: 40.0 }
    }
}

impl Corridor {
    /// Checks that every parameter is within its range.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) naming the first that is not.
    pub fn validate(&self) -> Result<()> {
        field::check(&{ *self }.fields())
    }

    /// The course of a seed, with a [centre line](Course::offset_m).
    ///
    /// # Errors
    /// As in [`Corridor::validate`].
    pub fn course(&self, seed: u64) -> Result<Course> {
        self.validate()?;
        let middle = Middle::new(&mut Random::new(seed), self.curvature_per_m);
        let links = ((BEHIND_M + self.length_m + VISIBLE_M) / LINK_M).ceil() as i32;
        let norths: Vec<f64> = (0..=links).map(|i| f64::from(i) * LINK_M - BEHIND_M).collect();
        let mut walls = Vec::new();
        for side in [-0.5, 0.5] {
            let corners: Vec<DVec2> =
                norths.iter().map(|north| middle.aside(*north, side * self.width_m)).collect();
            for ends in corners.windows(2) {
                let over = (ends[1] - ends[0]).normalize_or_zero() * OVERLAP_M;
                walls.push(wall_between(ends[0] - over, ends[1] + over, self.height_m)?);
            }
        }
        let mut course = northward(seed, walls, self.length_m, [2.0, 30.0])?;
        course.start_yaw_rad = middle.slope(0.0).atan();
        course.centre_line_m = norths.iter().map(|north| middle.aside(*north, 0.0)).collect();
        Ok(course)
    }

    pub(super) fn fields(&mut self) -> Vec<Field<'_>> {
        vec![
            Field::one("width", &mut self.width_m, [2.0, 50.0], "m"),
            Field::one("curvature", &mut self.curvature_per_m, [0.0, 1.0 / 35.0], "1/m"),
            Field::one("length", &mut self.length_m, [10.0, 2000.0], "m"),
            Field::one("height", &mut self.height_m, [1.0, 500.0], "m"),
        ]
    }
}

/// The centre line as metres east of north: the sum of two waves, 0 at the start.
struct Middle {
    waves: [Wave; 2],
}

struct Wave {
    amplitude_m: f64,
    per_m: f64,
    phase: f64,
}

impl Middle {
    /// The curvature of a graph is at most its second derivative, which is at most the sum of the waves' own.
    fn new(random: &mut Random, curvature_per_m: f64) -> Self {
        let share = random.within([0.3, 0.7]);
        let mut wave = |share: f64, wavelength_m: [f64; 2]| {
            let per_m = TAU / random.within(wavelength_m);
            let phase = random.within([0.0, TAU]);
            Wave { amplitude_m: share * curvature_per_m / (per_m * per_m), per_m, phase }
        };
        Self { waves: [wave(share, WAVELENGTHS_M[0]), wave(1.0 - share, WAVELENGTHS_M[1])] }
    }

    fn slope(&self, north_m: f64) -> f64 {
        let slope = |wave: &Wave| wave.amplitude_m * wave.per_m * (wave.per_m * north_m + wave.phase).cos();
        self.waves.iter().map(slope).sum()
    }

    /// The point at a distance to the right of the centre line.
    fn aside(&self, north_m: f64, right_m: f64) -> DVec2 {
        let east =
            |wave: &Wave| wave.amplitude_m * ((wave.per_m * north_m + wave.phase).sin() - wave.phase.sin());
        let middle = DVec2::new(north_m, self.waves.iter().map(east).sum());
        middle + DVec2::new(-self.slope(north_m), 1.0).normalize() * right_m
    }
}
