//! Trim: steady level flight.

use glam::DVec3;

use super::aerodynamics::Inflow;
use super::dynamics::Controls;
use super::params::AirframeParams;
use crate::error::{Error, Result};

/// The trim of an airframe in straight and level flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trim {
    /// Angle of attack, and pitch, radians.
    pub attack_rad: f64,
    /// Torques and thrust.
    pub controls: Controls,
}

impl AirframeParams {
    /// The trim at an airspeed, below the stall: L + T sin α = W, D = T cos α, no moment.
    ///
    /// # Errors
    /// [`Error::Parameter`] with the possible speeds if the wing cannot carry the weight at this one, or thrust or
    /// elevator do not suffice.
    pub fn trim(&self, speed_m_s: f64) -> Result<Trim> {
        self.validate()?;
        self.level(speed_m_s).ok_or_else(|| {
            let expected = match self.level_speeds_m_s() {
                // Rounded inwards, so that both ends can be flown.
                Some([low, high]) => {
                    format!(
                        "{} to {} m/s to fly level",
                        (10.0 * low).ceil() / 10.0,
                        (10.0 * high).floor() / 10.0
                    )
                }
                None => "another airframe: this one cannot fly level at any speed".to_owned(),
            };
            Error::parameter("speed_m_s", speed_m_s, expected)
        })
    }

    /// The lowest and the highest airspeed from 0.1 to 1000 m/s at which it can fly level, m/s; `None` if it cannot
    /// at all.
    pub fn level_speeds_m_s(&self) -> Option<[f64; 2]> {
        // 1 % apart: narrower ranges do not matter.
        const RATIO: f64 = 1.01;
        let levels = |speed_m_s: f64| self.level(speed_m_s).is_some();
        let mut speeds = (0..=925).map(|n| 0.1 * RATIO.powi(n)).filter(|speed_m_s| levels(*speed_m_s));
        let first = speeds.next()?;
        let last = speeds.next_back().unwrap_or(first);
        let edge = |mut inside: f64, mut outside: f64| {
            for _ in 0..40 {
                let middle = (inside + outside) / 2.0;
                if levels(middle) { inside = middle } else { outside = middle }
            }
            inside
        };
        Some([edge(first, first / RATIO), edge(last, last * RATIO)])
    }

    /// The trim at an airspeed, if there is one.
    fn level(&self, speed_m_s: f64) -> Option<Trim> {
        if !(speed_m_s > 0.0 && speed_m_s.is_finite()) {
            return None;
        }
        let pressure_n = self.pressure_force_n(speed_m_s);
        // The part of the weight not carried when the thrust just meets the drag.
        let missing_n = |attack_rad: f64| {
            let [lift, drag] = self.lift_and_drag(attack_rad);
            self.weight_n() - pressure_n * (lift + drag * attack_rad.tan())
        };
        let degrees = |n: i32| f64::from(n).to_radians();
        let above = (-30..=30).find(|n| missing_n(degrees(*n)) <= 0.0).filter(|n| *n > -30)?;
        let [mut low, mut high] = [degrees(above - 1), degrees(above)];
        // Half a degree, halved sixty times, is below the resolution of f64.
        for _ in 0..60 {
            let middle = (low + high) / 2.0;
            if missing_n(middle) > 0.0 { low = middle } else { high = middle }
        }
        let attack_rad = (low + high) / 2.0;
        let inflow = Inflow { speed_m_s, attack_rad, sideslip_rad: 0.0 };
        let controls = Controls {
            torque_body_n_m: -self.moment_n_m(&inflow, DVec3::ZERO),
            thrust_n: pressure_n * self.lift_and_drag(attack_rad)[1] / attack_rad.cos(),
        };
        (controls.within(self) == controls).then_some(Trim { attack_rad, controls })
    }
}
