//! The baseline policies: none, the bees' balance, a potential field, and a cost over headings.

use glam::DVec3;

use super::arc::hold_altitude;
use super::observation::{Moving, View};
use super::obstacles::Obstacle;
use super::{Command, Goal, SteerParams};
use crate::sphere::angles_rad;

/// Bank per angle between path and goal, both in radians.
const GOAL_GAIN: f64 = 0.6;
/// Bank, in radians, per difference between the sides of 1 rad/s.
const BALANCE_GAIN: f64 = 2.2;
/// The range of azimuths whose flow is balanced, off the direction of motion.
const BALANCED_RAD: [f64; 2] = [0.16, 0.80];
/// The reach of the potential field's force, in seconds of flight.
const REACH_S: f64 = 2.5;
/// The force of a bearing at half of that reach, relative to the goal's.
const FORCE: f64 = 0.012;
/// Headings tried to each side, and their spacing.
const HEADINGS: i32 = 18;
const HEADING_STEP_RAD: f64 = 0.0524;

/// Towards the goal.
pub(super) fn none(params: &SteerParams, moving: &Moving, goal: &Goal) -> Command {
    Command { bank_rad: GOAL_GAIN * off_goal(moving, goal), climb_rad: hold_altitude(params, goal) }
}

/// The policy `balance`: away from the side where the flow is faster.
pub(super) fn balance(
    params: &SteerParams,
    moving: &Moving,
    goal: &Goal,
    view: &View<'_>,
    level: &Level,
) -> Command {
    let grid = &view.sectors.grid;
    let mut sides = [(0.0, 0.0); 2];
    for (at, sector) in view.sectors.sectors.iter().enumerate() {
        let bearing = level.from_camera * grid.bearing(at % grid.columns, at / grid.columns);
        let azimuth = angles_rad(bearing)[0];
        if sector.is_known() && (BALANCED_RAD[0]..BALANCED_RAD[1]).contains(&azimuth.abs()) {
            let (sum, weight) = &mut sides[usize::from(azimuth > 0.0)];
            *sum += sector.coverage * sector.flow_rad_s.length();
            *weight += sector.coverage;
        }
    }
    let [left, right] = sides.map(|(sum, weight)| if weight > 0.0 { sum / weight } else { 0.0 });
    let bank_rad = BALANCE_GAIN * (left - right) + GOAL_GAIN * off_goal(moving, goal);
    Command { bank_rad, climb_rad: hold_altitude(params, goal) }
}

/// The frame of a level camera that looks along the motion.
pub(super) struct Level {
    pub(super) from_camera: glam::DMat3,
    pub(super) ned_from: glam::DMat3,
}

/// The policy `potential`: along the sum of a force towards the goal and one away from every obstacle.
pub(super) fn potential(
    params: &SteerParams,
    moving: &Moving,
    goal: &Goal,
    obstacles: &[Obstacle],
    level: &Level,
) -> Command {
    let reach_m = REACH_S * moving.speed_m_s;
    let mut force = DVec3::new(goal.yaw_rad.cos(), goal.yaw_rad.sin(), 0.0);
    for obstacle in obstacles {
        let distance_m = obstacle.place_ned_m.length().max(params.radius_m);
        let share = (reach_m / distance_m - 1.0).max(0.0);
        force -= FORCE * share * share * obstacle.place_ned_m.normalize_or_zero();
    }
    let there = level.ned_from.transpose() * force;
    // A fixed wing cannot fly backwards, however strong the force: only the side counts.
    let ahead = there.z.max(0.5);
    let [azimuth, elevation] = [there.x.atan2(ahead), (-there.y).atan2(there.x.hypot(ahead))];
    let climb_rad = if obstacles.is_empty() { hold_altitude(params, goal) } else { elevation };
    Command { bank_rad: bank_for(moving, azimuth), climb_rad }
}

/// The policy `heading`: the cheapest heading.
pub(super) fn heading(
    params: &SteerParams,
    moving: &Moving,
    goal: &Goal,
    obstacles: &[Obstacle],
    last_rad: &mut f64,
) -> Command {
    let cost = |off: f64| {
        let yaw = moving.yaw_rad + off;
        let danger = |obstacle: &Obstacle| {
            let DVec3 { x, y, .. } = obstacle.place_ned_m;
            let distance_m = obstacle.place_ned_m.length();
            let rate_hz = moving.speed_m_s / distance_m;
            let aside = ((y.atan2(x) - yaw).sin()).asin().abs();
            let wide = (params.radius_m / distance_m).min(1.0).asin() + params.half_width_rad;
            let ahead = x * yaw.cos() + y * yaw.sin() > 0.0;
            // 1 within the angular half width, falling to 0 at 1.5 times that.
            let share = if ahead { ((1.5 * wide - aside) / (0.5 * wide)).clamp(0.0, 1.0) } else { 0.0 };
            share * ((rate_hz - 0.3) / 2.7).clamp(0.0, 1.0)
        };
        12.0 * obstacles.iter().map(danger).fold(0.0, f64::max)
            + 3.0 * (1.0 - (yaw - goal.yaw_rad).cos())
            + 0.8 * (off - *last_rad).powi(2)
            + 0.3 * off * off
    };
    let headings = (-HEADINGS..=HEADINGS).map(|i| HEADING_STEP_RAD * f64::from(i));
    let best = headings.min_by(|a, b| cost(*a).total_cmp(&cost(*b))).unwrap_or(0.0);
    *last_rad = best;
    Command { bank_rad: bank_for(moving, best), climb_rad: hold_altitude(params, goal) }
}

/// The bank that turns by an angle in 0.4 s, if it were reached at once.
fn bank_for(moving: &Moving, turn_rad: f64) -> f64 {
    (2.5 * turn_rad * moving.speed_m_s / 9.81).atan()
}

fn off_goal(moving: &Moving, goal: &Goal) -> f64 {
    let (sin, cos) = (goal.yaw_rad - moving.yaw_rad).sin_cos();
    sin.atan2(cos)
}
