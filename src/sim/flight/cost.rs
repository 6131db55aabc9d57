//! The computing time of a frame.

use std::time::Duration;

/// The computing time of a frame, by part. It differs from run to run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Rendering the image, or computing the true flow.
    pub sensor: Duration,
    /// From the image to the sectors.
    pub pipeline: Duration,
    /// From the sectors to the command.
    pub steer: Duration,
    /// Advancing the vehicle, and its clearance.
    pub vehicle: Duration,
}

impl Cost {
    /// The total.
    pub fn total(&self) -> Duration {
        self.sensor + self.pipeline + self.steer + self.vehicle
    }
}
