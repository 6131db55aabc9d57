use glam::DVec3;

use super::state::{GRAVITY_M_S2, not_negative, positive};
use crate::error::{Error, Result};

/// The parameters of an [`Airframe`](super::Airframe).
///
/// Coefficients are dimensionless, angles in radians; α is the angle of attack, β the sideslip. Derivatives by a rate
/// are those by p b/2V, q c/2V and r b/2V. Signs are those of FRD: a stable airframe has `roll_by_sideslip` and
/// `pitch_by_attack` below 0, `yaw_by_sideslip` above 0, and every damping below 0.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct AirframeParams {
    /// Mass m, kg.
    pub mass_kg: f64,
    /// Wing area S, m².
    pub wing_area_m2: f64,
    /// Span b, metres.
    pub span_m: f64,
    /// Mean chord c, metres.
    pub chord_m: f64,
    /// Moments of inertia about forward, right and down, kg m²; the products are 0.
    pub inertia_kg_m2: DVec3,
    /// Density of the air ρ, kg/m³.
    pub air_density_kg_m3: f64,
    /// C_L0, the lift at α = 0.
    pub lift_zero: f64,
    /// C_D0, the drag without lift.
    pub drag_zero: f64,
    /// Oswald's efficiency e: the induced drag is C_L²/(π e AR).
    pub oswald: f64,
    /// The angle of attack at which the wing stalls, α₀.
    pub stall_rad: f64,
    /// The sharpness of the stall, M per radian: the stalled share is 1/(1 + e^(−M(α − α₀))).
    pub stall_sharpness: f64,
    /// C_Yβ, side force.
    pub side_by_sideslip: f64,
    /// C_lβ, dihedral.
    pub roll_by_sideslip: f64,
    /// C_lp, roll damping.
    pub roll_damping: f64,
    /// C_mα, about `pitch_attack_rad`.
    pub pitch_by_attack: f64,
    /// The angle of attack at which the pitching moment is 0 without elevator.
    pub pitch_attack_rad: f64,
    /// C_mq, pitch damping.
    pub pitch_damping: f64,
    /// C_nβ, weathervane stability.
    pub yaw_by_sideslip: f64,
    /// C_nr, yaw damping.
    pub yaw_damping: f64,
    /// The maximum torques of aileron, elevator and rudder, N m.
    pub torque_limit_n_m: DVec3,
    /// The propeller's maximum thrust along the nose, N. It does not brake.
    pub thrust_limit_n: f64,
}

impl Default for AirframeParams {
    /// A foam plane of 1.2 kg and 1.2 m span that stalls at 7.3 m/s and is flown at 12 m/s. The numbers are typical
    /// of such planes, not measured on one.
    fn default() -> Self {
        Self {
            mass_kg: 1.2,
            wing_area_m2: 0.30,
            span_m: 1.2,
            chord_m: 0.25,
            inertia_kg_m2: DVec3::new(0.06, 0.08, 0.12),
            air_density_kg_m3: 1.225,
            lift_zero: 0.25,
            drag_zero: 0.035,
            oswald: 0.8,
            stall_rad: 15_f64.to_radians(),
            stall_sharpness: 40.0,
            side_by_sideslip: -0.8,
            roll_by_sideslip: -0.05,
            roll_damping: -0.45,
            pitch_by_attack: -0.5,
            pitch_attack_rad: 0.05,
            pitch_damping: -10.0,
            yaw_by_sideslip: 0.08,
            yaw_damping: -0.12,
            torque_limit_n_m: DVec3::new(1.5, 1.2, 1.0),
            thrust_limit_n: 8.0,
        }
    }
}

impl AirframeParams {
    /// Checks every field.
    ///
    /// # Errors
    /// [`Error::Parameter`] for the first that is out of range.
    pub fn validate(&self) -> Result<()> {
        for (name, value) in [
            ("mass_kg", self.mass_kg),
            ("wing_area_m2", self.wing_area_m2),
            ("span_m", self.span_m),
            ("chord_m", self.chord_m),
            ("inertia_kg_m2", self.inertia_kg_m2.x),
            ("inertia_kg_m2", self.inertia_kg_m2.y),
            ("inertia_kg_m2", self.inertia_kg_m2.z),
            ("air_density_kg_m3", self.air_density_kg_m3),
            ("oswald", self.oswald),
            ("stall_rad", self.stall_rad),
            ("stall_sharpness", self.stall_sharpness),
        ] {
            positive(name, value)?;
        }
        for (name, value) in [
            ("drag_zero", self.drag_zero),
            ("torque_limit_n_m", self.torque_limit_n_m.x),
            ("torque_limit_n_m", self.torque_limit_n_m.y),
            ("torque_limit_n_m", self.torque_limit_n_m.z),
            ("thrust_limit_n", self.thrust_limit_n),
        ] {
            not_negative(name, value)?;
        }
        for (name, value) in [
            ("side_by_sideslip", self.side_by_sideslip),
            ("roll_damping", self.roll_damping),
            ("pitch_damping", self.pitch_damping),
            ("yaw_damping", self.yaw_damping),
        ] {
            // With the other sign the air would excite what it should damp.
            not_negative(name, -value)
                .map_err(|_| Error::parameter(name, value, "0 or below, and finite"))?;
        }
        for (name, value) in [
            ("lift_zero", self.lift_zero),
            ("roll_by_sideslip", self.roll_by_sideslip),
            ("pitch_by_attack", self.pitch_by_attack),
            ("pitch_attack_rad", self.pitch_attack_rad),
            ("yaw_by_sideslip", self.yaw_by_sideslip),
        ] {
            if !value.is_finite() {
                return Err(Error::parameter(name, value, "finite"));
            }
        }
        Ok(())
    }

    /// Weight, N.
    pub fn weight_n(&self) -> f64 {
        self.mass_kg * GRAVITY_M_S2
    }

    /// Aspect ratio AR = b²/S.
    pub fn aspect_ratio(&self) -> f64 {
        self.span_m * self.span_m / self.wing_area_m2
    }

    /// C_Lα = 2π AR/(AR + 2) per radian, of a wing of moderate aspect ratio.
    pub fn lift_slope(&self) -> f64 {
        let ratio = self.aspect_ratio();
        std::f64::consts::TAU * ratio / (ratio + 2.0)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn the_default_is_legal_and_each_field_is_checked() {
        let good = AirframeParams::default();
        good.validate().unwrap();
        let wrong = [
            ("mass_kg", AirframeParams { mass_kg: 0.0, ..good }),
            ("wing_area_m2", AirframeParams { wing_area_m2: -0.3, ..good }),
            ("span_m", AirframeParams { span_m: f64::INFINITY, ..good }),
            ("chord_m", AirframeParams { chord_m: f64::NAN, ..good }),
            ("inertia_kg_m2", AirframeParams { inertia_kg_m2: DVec3::new(0.1, 0.0, 0.1), ..good }),
            ("inertia_kg_m2", AirframeParams { inertia_kg_m2: DVec3::new(0.1, f64::NAN, 0.1), ..good }),
            ("inertia_kg_m2", AirframeParams { inertia_kg_m2: DVec3::new(f64::NAN, 0.1, 0.1), ..good }),
            ("air_density_kg_m3", AirframeParams { air_density_kg_m3: 0.0, ..good }),
            ("oswald", AirframeParams { oswald: 0.0, ..good }),
            ("stall_rad", AirframeParams { stall_rad: 0.0, ..good }),
            ("stall_sharpness", AirframeParams { stall_sharpness: 0.0, ..good }),
            ("drag_zero", AirframeParams { drag_zero: -0.01, ..good }),
            ("torque_limit_n_m", AirframeParams { torque_limit_n_m: DVec3::new(1.0, 1.0, -1.0), ..good }),
            ("thrust_limit_n", AirframeParams { thrust_limit_n: f64::INFINITY, ..good }),
            ("side_by_sideslip", AirframeParams { side_by_sideslip: 0.8, ..good }),
            ("roll_damping", AirframeParams { roll_damping: 0.45, ..good }),
            ("pitch_damping", AirframeParams { pitch_damping: f64::NAN, ..good }),
            ("yaw_damping", AirframeParams { yaw_damping: 0.12, ..good }),
            ("lift_zero", AirframeParams { lift_zero: f64::NAN, ..good }),
            ("roll_by_sideslip", AirframeParams { roll_by_sideslip: f64::NAN, ..good }),
            ("pitch_by_attack", AirframeParams { pitch_by_attack: f64::INFINITY, ..good }),
            ("pitch_attack_rad", AirframeParams { pitch_attack_rad: f64::NAN, ..good }),
            ("yaw_by_sideslip", AirframeParams { yaw_by_sideslip: f64::NAN, ..good }),
        ];
        for (name, params) in wrong {
            let text = params.validate().unwrap_err().to_string();
            assert!(text.starts_with(name) && !text.contains('\n'), "{text}");
        }
    }

    #[test]
    fn the_wing_is_that_of_the_default() {
        let params = AirframeParams::default();
        assert!((params.aspect_ratio() - 4.8).abs() <= 1e-12);
        assert!((params.lift_slope() - 4.435_190).abs() <= 1e-6);
        assert!((params.weight_n() - 11.767_98).abs() <= 1e-9);
    }
}
