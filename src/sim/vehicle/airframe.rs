use glam::{DQuat, DVec3};

use super::autopilot::{Autopilot, Measured};
use super::dynamics::{Body, Controls};
use super::params::AirframeParams;
use super::state::{Start, Vehicle, VehicleState, bounded, positive, sound};
use super::wind::Wind;
use crate::camera::world_from_body;
use crate::error::Result;
use crate::steer::Command;

/// A fixed-wing aircraft as a rigid body, flown by an inner control loop.
///
/// The aerodynamic model is that of Beard & McLain, *Small Unmanned Aircraft* (2012), chapter 4: lift with a stall,
/// drag with an induced part, side force, and moments with damping; control surfaces exert a torque that does not
/// depend on the airspeed. The equations of motion are integrated by the fourth-order Runge–Kutta method in `f64`,
/// with controls and wind held over a step.
#[derive(Clone, Debug)]
pub struct Airframe {
    params: AirframeParams,
    autopilot: Autopilot,
    speed_command_m_s: f64,
    wind: Wind,
    time_s: f64,
    body: Body,
}

impl Airframe {
    /// An airframe in trimmed level flight relative to the air.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) for parameters out of range and for a speed at which it cannot fly
    /// level.
    pub fn new(params: &AirframeParams, autopilot: &Autopilot, start: &Start, wind: Wind) -> Result<Self> {
        autopilot.validate()?;
        start.validate()?;
        let trim = params.trim(start.speed_m_s)?;
        let rotation = world_from_body(0.0, trim.attack_rad, start.yaw_rad);
        let forward = world_from_body(0.0, 0.0, start.yaw_rad).x_axis;
        let body = Body {
            position_ned_m: start.position_ned_m,
            velocity_ned_m_s: forward * start.speed_m_s + wind.ned_m_s(),
            world_from_body: DQuat::from_mat3(&rotation),
            rate_body_rad_s: DVec3::ZERO,
        };
        let speed_command_m_s = start.speed_m_s;
        Ok(Self { params: *params, autopilot: *autopilot, speed_command_m_s, wind, time_s: 0.0, body })
    }

    /// The airframe's parameters.
    pub fn params(&self) -> &AirframeParams {
        &self.params
    }

    /// Sets the commanded airspeed, m/s.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) for one that is not above 0 and finite.
    pub fn set_speed_m_s(&mut self, speed_m_s: f64) -> Result<()> {
        positive("speed_m_s", speed_m_s)?;
        self.speed_command_m_s = speed_m_s;
        Ok(())
    }

    /// The controls that the inner loop commands now.
    pub fn controls(&self, command: &Command) -> Controls {
        let now = Measured {
            world_from_body: self.body.rotation(),
            rate_body_rad_s: self.body.rate_body_rad_s,
            air_velocity_body_m_s: self.body.air_velocity_body_m_s(self.wind.ned_m_s()),
            climb_m_s: -self.body.velocity_ned_m_s.z,
        };
        self.autopilot.controls(&self.params, &now, &sound(command), self.speed_command_m_s)
    }

    /// Advances by one step with the given controls, clamped to the airframe's limits. Values that are not finite
    /// count as 0. The step is as in [`Vehicle::advance`].
    pub fn advance_held(&mut self, controls: &Controls, step_s: f64) {
        let Some(step_s) = bounded(step_s) else { return };
        let finite = controls.torque_body_n_m.is_finite() && controls.thrust_n.is_finite();
        let controls = if finite { controls.within(&self.params) } else { Controls::default() };
        let wind = self.wind.ned_m_s();
        let flown_m = self.body.air_velocity_body_m_s(wind).length() * step_s;
        self.body.advance(&self.params, &controls, wind, step_s);
        self.wind.advance(flown_m);
        self.time_s += step_s;
    }
}

impl Vehicle for Airframe {
    fn state(&self) -> VehicleState {
        VehicleState {
            time_s: self.time_s,
            position_ned_m: self.body.position_ned_m,
            velocity_ned_m_s: self.body.velocity_ned_m_s,
            world_from_body: self.body.rotation(),
            rate_body_rad_s: self.body.rate_body_rad_s,
            air_velocity_body_m_s: self.body.air_velocity_body_m_s(self.wind.ned_m_s()),
        }
    }

    fn advance(&mut self, command: &Command, step_s: f64) {
        self.advance_held(&self.controls(command), step_s);
    }
}
