//! Aerodynamic forces and moments.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use super::params::AirframeParams;

/// The flow of air relative to the body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inflow {
    pub(super) speed_m_s: f64,
    pub(super) attack_rad: f64,
    pub(super) sideslip_rad: f64,
}

impl Inflow {
    /// From a velocity relative to the air, FRD. Air at rest comes from ahead.
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
    /// ½ρV²S, N: the force of a coefficient of 1.
    pub(super) fn pressure_force_n(&self, speed_m_s: f64) -> f64 {
        0.5 * self.air_density_kg_m3 * speed_m_s * speed_m_s * self.wing_area_m2
    }

    /// The stalled share of the wing, 0 to 1.
    fn stalled(&self, attack_rad: f64) -> f64 {
        let [over, under] = [attack_rad - self.stall_rad, -attack_rad - self.stall_rad]
            .map(|beyond| 1.0 / (1.0 + (-self.stall_sharpness * beyond).exp()));
        over + under - over * under
    }

    /// C_L and C_D at an angle of attack: those of a wing, and once it has stalled of a flat plate, whose force 2
    /// sin²α is normal to it.
    pub(super) fn lift_and_drag(&self, attack_rad: f64) -> [f64; 2] {
        let stalled = self.stalled(attack_rad);
        let (sin, cos) = attack_rad.sin_cos();
        let wing_lift = self.lift_zero + self.lift_slope() * attack_rad;
        let plate = 2.0 * sin * sin.abs();
        let lift = (1.0 - stalled) * wing_lift + stalled * plate * cos;
        let induced = lift * lift / (PI * self.oswald * self.aspect_ratio());
        [lift, self.drag_zero + (1.0 - stalled) * induced + stalled * plate * sin]
    }

    /// The aerodynamic force without the propeller's, N FRD.
    pub(super) fn force_n(&self, inflow: &Inflow) -> DVec3 {
        let [lift, drag] = self.lift_and_drag(inflow.attack_rad);
        let (sin, cos) = inflow.attack_rad.sin_cos();
        let side = self.side_by_sideslip * inflow.sideslip_rad;
        self.pressure_force_n(inflow.speed_m_s)
            * DVec3::new(lift * sin - drag * cos, side, -lift * cos - drag * sin)
    }

    /// The aerodynamic moment without the control surfaces', N m FRD.
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

    /// The largest C_L, to a tenth of a degree in the angle of attack.
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

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn lift_and_drag_are_a_wings_below_the_stall_and_a_plates_beyond() {
        let params = AirframeParams::default();
        let at = |degrees: f64| params.lift_and_drag(degrees.to_radians());
        // A stall at 15° leaves e^(−40·0.26) of its share at 0°, on either side.
        let [lift, drag] = at(0.0);
        assert!((lift - 0.25).abs() <= 3e-5 && (drag - 0.035 - 0.0625 / (PI * 0.8 * 4.8)).abs() <= 1e-5);
        // Half of each at 15°.
        let (sin, cos) = 15_f64.to_radians().sin_cos();
        let half = (0.25 + params.lift_slope() * 15_f64.to_radians() + 2.0 * sin * sin * cos) / 2.0;
        assert!((at(15.0)[0] - half).abs() <= 1e-6);
        // The plate across the stream, and from behind.
        let [lift, drag] = at(90.0);
        assert!(lift.abs() <= 1e-6 && (drag - 2.035).abs() <= 1e-6);
        assert!((at(-90.0)[1] - 2.035).abs() <= 1e-6);
        for tenth in -1800..=1800 {
            let [lift, drag] = at(f64::from(tenth) / 10.0);
            assert!(drag >= 0.035 && lift.abs() <= 1.2, "{tenth}: {lift} {drag}");
        }
        assert!((params.largest_lift() - 1.06).abs() <= 0.005);
        assert!((params.stall_speed_m_s(0.0) - 7.78).abs() <= 0.005);
    }

    #[test]
    fn the_air_pushes_back_whatever_it_meets() {
        let params = AirframeParams::default();
        for i in 0..1000 {
            let angle = f64::from(i);
            let velocity = DVec3::new(angle.sin(), (1.7 * angle).cos(), (2.3 * angle).sin()) * 15.0;
            let inflow = Inflow::new(velocity);
            assert!(params.force_n(&inflow).dot(velocity) < 0.0, "{velocity}");
            // Without the static part, the remaining moment only damps.
            let rate = DVec3::new((3.1 * angle).sin(), angle.cos(), (0.7 * angle).sin());
            let damping = params.moment_n_m(&inflow, rate) - params.moment_n_m(&inflow, DVec3::ZERO);
            assert!(damping.dot(rate) < 0.0, "{damping} {rate}");
        }
        let still = Inflow::new(DVec3::ZERO);
        assert_eq!(params.force_n(&still), DVec3::ZERO);
        assert_eq!(params.moment_n_m(&still, DVec3::ONE), DVec3::ZERO);
    }

    /// The signs of a stable airframe: it yaws into the wind, and rolls away from it.
    #[test]
    fn the_vanes_turn_into_the_wind() {
        let params = AirframeParams::default();
        let moment = |velocity| params.moment_n_m(&Inflow::new(velocity), DVec3::ZERO);
        let from_the_right = moment(DVec3::new(12.0, 2.0, 0.6));
        assert!(from_the_right.z > 0.0 && from_the_right.x < 0.0);
        assert!(moment(DVec3::new(12.0, 0.0, 3.0)).y < 0.0 && moment(DVec3::new(12.0, 0.0, -3.0)).y > 0.0);
    }
}
