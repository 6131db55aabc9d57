//! Configuration of steering.

use super::Aircraft;
use crate::error::Result;

/// How a command is chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Policy {
    /// Towards the goal, ignoring obstacles.
    None,
    /// As bees do it: away from the side where the flow is faster (M. V. Srinivasan et al., Range perception through
    /// apparent image speed in freely flying honeybees, Visual Neuroscience 6, 1991).
    Balance,
    /// A repulsive force from every obstacle and an attractive one to the goal (O. Khatib, Real-time obstacle
    /// avoidance for manipulators and mobile robots, IJRR 5, 1986).
    Potential,
    /// The cheapest heading (J. Borenstein and Y. Koren, The vector field histogram, IEEE Trans. Robotics and
    /// Automation 7, 1991).
    Heading,
    /// The cheapest of the arcs that the aircraft can fly (after D. Fox, W. Burgard and S. Thrun, The dynamic window
    /// approach to collision avoidance, IEEE Robotics and Automation Magazine 4, 1997).
    #[default]
    Arc,
}

/// The measure of danger.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Danger {
    /// Half the positive divergence of the flow on the view sphere. It needs no direction of motion, and equals the
    /// inverse of the time to contact straight ahead, but decreases to the side and at round objects.
    Divergence,
    /// The nearness rate, the inverse of the time to contact along each bearing.
    #[default]
    Nearness,
    /// The larger of the two.
    Blend,
}

/// What obstacles are read from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Reading {
    /// Each sector of the danger map by itself.
    Sectors,
    /// Each column of the danger map as a whole: narrow things stand upright and fill it, wide ones reach from their
    /// top to their foot.
    #[default]
    Columns,
}

/// The configuration of steering: its parameters, and the aircraft. Angles are in radians, times in seconds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SteerConfig {
    /// The steering parameters.
    pub params: SteerParams,
    /// The aircraft to steer.
    pub aircraft: Aircraft,
}

/// The parameters of steering.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct SteerParams {
    /// How a command is chosen.
    pub policy: Policy,
    /// The measure of danger.
    pub danger: Danger,
    /// What obstacles are read from.
    pub reading: Reading,
    /// The widest thing that [`Reading::Columns`] takes for an upright post, in metres, 0 or more.
    pub post_m: f64,
    /// What an obstacle's distance, the airspeed over the nearness rate, is multiplied by, above 0 and at most 2. Below
    /// 1, as the flow of a thin thing is mixed with that of what is behind it, and shows it too far away.
    pub distance_scale: f64,
    /// The steepest bank that is commanded, above 0 and below π/2.
    pub max_bank_rad: f64,
    /// The steepest commanded climb and descent angle, 0 to π/4.
    pub max_climb_rad: f64,
    /// The time over which arcs are predicted, above 0 and at most 10.
    pub horizon_s: f64,
    /// The clearance at which obstacles should be passed: half the wing span and a margin, above 0.
    pub radius_m: f64,
    /// The width of the transition around that clearance over which a passage becomes a collision, above 0.
    pub softness_m: f64,
    /// The time constant of the discount: a collision after this time counts 1/e of an immediate one, above 0.
    pub discount_s: f64,
    /// The weights of the cost's terms.
    pub weights: Weights,
    /// The lowest nearness rate at which an obstacle counts, 1/s, above 0.
    pub least_rate_hz: f64,
    /// The least coverage at which a sector counts, 0 to 1.
    pub least_coverage: f64,
    /// The weight of a new frame against the old value in the map of danger, above 0 and at most 1.
    pub smoothing: f64,
    /// How long obstacles are remembered that left the view or whose sector became unknown, 0 to 10.
    pub memory_s: f64,
    /// The angular half width of an obstacle in the map.
    pub half_width_rad: f64,
    /// Half the width and half the height of the map of danger, `[azimuth, elevation]`.
    pub map_half_rad: [f64; 2],
    /// The width and height of the map's sectors, `[azimuth, elevation]`.
    pub map_pitch_rad: [f64; 2],
    /// The climb angle commanded per metre below the goal's altitude, rad/m.
    pub climb_per_m: f64,
    /// What is flown without a valid cue.
    pub on_invalid: OnInvalid,
}

/// The weights of the cost's terms, all 0 or more.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Weights {
    /// Of the closest passage of an obstacle.
    pub danger: f64,
    /// Of the final direction's deviation from the goal's, 1 − cos.
    pub goal: f64,
    /// Of the change of the commanded bank angle, rad².
    pub change: f64,
    /// Of the bank angle itself, rad².
    pub bank: f64,
    /// Of the climb angle's deviation from the one that holds the altitude, rad².
    pub climb: f64,
}

/// What is flown without a valid cue.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct OnInvalid {
    /// How long the last command is held.
    pub hold_s: f64,
    /// The climb angle flown after that, with level wings.
    pub climb_rad: f64,
}

impl Default for SteerParams {
    /// For the simulator's airframe of 1.2 kg.
    fn default() -> Self {
        Self {
            policy: Policy::default(),
            danger: Danger::default(),
            reading: Reading::default(),
            post_m: 1.5,
            distance_scale: 0.9,
            max_bank_rad: 60_f64.to_radians(),
            max_climb_rad: 8_f64.to_radians(),
            horizon_s: 2.6,
            radius_m: 1.2,
            softness_m: 0.35,
            discount_s: 1.2,
            weights: Weights { danger: 8.0, goal: 1.0, change: 0.25, bank: 0.05, climb: 12.0 },
            least_rate_hz: 0.5,
            least_coverage: 0.3,
            smoothing: 0.6,
            memory_s: 1.2,
            half_width_rad: 0.7_f64.to_radians(),
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
    /// The command clamped to the limits.
    pub(super) fn limited(&self, command: super::Command) -> super::Command {
        let clamped = |angle: f64, most: f64| if angle.is_finite() { angle.clamp(-most, most) } else { 0.0 };
        super::Command {
            bank_rad: clamped(command.bank_rad, self.max_bank_rad),
            climb_rad: clamped(command.climb_rad, self.max_climb_rad),
        }
    }
}
