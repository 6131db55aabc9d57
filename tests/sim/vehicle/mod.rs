//! Vehicles compared with the textbook, wind and sensors with their statistics.

use glam::DVec3;
use viewsphere::camera::roll_pitch_yaw_rad;
use viewsphere::sim::vehicle::{
    Airframe, AirframeParams, Autopilot, CoordinatedTurn, STEP_S, Start, TurnParams, Vehicle, VehicleState,
    Wind,
};
use viewsphere::steer::Command;

mod inner_loop;
mod physics;
mod sensors;
mod turn;
mod wind;

/// A start 50 m above the ground, heading 40° from north.
fn start(speed_m_s: f64) -> Start {
    Start { position_ned_m: DVec3::new(3.0, -2.0, -50.0), yaw_rad: 0.7, speed_m_s }
}

fn airframe(speed_m_s: f64, wind: Wind) -> Airframe {
    Airframe::new(&AirframeParams::default(), &Autopilot::default(), &start(speed_m_s), wind).unwrap()
}

fn turner(speed_m_s: f64, wind: Wind) -> CoordinatedTurn {
    CoordinatedTurn::new(&TurnParams::default(), &start(speed_m_s), wind).unwrap()
}

fn bank(degrees: f64) -> Command {
    Command { bank_rad: degrees.to_radians(), climb_rad: 0.0 }
}

/// The states after each step of a flight.
fn fly(vehicle: &mut dyn Vehicle, command: &Command, time_s: f64) -> Vec<VehicleState> {
    let step = |_| {
        vehicle.advance(command, STEP_S);
        vehicle.state()
    };
    (0..(time_s / STEP_S).round() as u32).map(step).collect()
}

/// To the right, left and right again, up and down: twelve seconds of hard flying.
fn slalom(time_s: f64) -> Command {
    let side = if time_s % 3.0 < 1.5 { 1.0 } else { -1.0 };
    let up = if time_s % 4.0 < 2.0 { 1.0 } else { -1.0 };
    Command { bank_rad: side * 0.9, climb_rad: up * 0.14 }
}

fn bank_deg(state: &VehicleState) -> f64 {
    roll_pitch_yaw_rad(&state.world_from_body)[0].to_degrees()
}

fn attack_deg(state: &VehicleState) -> f64 {
    state.air_velocity_body_m_s.z.atan2(state.air_velocity_body_m_s.x).to_degrees()
}

fn sideslip_deg(state: &VehicleState) -> f64 {
    (state.air_velocity_body_m_s.y / state.air_velocity_body_m_s.length()).asin().to_degrees()
}

fn height_m(state: &VehicleState) -> f64 {
    -state.position_ned_m.z
}

/// The turn rate of the path between two states at most a turn apart, rad/s: positive to the right.
fn turn_rate_rad_s(from: &VehicleState, to: &VehicleState) -> f64 {
    let heading = |state: &VehicleState| state.velocity_ned_m_s.y.atan2(state.velocity_ned_m_s.x);
    (heading(to) - heading(from)).rem_euclid(std::f64::consts::TAU) / (to.time_s - from.time_s)
}

/// The time at which the bank first exceeds an angle, seconds after the first state.
fn time_to(states: &[VehicleState], degrees: f64) -> f64 {
    states.iter().position(|state| bank_deg(state) >= degrees).map_or(f64::NAN, |i| (i + 1) as f64 * STEP_S)
}

fn near(what: &str, found: f64, expected: f64, bound: f64) {
    let difference = (found - expected).abs();
    assert!(!difference.is_nan() && difference <= bound, "{what} is {found}, expected {expected} ± {bound}");
}
