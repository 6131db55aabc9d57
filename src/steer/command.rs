/// A command to the autopilot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Command {
    /// Bank angle of a coordinated turn, in radians: positive with the right wing down, which turns to the right.
    pub bank_rad: f64,
    /// Angle of the flight path above the horizon, in radians.
    pub climb_rad: f64,
}
