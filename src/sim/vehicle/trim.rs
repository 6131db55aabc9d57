//! Level flight without acceleration.

use glam::DVec3;

use super::aerodynamics::Inflow;
use super::dynamics::Controls;
use super::params::AirframeParams;
use crate::error::{Error, Result};

/// What holds an airframe in straight and level flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trim {
    /// Angle of attack, and pitch, radians.
    pub attack_rad: f64,
    /// What the control surfaces and the propeller do.
    pub controls: Controls,
}

impl AirframeParams {
    /// The level flight at an airspeed, on the near side of the stall: L + T sin α = W, D = T cos α, no moment.
    ///
    /// # Errors
    /// [`Error::Parameter`] with the speeds that are possible if the wing cannot carry the weight at that one, or thrust or
    /// elevator do not suffice.
    pub fn trim(&self, speed_m_s: f64) -> Result<Trim> {
        self.validate()?;
        self.level(speed_m_s).ok_or_else(|| {
            let expected = match self.level_speeds_m_s() {
                // Inwards, so that both ends can be flown.
                Some([low, high]) => {
                    format!(
                        "{} to {} m/s to fly level",
                        (10.0 * low).ceil() / 10.0,
                        (10.0 * high).floor() / 10.0
                    )
                }
                None => "another airframe: there is no speed at which this one can fly level".to_owned(),
            };
            Error::parameter("speed_m_s", speed_m_s, expected)
        })
    }

    /// The lowest and the highest of the airspeeds from 0.1 to 1000 m/s that it can fly level at, m/s; none if it cannot at all.
    pub fn level_speeds_m_s(&self) -> Option<[f64; 2]> {
        // A hundredth apart: nobody flies in a narrower range.
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

    /// The level flight at an airspeed, if there is one.
    fn level(&self, speed_m_s: f64) -> Option<Trim> {
        if !(speed_m_s > 0.0 && speed_m_s.is_finite()) {
            return None;
        }
        let pressure_n = self.pressure_force_n(speed_m_s);
        // What is missing of the weight when the thrust just meets the drag.
        let missing_n = |attack_rad: f64| {
            let [lift, drag] = self.lift_and_drag(attack_rad);
            self.weight_n() - pressure_n * (lift + drag * attack_rad.tan())
        };
        let degrees = |n: i32| f64::from(n).to_radians();
        let above = (-30..=30).find(|n| missing_n(degrees(*n)) <= 0.0).filter(|n| *n > -30)?;
        let [mut low, mut high] = [degrees(above - 1), degrees(above)];
        // Half a degree sixty times halved is below what f64 tells apart.
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
