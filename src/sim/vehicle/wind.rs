use glam::DVec3;

use super::state::{not_negative, positive};
use super::stream::{Stream, normal};
use crate::error::{Error, Result};
use crate::sim::Random;

/// Gusts on top of a steady wind: how strong, and over what length they change.
///
/// Each axis is noise of the first order, e^(−d/L) alike over a flown distance d: Dryden's spectrum along the flight in
/// MIL-F-8785C (1980), σ² 2L/π / (1 + (LΩ)²), taken across and down too, where Dryden's is of the second order. Gusts are
/// the same over the whole span: they push, and do not turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gusts {
    /// Standard deviation north, east and down, m/s, each 0 or above.
    pub intensity_m_s: DVec3,
    /// Length scale of each, metres, above 0.
    pub length_m: DVec3,
}

impl Gusts {
    /// Light turbulence at a height of 50 m, the lowest of table 4.1 of Beard & McLain, *Small Unmanned Aircraft* (2012).
    pub const LIGHT: Self =
        Self { intensity_m_s: DVec3::new(1.06, 1.06, 0.7), length_m: DVec3::new(200.0, 200.0, 50.0) };
    /// Moderate turbulence at a height of 50 m, from the same table.
    pub const MODERATE: Self = Self { intensity_m_s: DVec3::new(2.12, 2.12, 1.4), ..Self::LIGHT };

    fn validate(&self) -> Result<()> {
        for axis in self.intensity_m_s.to_array() {
            not_negative("intensity_m_s", axis)?;
        }
        self.length_m.to_array().into_iter().try_for_each(|axis| positive("length_m", axis))
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
    /// A wind from the first gust on, which is drawn like all others. The steady part says where the air moves **to**,
    /// m/s NED: a wind from the north is −x.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a wind that is not finite, a negative intensity, a length that is not above 0.
    pub fn new(steady_ned_m_s: DVec3, gusts: Option<Gusts>, seed: u64) -> Result<Self> {
        if !steady_ned_m_s.is_finite() {
            return Err(Error::parameter("steady_ned_m_s", steady_ned_m_s, "three finite speeds"));
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

    /// Where the air moves to now, m/s NED.
    pub fn ned_m_s(&self) -> DVec3 {
        self.steady_ned_m_s + self.gust_ned_m_s
    }

    /// Goes on to the gust after a flown distance in the air, metres. The step is exact for any distance.
    pub fn advance(&mut self, distance_m: f64) {
        let Some(gusts) = &self.gusts else { return };
        let kept = (DVec3::splat(-distance_m.max(0.0)) / gusts.length_m).exp();
        let fresh = (DVec3::ONE - kept * kept).map(f64::sqrt);
        self.gust_ned_m_s = kept * self.gust_ned_m_s + gusts.intensity_m_s * fresh * normal(&mut self.random);
    }
}
