//! Forces and moments of the air.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use super::params::AirframeParams;

/// How the air meets the body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inflow {
    pub(super) speed_m_s: f64,
    pub(super) attack_rad: f64,
    pub(super) sideslip_rad: f64,
}

impl Inflow {
    /// Of a velocity relative to the air, FRD. Air at rest comes from ahead.
    pub(super) fn new(air_velocity_body_m_s: DVec3) -> Self {
        let DVec3 { x, y, z } = air_velocity_body_m_s;
        Self {
            speed_m_s: air_velocity_body_m_s.length(),
            attack_rad: z.atan2(x),
            sideslip_rad: y.atan2(x.hypot(z)),
        }
    }
}

impl AirframeParams {
    /// ½ρV²S, N: what a coefficient of 1 is worth.
    pub(super) fn pressure_force_n(&self, speed_m_s: f64) -> f64 {
        0.5 * self.air_density_kg_m3 * speed_m_s * speed_m_s * self.wing_area_m2
    }

    /// How much of the wing has stalled, 0 to 1.
    fn stalled(&self, attack_rad: f64) -> f64 {
        let [over, under] = [attack_rad - self.stall_rad, -attack_rad - self.stall_rad]
            .map(|beyond| 1.0 / (1.0 + (-self.stall_sharpness * beyond).exp()));
        over + under - over * under
    }

    /// C_L and C_D at an angle of attack: a wing's, and once it has stalled a flat plate's, whose force 2 sin²α stands
    /// across it.
    pub(super) fn lift_and_drag(&self, attack_rad: f64) -> [f64; 2] {
        let stalled = self.stalled(attack_rad);
        let (sin, cos) = attack_rad.sin_cos();
        let wing_lift = self.lift_zero + self.lift_slope() * attack_rad;
        let plate = 2.0 * sin * sin.abs();
        let lift = (1.0 - stalled) * wing_lift + stalled * plate * cos;
        let induced = lift * lift / (PI * self.oswald * self.aspect_ratio());
        [lift, self.drag_zero + (1.0 - stalled) * induced + stalled * plate * sin]
    }

    /// The air's force without the propeller's, N FRD.
    pub(super) fn force_n(&self, inflow: &Inflow) -> DVec3 {
        let [lift, drag] = self.lift_and_drag(inflow.attack_rad);
        let (sin, cos) = inflow.attack_rad.sin_cos();
        let side = self.side_by_sideslip * inflow.sideslip_rad;
        self.pressure_force_n(inflow.speed_m_s)
            * DVec3::new(lift * sin - drag * cos, side, -lift * cos - drag * sin)
    }

    /// The air's moment without the control surfaces', N m FRD.
    pub(super) fn moment_n_m(&self, inflow: &Inflow, rate_body_rad_s: DVec3) -> DVec3 {
        let Inflow { speed_m_s, attack_rad, sideslip_rad } = *inflow;
        let arm_m = DVec3::new(self.span_m, self.chord_m, self.span_m);
        let vane = DVec3::new(
            self.roll_by_sideslip * sideslip_rad,
            self.pitch_by_attack * (attack_rad - self.pitch_attack_rad),
            self.yaw_by_sideslip * sideslip_rad,
        );
        // ½ρV²S l · l/2V, without a division by a speed that may be 0.
        let damping = DVec3::new(self.roll_damping, self.pitch_damping, self.yaw_damping)
            * rate_body_rad_s
            * arm_m
            * (0.25 * self.air_density_kg_m3 * speed_m_s * self.wing_area_m2);
        arm_m * (self.pressure_force_n(speed_m_s) * vane + damping)
    }

    /// The largest C_L, to a tenth of a degree of attack.
    pub(super) fn largest_lift(&self) -> f64 {
        let steps = (FRAC_PI_2.to_degrees() * 10.0) as u32;
        let lift = |step: u32| self.lift_and_drag((f64::from(step) / 10.0).to_radians())[0];
        (0..=steps).map(lift).fold(0.0, f64::max)
    }

    /// The least airspeed in a level turn, m/s, of the wing alone: that of straight flight times 1/√cos φ.
    pub fn stall_speed_m_s(&self, bank_rad: f64) -> f64 {
        let of_one = self.pressure_force_n(1.0) * self.largest_lift() * bank_rad.cos();
        (self.weight_n() / of_one.max(0.0)).sqrt()
    }
}
