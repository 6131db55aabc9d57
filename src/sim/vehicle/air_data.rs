//! Air data sensors: airspeed, vertical speed and vanes.

use glam::DVec3;

use super::aerodynamics::Inflow;
use super::state::{VehicleState, not_negative};
use super::stream::Stream;
use crate::error::{Error, Result};
use crate::sim::Random;

/// An airspeed sensor with a scale error that is constant for a whole flight.
#[derive(Clone, Debug)]
pub struct AirspeedModel {
    scale: f64,
}

impl AirspeedModel {
    /// The usual error for [`AirspeedModel::new`]: that of a pitot tube calibrated once.
    pub const USUAL: f64 = 0.03;

    /// A sensor whose scale error is uniform in −`error` to `error`, a share of the airspeed below 1.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a share that is not 0 or above and below 1.
    pub fn new(error: f64, seed: u64) -> Result<Self> {
        if !(0.0..1.0).contains(&error) {
            return Err(Error::parameter("error", error, "0 or above, and below 1"));
        }
        Ok(Self { scale: 1.0 + Stream::Airspeed.of(seed).within([-error, error]) })
    }

    /// The reading, m/s.
    pub fn speed_m_s(&self, state: &VehicleState) -> f64 {
        self.scale * state.air_velocity_body_m_s.length()
    }
}

/// The errors of a vertical speed: standard deviations, m/s, 0 or above.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct VerticalSpeedErrors {
    /// The offset: constant for a whole flight.
    pub fixed_m_s: f64,
    /// The noise: drawn anew for each reading.
    pub jitter_m_s: f64,
}

impl Default for VerticalSpeedErrors {
    /// 0.05 and 0.1 m/s: an autopilot's estimate from a barometer and an accelerometer. More of an offset would be metres
    /// of altitude within a minute.
    fn default() -> Self {
        Self { fixed_m_s: 0.05, jitter_m_s: 0.1 }
    }
}

/// The vertical speed as an autopilot estimates it.
#[derive(Clone, Debug)]
pub struct VerticalSpeedModel {
    fixed_m_s: f64,
    jitter_m_s: f64,
    random: Random,
}

impl VerticalSpeedModel {
    /// The same seed gives the same errors.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a deviation that is negative or not finite.
    pub fn new(errors: &VerticalSpeedErrors, seed: u64) -> Result<Self> {
        not_negative("fixed_m_s", errors.fixed_m_s)?;
        not_negative("jitter_m_s", errors.jitter_m_s)?;
        let mut random = Stream::VerticalSpeed.of(seed);
        Ok(Self { fixed_m_s: errors.fixed_m_s * random.normal(), jitter_m_s: errors.jitter_m_s, random })
    }

    /// The reading, m/s, positive upwards.
    pub fn up_m_s(&mut self, state: &VehicleState) -> f64 {
        self.fixed_m_s + self.jitter_m_s * self.random.normal() - state.velocity_ned_m_s.z
    }
}

/// The errors of a pair of vanes: standard deviations per vane, in radians, 0 or above.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct VaneErrors {
    /// The mounting error: constant for a whole flight.
    pub fixed_rad: f64,
    /// The flutter: drawn anew for each reading.
    pub jitter_rad: f64,
}

impl Default for VaneErrors {
    /// 1.4° of mounting error, which is 2° for the direction, and 0.3° of flutter.
    fn default() -> Self {
        Self { fixed_rad: 1.4_f64.to_radians(), jitter_rad: 0.3_f64.to_radians() }
    }
}

impl VaneErrors {
    /// Vanes without errors.
    pub const NONE: Self = Self { fixed_rad: 0.0, jitter_rad: 0.0 };
}

/// A pair of vanes that measure the direction of motion relative to the air: in calm air that over ground, in wind
/// with the wind's part.
#[derive(Clone, Debug)]
pub struct VaneModel {
    fixed_rad: [f64; 2],
    jitter_rad: f64,
    random: Random,
}

impl VaneModel {
    /// Vanes for the angle of attack and the sideslip. The same seed gives the same errors.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a deviation that is negative or not finite.
    pub fn new(errors: &VaneErrors, seed: u64) -> Result<Self> {
        not_negative("fixed_rad", errors.fixed_rad)?;
        not_negative("jitter_rad", errors.jitter_rad)?;
        let mut random = Stream::Vanes.of(seed);
        let fixed_rad = std::array::from_fn(|_| errors.fixed_rad * random.normal());
        Ok(Self { fixed_rad, jitter_rad: errors.jitter_rad, random })
    }

    /// The measured direction of motion: a unit vector, FRD.
    pub fn direction_body(&mut self, state: &VehicleState) -> DVec3 {
        let inflow = Inflow::new(state.air_velocity_body_m_s);
        let [attack, sideslip] = [inflow.attack_rad, inflow.sideslip_rad];
        let [attack, sideslip] = [(attack, 0), (sideslip, 1)]
            .map(|(angle, vane)| angle + self.fixed_rad[vane] + self.jitter_rad * self.random.normal());
        DVec3::new(attack.cos() * sideslip.cos(), sideslip.sin(), attack.sin() * sideslip.cos())
    }
}
