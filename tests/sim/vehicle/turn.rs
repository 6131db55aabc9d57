//! The coordinated turn.

use viewsphere::sim::vehicle::{CoordinatedTurn, GRAVITY_M_S2, STEP_S, TurnParams, Vehicle, Wind};
use viewsphere::steer::Command;

use super::*;

#[test]
fn the_turn_has_the_radius_of_the_textbook() {
    for (speed_m_s, degrees) in [(8.0, 30.0), (12.0, 45.0), (16.0, -60.0)] {
        let mut vehicle = turner(speed_m_s, Wind::calm());
        let states = fly(&mut vehicle, &bank(degrees), 5.0);
        let (before, last) = (&states[states.len() - 121], &states[states.len() - 1]);
        let tan = degrees.abs().to_radians().tan();
        let (from, to) = if degrees > 0.0 { (before, last) } else { (last, before) };
        let turn = turn_rate_rad_s(from, to).abs();
        // After five seconds e^(−20) of the bank is missing.
        near("turn", turn, GRAVITY_M_S2 * tan / speed_m_s, 1e-6);
        let chord_m = (last.position_ned_m - before.position_ned_m).length();
        let radius_m = chord_m / (2.0 * (turn * 0.25).sin());
        near("radius", radius_m, speed_m_s * speed_m_s / (GRAVITY_M_S2 * tan), 1e-5);
        near("height", height_m(last), 50.0, 1e-12);
        near("airspeed", last.air_velocity_body_m_s.length(), speed_m_s, 1e-12);
    }
}

#[test]
fn bank_and_climb_lag_behind_their_commands() {
    let command = Command { bank_rad: 10_f64.to_radians(), climb_rad: 0.1 };
    let states = fly(&mut turner(12.0, Wind::calm()), &command, 2.0);
    for state in states.iter().skip(10) {
        let passed = |lag_s: f64| 1.0 - (-(state.time_s - STEP_S / 2.0) / lag_s).exp();
        // The rate takes a step to build up, and counts for half of it.
        near("bank", bank_deg(state), 10.0 * passed(0.2), 0.01);
        let climb_rad = (-state.velocity_ned_m_s.z / 12.0).asin();
        near("climb", climb_rad, 0.1 * passed(0.4), 1e-4);
    }
    // From 60° to the other side: 150 °/s until 30° are left, then in 0.2 s.
    let states = fly(&mut turner(12.0, Wind::calm()), &bank(60.0), 0.2);
    near("bank", bank_deg(states.last().unwrap()), 150.0 * (0.2 - STEP_S / 2.0), 0.01);
    let fastest = states.iter().map(|state| state.rate_body_rad_s.x).fold(0.0, f64::max);
    near("roll rate", fastest, 150_f64.to_radians(), 1e-9);
}

/// The stated rates rotate one attitude into the next, and the stated velocity moves one position to the next.
#[test]
fn rates_and_velocities_are_those_of_the_motion() {
    let params = TurnParams { attack_rad: 0.07, ..TurnParams::default() };
    let mut vehicle = CoordinatedTurn::new(&params, &start(12.0), Wind::calm()).unwrap();
    let mut before = vehicle.state();
    while before.time_s < 6.0 {
        vehicle.advance(&slalom(before.time_s), STEP_S);
        let after = vehicle.state();
        let mean_rad_s = (before.rate_body_rad_s + after.rate_body_rad_s) / 2.0;
        let turn = before.world_from_body.transpose() * after.world_from_body;
        let turned = glam::DQuat::from_scaled_axis(mean_rad_s * STEP_S);
        // Where a command jumps, the climb's rate changes by 0.7 rad/s within a step while the bank rotates by 0.01:
        // linear interpolation misses a third of that over h.
        assert!(turn.abs_diff_eq(glam::DMat3::from_quat(turned), 1e-5), "at {} s", before.time_s);
        // The trapezoid's h³/12 of the velocity's second derivative, which is V times 170 rad/s² of the climb's jump.
        let moved = (before.velocity_ned_m_s + after.velocity_ned_m_s) / 2.0 * STEP_S;
        assert!((after.position_ned_m - before.position_ned_m - moved).length() <= 1.5e-5);
        near("sideslip", sideslip_deg(&after), 0.0, 1e-12);
        near("attack", attack_deg(&after), 0.07_f64.to_degrees(), 1e-9);
        before = after;
    }
}

#[test]
fn the_position_converges() {
    let flown = |steps: u32| {
        let mut vehicle = turner(12.0, Wind::calm());
        for step in 0..120 * steps {
            let command = bank(if step < 60 * steps { 60.0 } else { -60.0 });
            vehicle.advance(&command, 1.0 / (30.0 * f64::from(steps)));
        }
        vehicle.state().position_ned_m
    };
    // Each command counts half a step late, 2 ms: 0.0185 m after a doublet of 48 m.
    let (eight, fine) = (flown(8), flown(256));
    assert!((eight - fine).length() <= 0.02, "{eight} {fine}");
}

/// While the bank grows at its limit the law is smooth: one long step equals eight short ones.
#[test]
fn a_long_step_is_as_good_as_eight_short_ones() {
    let mut short = turner(12.0, Wind::calm());
    fly(&mut short, &bank(60.0), 0.1);
    let mut long = short.clone();
    fly(&mut short, &bank(60.0), 8.0 * STEP_S);
    long.advance(&bank(60.0), 8.0 * STEP_S);
    let off = long.state().position_ned_m - short.state().position_ned_m;
    // Simpson's V h⁵/2880 times ψ' with four dashes: 1e-8 m.
    assert!(off.length() <= 1e-7, "{off}");
}
