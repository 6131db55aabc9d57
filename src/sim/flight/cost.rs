//! What a frame costs.

use std::time::Duration;

/// Time that the parts of a frame take. It differs from run to run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Drawing the picture, or finding the true flow.
    pub sensor: Duration,
    /// From the picture to the sectors.
    pub pipeline: Duration,
    /// From the sectors to a command.
    pub steer: Duration,
    /// The vehicle's motion, and how near it is to everything.
    pub vehicle: Duration,
}

impl Cost {
    /// All together.
    pub fn total(&self) -> Duration {
        self.sensor + self.pipeline + self.steer + self.vehicle
    }
}
