use std::f64::consts::FRAC_PI_2;

use glam::{DMat3, DVec3};

use super::state::{GRAVITY_M_S2, Start, Vehicle, VehicleState, bounded, positive, sound};
use super::wind::Wind;
use crate::camera::world_from_body;
use crate::error::{Error, Result};
use crate::steer::Command;

/// The limit of bank and climb, radians: at 90° a level turn would need infinite lift.
const STEEPEST_RAD: f64 = 80.0 * std::f64::consts::PI / 180.0;

/// The response of a [`CoordinatedTurn`] to its commands.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct TurnParams {
    /// Time constant of the bank, seconds, above 0.
    pub bank_lag_s: f64,
    /// Largest rate of the bank, rad/s, above 0.
    pub bank_rate_rad_s: f64,
    /// Time constant of the climb, seconds, above 0.
    pub climb_lag_s: f64,
    /// Constant angle of attack, radians, within ±90°.
    pub attack_rad: f64,
}

impl Default for TurnParams {
    /// 0.2 s and 150 °/s for the bank, 0.4 s for the climb, the nose along the flight path.
    fn default() -> Self {
        Self { bank_lag_s: 0.2, bank_rate_rad_s: 150_f64.to_radians(), climb_lag_s: 0.4, attack_rad: 0.0 }
    }
}

impl TurnParams {
    /// Checks every field.
    ///
    /// # Errors
    /// [`Error::Parameter`] for the first that is out of range.
    pub fn validate(&self) -> Result<()> {
        positive("bank_lag_s", self.bank_lag_s)?;
        positive("bank_rate_rad_s", self.bank_rate_rad_s)?;
        positive("climb_lag_s", self.climb_lag_s)?;
        if !(self.attack_rad.abs() < FRAC_PI_2) {
            return Err(Error::parameter("attack_rad", self.attack_rad, "between -π/2 and π/2"));
        }
        Ok(())
    }
}

/// A point that flies coordinated turns: ψ̇ = g tan φ / V at a constant airspeed, with the bank φ and the climb γ
/// lagging behind their commands. A banked wing whose lift carries its weight along a straight or climbing path turns
/// at just that rate, whatever γ is.
///
/// Relative to the air there is no sideslip, and the angle of attack is constant, about the body's y axis; if it is 0
/// the pitch equals the climb. Wind adds to the velocity over ground, and a vertical wind lifts the vehicle.
///
/// The rates of bank and climb are linear over a step, even where a command jumps: a gyro sampled at the steps and
/// integrated by [`imu::Gyro`](crate::imu::Gyro) reproduces the rotation.
#[derive(Clone, Debug)]
pub struct CoordinatedTurn {
    params: TurnParams,
    speed_m_s: f64,
    wind: Wind,
    time_s: f64,
    position_ned_m: DVec3,
    yaw_rad: f64,
    bank: Lag,
    climb: Lag,
}

impl CoordinatedTurn {
    /// A vehicle in level flight.
    ///
    /// # Errors
    /// [`Error::Parameter`] as in [`TurnParams::validate`] and [`Start::validate`].
    pub fn new(params: &TurnParams, start: &Start, wind: Wind) -> Result<Self> {
        params.validate()?;
        start.validate()?;
        Ok(Self {
            params: *params,
            speed_m_s: start.speed_m_s,
            wind,
            time_s: 0.0,
            position_ned_m: start.position_ned_m,
            yaw_rad: start.yaw_rad,
            bank: Lag::default(),
            climb: Lag::default(),
        })
    }

    fn yaw_rate_rad_s(&self, bank_rad: f64) -> f64 {
        GRAVITY_M_S2 * bank_rad.tan() / self.speed_m_s
    }
}

impl Vehicle for CoordinatedTurn {
    fn state(&self) -> VehicleState {
        let flight = world_from_body(self.bank.angle_rad, self.climb.angle_rad, self.yaw_rad);
        let flight_from_body = DMat3::from_rotation_y(self.params.attack_rad);
        let yaw_rate = self.yaw_rate_rad_s(self.bank.angle_rad);
        // The world's z axis in the banked frame; climb rotates about the axis that is not banked.
        let down = flight.transpose() * DVec3::Z;
        let (sin, cos) = self.bank.angle_rad.sin_cos();
        let rate = DVec3::X * self.bank.rate_rad_s
            + DVec3::new(0.0, cos, -sin) * self.climb.rate_rad_s
            + down * yaw_rate;
        VehicleState {
            time_s: self.time_s,
            position_ned_m: self.position_ned_m,
            velocity_ned_m_s: flight.x_axis * self.speed_m_s + self.wind.ned_m_s(),
            world_from_body: flight * flight_from_body,
            rate_body_rad_s: flight_from_body.transpose() * rate,
            air_velocity_body_m_s: flight_from_body.transpose() * (DVec3::X * self.speed_m_s),
        }
    }

    fn advance(&mut self, command: &Command, step_s: f64) {
        let Some(step_s) = bounded(step_s) else { return };
        let Command { bank_rad, climb_rad } = sound(command);
        let TurnParams { bank_lag_s, bank_rate_rad_s, climb_lag_s, .. } = self.params;
        let (bank, climb) = (self.bank, self.climb);
        self.bank.follow(bank_rad, bank_lag_s, bank_rate_rad_s, step_s);
        self.climb.follow(climb_rad, climb_lag_s, f64::INFINITY, step_s);
        // The turn rate as a parabola over the step, integrated to its middle and to its end; the path by Simpson's
        // rule.
        let [a, b, c] =
            [0.0, 0.5, 1.0].map(|part| self.yaw_rate_rad_s(bank.toward(&self.bank, step_s, part)) * step_s);
        let start_rad = self.yaw_rad;
        let half_rad = start_rad + (5.0 * a + 8.0 * b - c) / 24.0;
        self.yaw_rad = start_rad + (a + 4.0 * b + c) / 6.0;
        let yaw_rad = [start_rad, half_rad, self.yaw_rad];
        let path = [0.0, 0.5, 1.0].map(|part| climb.toward(&self.climb, step_s, part));
        let direction: [DVec3; 3] = std::array::from_fn(|i| world_from_body(0.0, path[i], yaw_rad[i]).x_axis);
        let mean = (direction[0] + 4.0 * direction[1] + direction[2]) / 6.0;
        self.position_ned_m += (mean * self.speed_m_s + self.wind.ned_m_s()) * step_s;
        self.wind.advance(self.speed_m_s * step_s);
        self.time_s += step_s;
    }
}

/// An angle that follows a command with a first-order lag.
#[derive(Clone, Copy, Debug, Default)]
struct Lag {
    angle_rad: f64,
    rate_rad_s: f64,
}

impl Lag {
    /// The implicit trapezoidal rule: the rate is linear from the previous one to the one that the command requires
    /// at the end of the step.
    fn follow(&mut self, command_rad: f64, lag_s: f64, limit_rad_s: f64, step_s: f64) {
        let off_rad = command_rad.clamp(-STEEPEST_RAD, STEEPEST_RAD) - self.angle_rad;
        let rate = (off_rad - self.rate_rad_s * step_s / 2.0) / (lag_s + step_s / 2.0);
        let rate = rate.clamp(-limit_rad_s, limit_rad_s);
        self.angle_rad += (self.rate_rad_s + rate) * step_s / 2.0;
        self.rate_rad_s = rate;
    }

    /// The angle at a fraction of the step towards `after`.
    fn toward(&self, after: &Self, step_s: f64, part: f64) -> f64 {
        self.angle_rad + (self.rate_rad_s + (after.rate_rad_s - self.rate_rad_s) * part / 2.0) * part * step_s
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn the_default_is_legal_and_each_field_is_checked() {
        let good = TurnParams::default();
        good.validate().unwrap();
        let wrong = [
            ("bank_lag_s", TurnParams { bank_lag_s: 0.0, ..good }),
            ("bank_rate_rad_s", TurnParams { bank_rate_rad_s: f64::NAN, ..good }),
            ("climb_lag_s", TurnParams { climb_lag_s: f64::INFINITY, ..good }),
            ("attack_rad", TurnParams { attack_rad: 2.0, ..good }),
            ("attack_rad", TurnParams { attack_rad: f64::NAN, ..good }),
        ];
        for (name, params) in wrong {
            let text = params.validate().unwrap_err().to_string();
            assert!(text.starts_with(name) && !text.contains('\n'), "{text}");
        }
    }
}
