//! The airframe alone: controls held, without the inner loop.

use std::f64::consts::{PI, TAU};

use viewsphere::sim::vehicle::{Airframe, AirframeParams, Controls, GRAVITY_M_S2, STEP_S, Vehicle, Wind};

use super::*;

/// C_L and C_D far from the stall, as in the textbook.
fn lift_and_drag(params: &AirframeParams, attack_rad: f64) -> [f64; 2] {
    let ratio = params.span_m.powi(2) / params.wing_area_m2;
    let lift = params.lift_zero + TAU * ratio / (ratio + 2.0) * attack_rad;
    [lift, params.drag_zero + lift * lift / (PI * params.oswald * ratio)]
}

fn pressure_n(params: &AirframeParams, speed_m_s: f64) -> f64 {
    params.air_density_kg_m3 * speed_m_s.powi(2) / 2.0 * params.wing_area_m2
}

#[test]
fn in_trim_lift_is_weight_and_thrust_is_drag() {
    let params = AirframeParams::default();
    for speed_m_s in [9.0, 12.0, 20.0] {
        let trim = params.trim(speed_m_s).unwrap();
        let [lift_n, drag_n] =
            lift_and_drag(&params, trim.attack_rad).map(|part| part * pressure_n(&params, speed_m_s));
        let (sin, cos) = trim.attack_rad.sin_cos();
        // These formulas ignore the stall, whose share is e^(−40 (α₀ ∓ α)) on either side: 0.4 % at 9 m/s and 7°.
        let part = |attack_rad: f64| (-40.0 * (params.stall_rad - attack_rad)).exp();
        let stalled = part(trim.attack_rad) + part(-trim.attack_rad);
        near(
            "lift",
            lift_n + trim.controls.thrust_n * sin,
            1.2 * GRAVITY_M_S2,
            1e-9 + 1.2 * stalled * lift_n,
        );
        near("drag", trim.controls.thrust_n * cos, drag_n, 1e-9 + 4.0 * stalled * drag_n);
        // The trim holds, up to rounding, for ten seconds of straight flight.
        let mut plane = airframe(speed_m_s, Wind::calm());
        let begin = plane.state();
        for _ in 0..2400 {
            plane.advance_held(&trim.controls, STEP_S);
        }
        let drift = plane.state().position_ned_m - begin.position_ned_m - 10.0 * begin.velocity_ned_m_s;
        assert!(drift.length() <= 1e-7, "{drift}");
    }
}

#[test]
fn there_is_no_trim_below_the_stall_or_without_thrust() {
    let params = AirframeParams::default();
    let message = params.trim(0.95 * params.stall_speed_m_s(0.0)).unwrap_err().to_string();
    assert!(message.starts_with("speed_m_s is 7.") && message.ends_with(" m/s to fly level"), "{message}");
    assert!(params.trim(1.01 * params.stall_speed_m_s(0.0)).is_ok());
    for wrong in [0.0, -3.0, f64::NAN, f64::INFINITY] {
        assert!(params.trim(wrong).is_err());
    }
    let weak = AirframeParams { thrust_limit_n: 1.0, ..params };
    assert_eq!(weak.level_speeds_m_s(), None);
    let message = weak.trim(12.0).unwrap_err().to_string();
    assert!(message.starts_with("speed_m_s is 12, expected another airframe"), "{message}");
}

#[test]
fn between_the_lowest_and_the_highest_speed_it_flies_level_and_nowhere_else() {
    let params = AirframeParams::default();
    let [low, high] = params.level_speeds_m_s().unwrap();
    assert!(low > 0.9 * params.stall_speed_m_s(0.0) && high > 20.0, "{low} {high}");
    for part in 0..=100 {
        let speed_m_s = low + f64::from(part) / 100.0 * (high - low);
        assert!(params.trim(speed_m_s).is_ok(), "{speed_m_s}");
    }
    for speed_m_s in [0.1, 0.999 * low, 1.001 * high, 1000.0] {
        assert!(params.trim(speed_m_s).is_err(), "{speed_m_s}");
    }
    let message = params.trim(30.0).unwrap_err().to_string();
    let shown = format!("{} to {} m/s", (10.0 * low).ceil() / 10.0, (10.0 * high).floor() / 10.0);
    assert_eq!(message, format!("speed_m_s is 30, expected {shown} to fly level"));
    // As documented in the help of fly, campaign and simulate.
    assert_eq!(shown, "7.7 to 25 m/s");
}

/// The period of the phugoid: trimmed controls, and a start that is 2 % too fast.
fn phugoid_s(params: &AirframeParams, speed_m_s: f64) -> f64 {
    let controls = params.trim(speed_m_s).unwrap().controls;
    let mut plane =
        Airframe::new(params, &Autopilot::default(), &start(1.02 * speed_m_s), Wind::calm()).unwrap();
    let mut crests = Vec::new();
    let mut sink_before = 0.0;
    for _ in 0..240 * 60 {
        plane.advance_held(&controls, STEP_S);
        let state = plane.state();
        let sink = state.velocity_ned_m_s.z;
        if sink_before > 0.0 && sink <= 0.0 {
            crests.push(state.time_s - STEP_S * sink / (sink - sink_before));
        }
        sink_before = sink;
    }
    // The first crest still contains the short period.
    (crests[4] - crests[1]) / 3.0
}

/// Lanchester (1908): a point at constant angle of attack oscillates with the period π√2 V/g.
#[test]
fn a_stiff_airframe_swings_in_lanchesters_period() {
    let params = AirframeParams {
        pitch_by_attack: -5.0,
        pitch_damping: -1.0,
        pitch_attack_rad: AirframeParams::default().trim(12.0).unwrap().attack_rad,
        ..AirframeParams::default()
    };
    let lanchester_s = PI * 2_f64.sqrt() * 12.0 / GRAVITY_M_S2;
    // The damping ζ = D/(√2 L) = 0.08 lengthens the period by 0.3 %; pitch damping adds 1.1 %.
    near("period", phugoid_s(&params, 12.0), lanchester_s, 0.02 * lanchester_s);
}

/// McRuer, Ashkenas & Graham, *Aircraft Dynamics and Automatic Control* (1973): ω² = g (M_w Z_u − M_u Z_w)/(Z_w M_q − V
/// M_w). The default airframe is small and strongly damped in pitch; its period is 1.6 times Lanchester's.
#[test]
fn the_airframe_swings_in_the_phugoids_period() {
    let params = AirframeParams::default();
    for speed_m_s in [10.0, 12.0, 16.0] {
        let trim = params.trim(speed_m_s).unwrap();
        let [lift, drag] = lift_and_drag(&params, trim.attack_rad);
        let force_n = pressure_n(&params, speed_m_s);
        let per_mass = force_n / (params.mass_kg * speed_m_s);
        let per_inertia = force_n * params.chord_m / params.inertia_kg_m2.y;
        let z_u = -2.0 * per_mass * lift;
        let z_w = -per_mass * (params.lift_slope() + drag);
        let m_u = -2.0 * trim.controls.torque_body_n_m.y / (params.inertia_kg_m2.y * speed_m_s);
        let m_w = per_inertia * params.pitch_by_attack / speed_m_s;
        let m_q = per_inertia * params.pitch_damping * params.chord_m / (2.0 * speed_m_s);
        let square = GRAVITY_M_S2 * (m_w * z_u - m_u * z_w) / (z_w * m_q - speed_m_s * m_w);
        let expected_s = TAU / square.sqrt();
        // The approximation neglects the damping: within 1 %.
        near("period", phugoid_s(&params, speed_m_s), expected_s, 0.015 * expected_s);
    }
}

/// ½v² + gh: the air only ever takes energy, in any attitude. The energy of rotation is separate; the model's static
/// moments do not exchange it with that of the path.
#[test]
fn without_thrust_energy_falls_at_every_step() {
    let energy =
        |state: &VehicleState| state.velocity_ned_m_s.length_squared() / 2.0 + GRAVITY_M_S2 * height_m(state);
    let mut plane = airframe(14.0, Wind::calm());
    let mut before = energy(&plane.state());
    for step in 0..2400 {
        let torque_body_n_m = match step / 200 % 4 {
            0 => DVec3::ZERO,
            1 => DVec3::new(0.4, 0.3, -0.2),
            2 => DVec3::new(-0.8, 0.9, 0.4),
            _ => DVec3::new(0.1, -0.6, 0.0),
        };
        plane.advance_held(&Controls { torque_body_n_m, thrust_n: 0.0 }, STEP_S);
        let after = energy(&plane.state());
        assert!(after < before, "step {step}: {before} J/kg, then {after}");
        before = after;
    }
}

/// Twice as many steps, a sixteenth of the error.
#[test]
fn the_integration_is_of_the_fourth_order() {
    let flown = |steps: u32| {
        let mut plane = airframe(12.0, Wind::calm());
        let thrust_n = 1.5;
        // Torques change at 0.5 s and at 1 s, which all step sizes meet exactly.
        for step in 0..steps {
            let torque_body_n_m = match 4 * step / steps {
                0 => DVec3::new(0.3, 0.2, 0.05),
                1 => DVec3::new(-0.3, 0.1, -0.05),
                _ => DVec3::ZERO,
            };
            plane.advance_held(&Controls { torque_body_n_m, thrust_n }, 2.0 / f64::from(steps));
        }
        plane.state().position_ned_m
    };
    let exact = flown(4096);
    let [a, b, c] = [128, 256, 512].map(|steps| (flown(steps) - exact).length());
    // The ratio approaches 16 from above: 18.2, then 17.1.
    assert!((15.0..19.0).contains(&(a / b)) && (15.0..18.0).contains(&(b / c)), "{a} {b} {c}");
}

/// The whole loop, with torques held over a step: a doublet of 60°, two seconds each.
#[test]
fn eight_steps_a_frame_are_enough() {
    let flown = |steps: u32| {
        let mut plane = airframe(12.0, Wind::calm());
        for step in 0..120 * steps {
            let command = bank(if step < 60 * steps { 60.0 } else { -60.0 });
            plane.advance(&command, 1.0 / (30.0 * f64::from(steps)));
        }
        plane.state().position_ned_m
    };
    let fine = flown(16);
    let [one, four, eight] = [1, 4, 8].map(|steps| (flown(steps) - fine).length());
    // 0.26, 0.054 and 0.018 m after 48 m of flight. The prototype has 0.21 and 0.04 m for the first two.
    assert!(one <= 0.3 && four <= 0.06 && eight <= 0.02, "{one} {four} {eight}");
    assert!(one > four && four > eight);
}

#[test]
fn controls_are_kept_within_the_limits() {
    let [held, limited] = [1e6, 1.5].map(|roll_n_m| {
        let mut plane = airframe(12.0, Wind::calm());
        let torque_body_n_m = DVec3::new(roll_n_m, 0.0, 0.0);
        plane.advance_held(&Controls { torque_body_n_m, thrust_n: 1.0 }, STEP_S);
        plane.state()
    });
    assert_eq!(held, limited);
    let [wrong, none] = [f64::NAN, 0.0].map(|thrust_n| {
        let mut plane = airframe(12.0, Wind::calm());
        plane.advance_held(&Controls { torque_body_n_m: DVec3::ZERO, thrust_n }, STEP_S);
        plane.state()
    });
    assert_eq!(wrong, none);
}
