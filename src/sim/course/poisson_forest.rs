use super::field::{self, Field};
use super::scatter::{Area, poisson};
use super::{Course, VISIBLE_M, northward, trunk};
use crate::error::Result;
use crate::sim::Random;

/// The distance to both sides of the path within which trees stand.
const HALF_WIDTH_M: f64 = 60.0;

/// The forest of Loquercio et al., "Learning high-speed flight in the wild", Science Robotics 6(59), 2021: trunks of
/// equal diameter at independent random positions, a homogeneous Poisson process, so that some passages are closed.
///
/// The flight starts before the forest, and is steady when it reaches the first trees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoissonForest {
    /// Trees per square metre: 1/10000 to 1/9, by default 1/49; 1/36 and 1/25 are the others in use.
    pub density_per_m2: f64,
    /// Diameter of the trunks. 0.1 to 5 m, by default 0.6.
    pub diameter_m: f64,
    /// From the start to the first trees. 1 to 500 m, by default 25.
    pub run_up_m: f64,
    /// Length of the path among the trees, to the north; they continue beyond. 1 to 1000 m, by default 40. The
    /// course's length is the sum of the run-up and this.
    pub forest_m: f64,
    /// Height of the trees. 1 to 100 m, by default 25: higher than the altitude band.
    pub height_m: f64,
}

impl Default for PoissonForest {
    fn default() -> Self {
        Self { density_per_m2: 1.0 / 49.0, diameter_m: 0.6, run_up_m: 25.0, forest_m: 40.0, height_m: 25.0 }
    }
}

impl PoissonForest {
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
    /// As in [`PoissonForest::validate`], and for more trees than a world can hold.
    pub fn course(&self, seed: u64) -> Result<Course> {
        self.validate()?;
        let length_m = self.run_up_m + self.forest_m;
        let radius_m = self.diameter_m / 2.0;
        // The trees begin at the bark, not at the axis.
        let north_m = [self.run_up_m + radius_m, length_m + VISIBLE_M];
        let area = Area { north_m, east_m: [-HALF_WIDTH_M, HALF_WIDTH_M] };
        let places = poisson(&mut Random::new(seed), area, self.density_per_m2)?;
        let trunks = places.into_iter().map(|place| trunk(place, radius_m, self.height_m));
        northward(seed, trunks.collect::<Result<_>>()?, length_m, [2.0, 18.0])
    }

    pub(super) fn fields(&mut self) -> Vec<Field<'_>> {
        vec![
            Field::one("density", &mut self.density_per_m2, [1e-4, 1.0 / 9.0], "per m²"),
            Field::one("diameter", &mut self.diameter_m, [0.1, 5.0], "m"),
            Field::one("run-up", &mut self.run_up_m, [1.0, 500.0], "m"),
            Field::one("forest", &mut self.forest_m, [1.0, 1000.0], "m"),
            Field::one("height", &mut self.height_m, [1.0, 100.0], "m"),
        ]
    }
}
