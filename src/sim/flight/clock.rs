//! The clock of a flight: the vehicle's steps and the camera's frames.

use crate::sim::vehicle::STEP_S;

/// The vehicle's steps per frame.
pub(super) const STEPS: u32 = 8;
/// The vehicle's steps per second.
const STEPS_PER_S: f64 = 240.0;
/// The frame interval, seconds.
pub const FRAME_S: f64 = STEPS as f64 * STEP_S;

/// The time of a step after a frame, seconds. Computed from the number of steps, as a sum of step lengths has rounding
/// errors: a fault that begins at 2 s must begin with frame 60.
pub(super) fn time_s(frame: u64, step: u32) -> f64 {
    let steps = frame * u64::from(STEPS) + u64::from(step);
    steps as f64 / STEPS_PER_S
}
