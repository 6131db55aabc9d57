//! Configuration of steering.

use super::Aircraft;
use crate::error::{Result, in_ranges};

/// How a command is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Policy {
    /// Towards the goal, whatever is in the way.
    None,
    /// As bees do it: away from the side where the flow is faster (M. V. Srinivasan et al., Range perception through
    /// apparent image speed in freely flying honeybees, Visual Neuroscience 6, 1991).
    Balance,
    /// A force away from every obstacle and one towards the goal (O. Khatib, Real-time obstacle avoidance for manipulators
    /// and mobile robots, IJRR 5, 1986).
    Potential,
    /// The cheapest heading (J. Borenstein and Y. Koren, The vector field histogram, IEEE Trans. Robotics and Automation
    /// 7, 1991).
    Heading,
    /// The cheapest of the arcs that the aircraft can fly (after D. Fox, W. Burgard and S. Thrun, The dynamic window
    /// approach to collision avoidance, IEEE Robotics and Automation Magazine 4, 1997).
    #[default]
    Arc,
}

/// What counts as near.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Danger {
    /// Half the positive divergence of the flow on the view sphere: it needs no direction of motion, and is the inverse of
    /// the time to contact straight ahead, but fades to the side and at round things.
    Divergence,
    /// The nearness rate, the inverse of the time to contact along each bearing.
    #[default]
    Nearness,
    /// The larger of the two.
    Blend,
}

/// How the commands of steering come about: what is chosen, and what the aircraft is like. Angles are in radians, times in
/// seconds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SteerConfig {
    /// What is chosen.
    pub params: SteerParams,
    /// What the aircraft is like.
    pub aircraft: Aircraft,
}

/// What is chosen of steering.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct SteerParams {
    /// How a command is found.
    pub policy: Policy,
    /// What counts as near.
    pub danger: Danger,
    /// The steepest bank that is commanded, above 0 and below π/2.
    pub max_bank_rad: f64,
    /// The steepest climb and descent, 0 to π/4.
    pub max_climb_rad: f64,
    /// How far ahead arcs are looked at, above 0 and at most 10.
    pub horizon_s: f64,
    /// How far obstacles are to be passed: half the wing span and a margin, above 0.
    pub radius_m: f64,
    /// Over how many metres around that distance a passage becomes a collision, above 0.
    pub softness_m: f64,
    /// After this time a collision counts less by e, above 0.
    pub discount_s: f64,
    /// Weights of the terms of the cost.
    pub weights: Weights,
    /// Obstacles whose nearness rate is lower are left out, 1/s, above 0.
    pub least_rate_hz: f64,
    /// What a sector must have known to count, 0 to 1.
    pub least_coverage: f64,
    /// How much a new frame counts in the map of danger against what was there, above 0 and at most 1.
    pub smoothing: f64,
    /// For how long what has left the view is remembered, 0 to 10.
    pub memory_s: f64,
    /// Half the angle that an obstacle of the map is wide.
    pub half_width_rad: f64,
    /// Half the width and half the height of the map of danger.
    pub map_half_rad: [f64; 2],
    /// Width and height of its sectors.
    pub map_pitch_rad: [f64; 2],
    /// Climb that is asked for a metre below the wanted altitude, rad/m.
    pub climb_per_m: f64,
    /// What is done without a cue.
    pub on_invalid: OnInvalid,
}

/// Weights of the terms of the cost, all 0 or more.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Weights {
    /// Of the worst passage of an obstacle.
    pub danger: f64,
    /// Of the end's direction off the goal's, 1 − cos.
    pub goal: f64,
    /// Of the change of the commanded bank, rad².
    pub change: f64,
    /// Of the bank itself, rad².
    pub bank: f64,
    /// Of the climb off that which keeps the altitude, rad².
    pub climb: f64,
}

/// What is done without a cue that can be used.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct OnInvalid {
    /// For how long the last command is held.
    pub hold_s: f64,
    /// What is flown then, with the wings level.
    pub climb_rad: f64,
}

impl Default for SteerParams {
    /// For the simulator's airframe of 1.2 kg.
    fn default() -> Self {
        Self {
            policy: Policy::default(),
            danger: Danger::default(),
            max_bank_rad: 60_f64.to_radians(),
            max_climb_rad: 8_f64.to_radians(),
            horizon_s: 2.6,
            radius_m: 1.2,
            softness_m: 0.35,
            discount_s: 2.5,
            weights: Weights { danger: 8.0, goal: 1.0, change: 0.25, bank: 0.05, climb: 12.0 },
            least_rate_hz: 0.25,
            least_coverage: 0.3,
            smoothing: 0.6,
            memory_s: 1.2,
            half_width_rad: 1.5_f64.to_radians(),
            map_half_rad: [58_f64.to_radians(), 28_f64.to_radians()],
            map_pitch_rad: [4_f64.to_radians(), 8_f64.to_radians()],
            climb_per_m: 0.03,
            on_invalid: OnInvalid { hold_s: 0.3, climb_rad: 5_f64.to_radians() },
        }
    }
}

impl From<SteerParams> for SteerConfig {
    /// With the default [`Aircraft`].
    fn from(params: SteerParams) -> Self {
        Self { params, aircraft: Aircraft::default() }
    }
}

impl SteerConfig {
    /// Checks every parameter's range.
    ///
    /// # Errors
    /// As [`SteerParams::validate`] and [`Aircraft::validate`].
    pub fn validate(&self) -> Result<()> {
        self.params.validate()?;
        self.aircraft.validate()
    }
}

impl SteerParams {
    /// Checks every parameter's range.
    ///
    /// # Errors
    /// [`Error::Parameter`], naming the first one that is out of range.
    pub fn validate(&self) -> Result<()> {
        let quarter = std::f64::consts::FRAC_PI_4;
        let Weights { danger, goal, change, bank, climb } = self.weights;
        let OnInvalid { hold_s, climb_rad } = self.on_invalid;
        in_ranges(&[
            ("max_bank_rad", self.max_bank_rad, 1e-3, 1.5),
            ("max_climb_rad", self.max_climb_rad, 0.0, quarter),
            ("horizon_s", self.horizon_s, 0.1, 10.0),
            ("radius_m", self.radius_m, 1e-3, 1e3),
            ("softness_m", self.softness_m, 1e-3, 1e3),
            ("discount_s", self.discount_s, 1e-3, 1e3),
            ("weights.danger", danger, 0.0, 1e6),
            ("weights.goal", goal, 0.0, 1e6),
            ("weights.change", change, 0.0, 1e6),
            ("weights.bank", bank, 0.0, 1e6),
            ("weights.climb", climb, 0.0, 1e6),
            ("least_rate_hz", self.least_rate_hz, 1e-3, 1e3),
            ("least_coverage", self.least_coverage, 0.0, 1.0),
            ("smoothing", self.smoothing, 1e-3, 1.0),
            ("memory_s", self.memory_s, 0.0, 10.0),
            ("half_width_rad", self.half_width_rad, 0.0, quarter),
            ("map_half_rad", self.map_half_rad[0], 0.01, 3.1),
            ("map_half_rad", self.map_half_rad[1], 0.01, 1.5),
            ("map_pitch_rad", self.map_pitch_rad[0], 0.01, 2.0 * self.map_half_rad[0]),
            ("map_pitch_rad", self.map_pitch_rad[1], 0.01, 2.0 * self.map_half_rad[1]),
            ("climb_per_m", self.climb_per_m, 0.0, 10.0),
            ("on_invalid.hold_s", hold_s, 0.0, 60.0),
            ("on_invalid.climb_rad", climb_rad, -quarter, quarter),
        ])
    }

    /// The nearest command that is within the limits.
    pub(super) fn limited(&self, command: super::Command) -> super::Command {
        let clamped = |angle: f64, most: f64| if angle.is_finite() { angle.clamp(-most, most) } else { 0.0 };
        super::Command {
            bank_rad: clamped(command.bank_rad, self.max_bank_rad),
            climb_rad: clamped(command.climb_rad, self.max_climb_rad),
        }
    }
}
