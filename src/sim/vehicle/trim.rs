//! Level flight without acceleration.

use glam::DVec3;

use super::aerodynamics::Inflow;
use super::dynamics::Controls;
use super::params::AirframeParams;
use super::state::positive;
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
    /// [`Error::Parameter`] if the wing cannot carry the weight at that speed, or thrust or elevator do not suffice.
    pub fn trim(&self, speed_m_s: f64) -> Result<Trim> {
        self.validate()?;
        positive("speed_m_s", speed_m_s)?;
        let pressure_n = self.pressure_force_n(speed_m_s);
        // What is missing of the weight when the thrust just meets the drag.
        let missing_n = |attack_rad: f64| {
            let [lift, drag] = self.lift_and_drag(attack_rad);
            self.weight_n() - pressure_n * (lift + drag * attack_rad.tan())
        };
        let degrees = |n: i32| f64::from(n).to_radians();
        let carried = (-30..=30).find(|n| missing_n(degrees(*n)) <= 0.0).filter(|n| *n > -30);
        let Some(above) = carried else {
            let expected = format!(
                "a speed to fly level at within ±30° of attack, stall at {:.2} m/s",
                self.stall_speed_m_s(0.0)
            );
            return Err(Error::parameter("speed_m_s", speed_m_s, expected));
        };
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
        if controls.within(self) != controls {
            let [torque_n_m, thrust_n] = [controls.torque_body_n_m.y, controls.thrust_n];
            let found = format!("{speed_m_s}, which takes {torque_n_m:.2} N m and {thrust_n:.2} N");
            let expected = format!(
                "a speed to fly level at with at most {} N m and {} N",
                self.torque_limit_n_m.y, self.thrust_limit_n
            );
            return Err(Error::parameter("speed_m_s", found, expected));
        }
        Ok(Trim { attack_rad, controls })
    }
}
