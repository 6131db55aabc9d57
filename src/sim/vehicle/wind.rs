use glam::DVec3;

use super::state::within;
use super::stream::{Stream, normal};
use crate::error::Result;
use crate::sim::Random;

/// The strongest wind along an axis, steady or as a gust's standard deviation, m/s: above a hurricane's.
pub const MAX_WIND_M_S: f64 = 100.0;

/// Gusts on top of a steady wind: their strength, and the length over which they change.
///
/// Each axis is first-order noise with the correlation e^(−d/L) over a flown distance d: Dryden's spectrum along the
/// flight in MIL-F-8785C (1980), σ² 2L/π / (1 + (LΩ)²), used across and down too, where Dryden's is of the second
/// order. Gusts are uniform over the span: they exert forces and no moments.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Gusts {
    /// Standard deviation north, east and down, m/s, each 0 to [`MAX_WIND_M_S`].
    pub intensity_m_s: DVec3,
    /// Length scale of each, metres, 0.001 to 1e6.
    pub length_m: DVec3,
}

impl Gusts {
    /// Light turbulence at an altitude of 50 m, the lowest of table 4.1 of Beard & McLain, *Small Unmanned Aircraft*
    /// (2012).
    pub const LIGHT: Self =
        Self { intensity_m_s: DVec3::new(1.06, 1.06, 0.7), length_m: DVec3::new(200.0, 200.0, 50.0) };
    /// Moderate turbulence at an altitude of 50 m, from the same table.
    pub const MODERATE: Self = Self { intensity_m_s: DVec3::new(2.12, 2.12, 1.4), ..Self::LIGHT };

    fn validate(&self) -> Result<()> {
        for axis in self.intensity_m_s.to_array() {
            within("intensity_m_s", axis, 0.0, MAX_WIND_M_S)?;
        }
        self.length_m.to_array().into_iter().try_for_each(|axis| within("length_m", axis, 1e-3, 1e6))
    }
}

/// The motion of the air: a steady wind, and gusts if there are any. The same seed gives the same gusts.
#[derive(Clone, Debug)]
pub struct Wind {
    steady_ned_m_s: DVec3,
    gusts: Option<Gusts>,
    gust_ned_m_s: DVec3,
    random: Random,
}

impl Wind {
    /// A wind with its first gust drawn like all others. The steady part is the air's velocity, where it moves
    /// **to**, m/s NED, each axis within ±[`MAX_WIND_M_S`]: a wind from the north is −x.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) for values out of range.
    pub fn new(steady_ned_m_s: DVec3, gusts: Option<Gusts>, seed: u64) -> Result<Self> {
        for axis in steady_ned_m_s.to_array() {
            within("steady_ned_m_s", axis, -MAX_WIND_M_S, MAX_WIND_M_S)?;
        }
        let mut random = Stream::Gusts.of(seed);
        let mut gust_ned_m_s = DVec3::ZERO;
        if let Some(gusts) = &gusts {
            gusts.validate()?;
            gust_ned_m_s = gusts.intensity_m_s * normal(&mut random);
        }
        Ok(Self { steady_ned_m_s, gusts, gust_ned_m_s, random })
    }

    /// Air at rest.
    pub fn calm() -> Self {
        Self { steady_ned_m_s: DVec3::ZERO, gusts: None, gust_ned_m_s: DVec3::ZERO, random: Random::new(0) }
    }

    /// The air's velocity now, m/s NED.
    pub fn ned_m_s(&self) -> DVec3 {
        self.steady_ned_m_s + self.gust_ned_m_s
    }

    /// Advances the gusts by a distance flown through the air, metres. Exact for any distance.
    pub fn advance(&mut self, distance_m: f64) {
        let Some(gusts) = &self.gusts else { return };
        let kept = (DVec3::splat(-distance_m.max(0.0)) / gusts.length_m).exp();
        let fresh = (DVec3::ONE - kept * kept).map(f64::sqrt);
        self.gust_ned_m_s = kept * self.gust_ned_m_s + gusts.intensity_m_s * fresh * normal(&mut self.random);
    }
}
