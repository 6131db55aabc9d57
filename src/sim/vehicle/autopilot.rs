use glam::{DMat3, DVec3};

use super::aerodynamics::Inflow;
use super::dynamics::Controls;
use super::params::AirframeParams;
use super::state::{GRAVITY_M_S2, positive};
use crate::camera::roll_pitch_yaw_rad;
use crate::error::Result;
use crate::steer::Command;

/// The limit of bank commands, radians: at 75° the wing carries nearly four times the weight.
const STEEPEST_RAD: f64 = 75.0 * std::f64::consts::PI / 180.0;

/// The inner control loop: from bank, climb and airspeed commands to torques and thrust. Each gain is the decay rate
/// of an error, 1/s.
///
/// It knows the airframe, and measures its motion without error. Its torques are updated once per integration step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Autopilot {
    /// Bank error to roll rate.
    pub bank_per_s: f64,
    /// The maximum commanded roll rate, rad/s.
    pub roll_limit_rad_s: f64,
    /// Errors of the three body rates to torques.
    pub rate_per_s: f64,
    /// Climb error to the rate of the path angle.
    pub climb_per_s: f64,
    /// Error of the angle of attack to pitch rate.
    pub attack_per_s: f64,
    /// The maximum commanded angle of attack, radians. Below the stall it prevents stalling, at the cost of wider
    /// turns.
    pub attack_limit_rad: f64,
    /// Sideslip to yaw rate.
    pub sideslip_per_s: f64,
    /// Error of the airspeed to acceleration.
    pub speed_per_s: f64,
}

impl Default for Autopilot {
    /// Gains that reach a bank of 45° in half a second at 12 m/s, and an angle of attack that may stall.
    fn default() -> Self {
        Self {
            bank_per_s: 6.0,
            roll_limit_rad_s: 150_f64.to_radians(),
            rate_per_s: 18.0,
            climb_per_s: 2.5,
            attack_per_s: 6.0,
            attack_limit_rad: 20_f64.to_radians(),
            sideslip_per_s: 2.5,
            speed_per_s: 1.5,
        }
    }
}

/// The inner loop's measurements of the motion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measured {
    pub(super) world_from_body: DMat3,
    pub(super) rate_body_rad_s: DVec3,
    pub(super) air_velocity_body_m_s: DVec3,
    /// The climb rate over ground, m/s, positive upwards.
    pub(super) climb_m_s: f64,
}

impl Autopilot {
    /// Checks every field.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) for the first that is not above 0 and finite.
    pub fn validate(&self) -> Result<()> {
        for (name, value) in [
            ("bank_per_s", self.bank_per_s),
            ("roll_limit_rad_s", self.roll_limit_rad_s),
            ("rate_per_s", self.rate_per_s),
            ("climb_per_s", self.climb_per_s),
            ("attack_per_s", self.attack_per_s),
            ("attack_limit_rad", self.attack_limit_rad),
            ("sideslip_per_s", self.sideslip_per_s),
            ("speed_per_s", self.speed_per_s),
        ] {
            positive(name, value)?;
        }
        Ok(())
    }

    /// Torques and thrust, clamped to the airframe's limits.
    pub(super) fn controls(
        &self,
        params: &AirframeParams,
        now: &Measured,
        command: &Command,
        speed_command_m_s: f64,
    ) -> Controls {
        let inflow = Inflow::new(now.air_velocity_body_m_s);
        // Below 1 m/s nothing flies; the limit avoids division by zero.
        let speed = inflow.speed_m_s.max(1.0);
        let [bank, pitch, _] = roll_pitch_yaw_rad(&now.world_from_body);
        let climb = (now.climb_m_s / speed).clamp(-1.0, 1.0).asin();

        let bank_command = command.bank_rad.clamp(-STEEPEST_RAD, STEEPEST_RAD);
        let roll_rate =
            (self.bank_per_s * (bank_command - bank)).clamp(-self.roll_limit_rad_s, self.roll_limit_rad_s);

        // The acceleration normal to the path that gives the commanded rate and carries the weight, by banked lift.
        let level = speed * self.climb_per_s * (command.climb_rad - climb) + GRAVITY_M_S2 * climb.cos();
        let across_m_s2 = level / bank.cos().max(STEEPEST_RAD.cos());
        let lift = params.mass_kg * across_m_s2 / params.pressure_force_n(speed);
        let attack = ((lift - params.lift_zero) / params.lift_slope())
            .clamp(-self.attack_limit_rad, self.attack_limit_rad);
        // Where the limit caps the lift, the path turns by what remains.
        let lift = params.lift_zero + params.lift_slope() * attack;
        let across_m_s2 = lift * params.pressure_force_n(speed) / params.mass_kg;
        let pitch_rate = self.attack_per_s * (attack - inflow.attack_rad)
            + (across_m_s2 - GRAVITY_M_S2 * climb.cos() * bank.cos()) / speed;

        let yaw_rate =
            GRAVITY_M_S2 * bank.sin() * pitch.cos() / speed + self.sideslip_per_s * inflow.sideslip_rad;

        let rate_command = DVec3::new(roll_rate, pitch_rate, yaw_rate);
        let torque = params.inertia_kg_m2 * self.rate_per_s * (rate_command - now.rate_body_rad_s)
            - params.moment_n_m(&inflow, now.rate_body_rad_s);
        let drag_n = params.pressure_force_n(inflow.speed_m_s) * params.lift_and_drag(inflow.attack_rad)[1];
        let thrust_n = drag_n
            + params.weight_n() * climb.sin()
            + params.mass_kg * self.speed_per_s * (speed_command_m_s - inflow.speed_m_s);
        Controls { torque_body_n_m: torque, thrust_n }.within(params)
    }
}

impl Controls {
    /// Clamped to the airframe's limits.
    pub(super) fn within(&self, params: &AirframeParams) -> Self {
        Self {
            torque_body_n_m: self.torque_body_n_m.clamp(-params.torque_limit_n_m, params.torque_limit_n_m),
            thrust_n: self.thrust_n.clamp(0.0, params.thrust_limit_n),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn the_default_is_legal_and_each_field_is_checked() {
        let good = Autopilot::default();
        good.validate().unwrap();
        let wrong = [
            ("bank_per_s", Autopilot { bank_per_s: 0.0, ..good }),
            ("roll_limit_rad_s", Autopilot { roll_limit_rad_s: -1.0, ..good }),
            ("rate_per_s", Autopilot { rate_per_s: f64::NAN, ..good }),
            ("climb_per_s", Autopilot { climb_per_s: f64::INFINITY, ..good }),
            ("attack_per_s", Autopilot { attack_per_s: 0.0, ..good }),
            ("attack_limit_rad", Autopilot { attack_limit_rad: 0.0, ..good }),
            ("sideslip_per_s", Autopilot { sideslip_per_s: 0.0, ..good }),
            ("speed_per_s", Autopilot { speed_per_s: 0.0, ..good }),
        ];
        for (name, autopilot) in wrong {
            let text = autopilot.validate().unwrap_err().to_string();
            assert!(text.starts_with(name) && !text.contains('\n'), "{text}");
        }
    }
}
