//! The clock of a flight: the vehicle's steps and the camera's frames.

use crate::sim::vehicle::STEP_S;

/// Steps of the vehicle from frame to frame.
pub(super) const STEPS: u32 = 8;
/// And in a second.
const STEPS_PER_S: f64 = 240.0;
/// From frame to frame, seconds.
pub const FRAME_S: f64 = STEPS as f64 * STEP_S;

/// The time of a step after a frame, seconds. It is that many steps, not their sum, which is off in its last digits: what
/// begins at 2 s begins with frame 60.
pub(super) fn time_s(frame: u64, step: u32) -> f64 {
    let steps = frame * u64::from(STEPS) + u64::from(step);
    steps as f64 / STEPS_PER_S
}
