//! The motion of a rigid body.

use glam::{DMat3, DQuat, DVec3};

use super::aerodynamics::Inflow;
use super::params::AirframeParams;
use super::state::GRAVITY_M_S2;

/// Forces and torques on the body beside those of air and weight.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Controls {
    /// Torques of aileron, elevator and rudder, N m FRD: right wing down, nose up, nose right.
    pub torque_body_n_m: DVec3,
    /// Thrust along the nose, N.
    pub thrust_n: f64,
}

/// The state of a body's motion, or its time derivative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Body {
    pub(super) position_ned_m: DVec3,
    pub(super) velocity_ned_m_s: DVec3,
    pub(super) world_from_body: DQuat,
    pub(super) rate_body_rad_s: DVec3,
}

impl Body {
    pub(super) fn air_velocity_body_m_s(&self, wind_ned_m_s: DVec3) -> DVec3 {
        self.world_from_body.conjugate() * (self.velocity_ned_m_s - wind_ned_m_s)
    }

    /// The state after a time at a constant rate of change.
    fn moved(&self, rate: &Self, time_s: f64) -> Self {
        Self {
            position_ned_m: self.position_ned_m + rate.position_ned_m * time_s,
            velocity_ned_m_s: self.velocity_ned_m_s + rate.velocity_ned_m_s * time_s,
            world_from_body: self.world_from_body + rate.world_from_body * time_s,
            rate_body_rad_s: self.rate_body_rad_s + rate.rate_body_rad_s * time_s,
        }
    }

    /// The rate of change, by Newton's and Euler's equations.
    fn change(&self, params: &AirframeParams, controls: &Controls, wind_ned_m_s: DVec3) -> Self {
        let rate = self.rate_body_rad_s;
        let inflow = Inflow::new(self.air_velocity_body_m_s(wind_ned_m_s));
        let force = params.force_n(&inflow) + DVec3::X * controls.thrust_n;
        let moment = params.moment_n_m(&inflow, rate) + controls.torque_body_n_m;
        let inertia = params.inertia_kg_m2;
        let spin = DQuat::from_xyzw(rate.x, rate.y, rate.z, 0.0);
        Self {
            position_ned_m: self.velocity_ned_m_s,
            velocity_ned_m_s: self.world_from_body * force / params.mass_kg + DVec3::Z * GRAVITY_M_S2,
            world_from_body: self.world_from_body * spin * 0.5,
            rate_body_rad_s: (moment - rate.cross(inertia * rate)) / inertia,
        }
    }

    /// One step of the classical Runge–Kutta method, with controls and wind held.
    pub(super) fn advance(
        &mut self,
        params: &AirframeParams,
        controls: &Controls,
        wind_ned_m_s: DVec3,
        step_s: f64,
    ) {
        let change = |body: &Self| body.change(params, controls, wind_ned_m_s);
        let a = change(self);
        let b = change(&self.moved(&a, step_s / 2.0));
        let c = change(&self.moved(&b, step_s / 2.0));
        let d = change(&self.moved(&c, step_s));
        let ends = self.moved(&a, step_s / 6.0).moved(&d, step_s / 6.0);
        *self = ends.moved(&b, step_s / 3.0).moved(&c, step_s / 3.0);
        self.world_from_body = self.world_from_body.normalize();
    }

    pub(super) fn rotation(&self) -> DMat3 {
        DMat3::from_quat(self.world_from_body)
    }
}
