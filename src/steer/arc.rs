//! The policy `arc`: the cheapest of the arcs that the aircraft can fly.
//!
//! A candidate is a bank angle that is held for a while, then level wings, with one of three climb angles. It is
//! predicted as a coordinated turn (ψ̇ = g tan φ / V; the bank follows its command with a time constant and a maximum
//! rate) from the present state, with the earlier commands until the new one takes effect. Its cost has terms for the
//! closest passage of an obstacle along it, for its final direction, and for the effort.

use glam::DVec3;

use super::observation::Moving;
use super::obstacles::Obstacle;
use super::{Command, Goal, SteerConfig, SteerParams};

/// Bank angles to each side, evenly spaced up to the limit.
const BANKS: i32 = 6;
/// Durations for which a bank angle is held.
const HOLDS_S: [f64; 3] = [0.5, 1.0, 1.8];
/// Points along an arc at which obstacles are checked.
pub(super) const PLACES: usize = 20;
/// Integration steps from one point to the next.
const STEPS: usize = 4;
const GRAVITY_M_S2: f64 = 9.81;

/// A candidate arc: its command, cost and predicted path.
#[derive(Clone, Debug, PartialEq)]
pub struct Arc {
    /// The command that flies it.
    pub command: Command,
    /// Its cost.
    pub cost: f64,
    /// The obstacles' part of the cost, 0 to the weight of the danger.
    pub danger: f64,
    /// The predicted path: points relative to the aircraft along north, east and down, in metres, evenly spaced in
    /// time over the horizon.
    pub path_ned_m: [DVec3; PLACES],
}

/// The state from which the arcs start.
pub(super) struct Start<'a> {
    pub(super) moving: Moving,
    pub(super) goal: Goal,
    /// The last command given.
    pub(super) last: Command,
    /// The commands in effect until the new one is, each with its end in seconds from now.
    pub(super) acting: &'a [(f64, Command)],
}

impl Start<'_> {
    /// The command in effect at a time from now, before the new one is.
    fn acting(&self, time_s: f64) -> Command {
        self.acting.iter().find(|(until_s, _)| time_s < *until_s).map_or(self.last, |(_, command)| *command)
    }
}

/// Finds the cheapest arc.
pub(super) fn cheapest(config: &SteerConfig, start: &Start<'_>, obstacles: &[Obstacle]) -> Arc {
    let params = &config.params;
    let near = Near::new(params, start.moving.speed_m_s, obstacles);
    let level = hold_altitude(params, &start.goal);
    let climbs = [level, -params.max_climb_rad, params.max_climb_rad];
    let mut best: Option<Arc> = None;
    for climb_rad in climbs {
        for i in -BANKS..=BANKS {
            let command =
                Command { bank_rad: params.max_bank_rad * f64::from(i) / f64::from(BANKS), climb_rad };
            for hold_s in HOLDS_S {
                let arc = arc(config, start, &near, command, hold_s, level);
                if best.as_ref().is_none_or(|best| arc.cost < best.cost) {
                    best = Some(arc);
                }
                // Level wings stay level, however long they are held.
                if i == 0 {
                    break;
                }
            }
        }
    }
    best.unwrap_or_else(|| unreachable!("there are candidates"))
}

/// The climb that leads back to the wanted altitude.
pub(super) fn hold_altitude(params: &SteerParams, goal: &Goal) -> f64 {
    let climb = params.climb_per_m * goal.too_low_m.unwrap_or(0.0);
    climb.clamp(-params.max_climb_rad, params.max_climb_rad)
}

fn arc(
    config: &SteerConfig,
    start: &Start<'_>,
    near: &Near,
    command: Command,
    hold_s: f64,
    level_rad: f64,
) -> Arc {
    let Moving { mut bank_rad, mut yaw_rad, mut climb_rad, speed_m_s } = start.moving;
    let SteerConfig { params, aircraft } = config;
    let step_s = params.horizon_s / (PLACES * STEPS) as f64;
    let (delay_s, response) = (aircraft.delay_s(), &aircraft.response);
    let (mut at, mut danger) = (DVec3::ZERO, 0.0_f64);
    let mut path_ned_m = [DVec3::ZERO; PLACES];
    for (k, place) in path_ned_m.iter_mut().enumerate() {
        for step in 0..STEPS {
            let time_s = (k * STEPS + step) as f64 * step_s;
            let wanted = if time_s < delay_s {
                start.acting(time_s)
            } else if time_s < delay_s + hold_s {
                command
            } else {
                Command { bank_rad: 0.0, ..command }
            };
            let rate = (wanted.bank_rad - bank_rad) / response.bank_time_s;
            bank_rad += step_s * rate.clamp(-response.bank_rate_rad_s, response.bank_rate_rad_s);
            yaw_rad += step_s * GRAVITY_M_S2 * bank_rad.tan() / speed_m_s;
            climb_rad += step_s * (wanted.climb_rad - climb_rad) / response.climb_time_s;
            let (sin, cos) = yaw_rad.sin_cos();
            at += step_s
                * speed_m_s
                * DVec3::new(climb_rad.cos() * cos, climb_rad.cos() * sin, -climb_rad.sin());
        }
        *place = at;
        let time_s = ((k + 1) * STEPS) as f64 * step_s;
        let passage = near.passage(at);
        let met = 1.0 / (1.0 + ((passage - 1.0) * params.radius_m / params.softness_m).exp());
        danger = danger.max((-time_s / params.discount_s).exp() * met);
    }
    let weights = params.weights;
    let danger = weights.danger * danger;
    let cost = danger
        + weights.goal * (1.0 - (yaw_rad - start.goal.yaw_rad).cos())
        + weights.change * (command.bank_rad - start.last.bank_rad).powi(2)
        + weights.bank * command.bank_rad.powi(2)
        + weights.climb * (command.climb_rad - level_rad).powi(2);
    Arc { command, cost, danger, path_ned_m }
}

/// Obstacles within reach, in groups of eight, as the vectorised nearest search needs them.
struct Near(Vec<Eight>);

#[derive(Clone, Copy)]
struct Eight {
    place: [[f32; 8]; 3],
    /// The inverse square of the required clearance of each obstacle; 0 for padding.
    scale: [f32; 8],
}

/// Beyond this multiple of the required clearance an obstacle does not affect the cost.
const FAR: f32 = 10.0;

impl Near {
    fn new(params: &SteerParams, speed_m_s: f64, obstacles: &[Obstacle]) -> Self {
        let reach_m = speed_m_s * params.horizon_s;
        let aside_m = |obstacle: &Obstacle| obstacle.radius_m + params.radius_m;
        let near: Vec<&Obstacle> = (obstacles.iter())
            .filter(|obstacle| obstacle.place_ned_m.length() < reach_m + 3.0 * aside_m(obstacle))
            .collect();
        let eight = |near: &[&Obstacle]| {
            // Pad the last group with points infinitely far away.
            let mut eight = Eight { place: [[1e9; 8]; 3], scale: [1.0; 8] };
            for (i, obstacle) in near.iter().enumerate() {
                let place = obstacle.place_ned_m.as_vec3().to_array();
                (0..3).for_each(|axis| eight.place[axis][i] = place[axis]);
                eight.scale[i] = aside_m(obstacle).powi(-2) as f32;
            }
            eight
        };
        Self(near.chunks(8).map(eight).collect())
    }

    /// The smallest distance from a point to an obstacle, relative to that obstacle's required clearance.
    fn passage(&self, at: DVec3) -> f64 {
        let at = at.as_vec3().to_array();
        let mut least = [FAR * FAR; 8];
        for Eight { place, scale } in &self.0 {
            for i in 0..8 {
                let [x, y, z]: [f32; 3] = std::array::from_fn(|axis| place[axis][i] - at[axis]);
                let square = (x * x + y * y + z * z) * scale[i];
                least[i] = if square < least[i] { square } else { least[i] };
            }
        }
        f64::from(least.into_iter().fold(FAR * FAR, f32::min)).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn start(goal_yaw_rad: f64) -> Start<'static> {
        Start {
            moving: Moving { bank_rad: 0.0, yaw_rad: 0.0, climb_rad: 0.0, speed_m_s: 12.0 },
            goal: Goal { yaw_rad: goal_yaw_rad, too_low_m: None },
            last: Command::default(),
            acting: &[],
        }
    }

    fn ball(north_m: f64, east_m: f64, radius_m: f64) -> Obstacle {
        Obstacle { place_ned_m: DVec3::new(north_m, east_m, 0.0), radius_m }
    }

    #[test]
    fn without_obstacles_it_flies_towards_the_goal() {
        let config = SteerConfig::default();
        let bank = |yaw: f64| cheapest(&config, &start(yaw), &[]).command.bank_rad;
        assert!(bank(0.0).abs() < 1e-12 && bank(0.8) > 0.1 && bank(-0.8) < -0.1);
    }

    #[test]
    fn it_passes_on_the_side_that_is_free() {
        let config = SteerConfig::default();
        for side in [-1.0, 1.0] {
            // A wall of balls from straight ahead to one side.
            let wall: Vec<Obstacle> =
                (0..12).map(|i| ball(18.0, side * (1.5 * f64::from(i) - 2.0), 1.0)).collect();
            let arc = cheapest(&config, &start(0.0), &wall);
            assert!(arc.command.bank_rad * side < -0.1, "{arc:?}");
            let least =
                |o: &Obstacle| arc.path_ned_m.iter().map(|p| p.distance(o.place_ned_m)).fold(1e9, f64::min);
            assert!(wall.iter().map(least).fold(1e9, f64::min) > 2.0, "{arc:?}");
        }
    }

    /// Earlier commands are predicted for as long as they are in effect, and the arc continues from there.
    #[test]
    fn earlier_commands_are_followed_while_they_act() {
        let mut config = SteerConfig::default();
        (config.aircraft.latency_s, config.aircraft.response.lag_s) = (0.1, 0.3);
        let near = Near::new(&config.params, 12.0, &[]);
        let level = Command::default();
        let right = Command { bank_rad: 0.8, ..level };
        let path = |acting: &[(f64, Command)]| {
            super::arc(&config, &Start { acting, ..start(0.0) }, &near, level, 1.0, 0.0).path_ned_m
        };
        let east_m = |acting: &[(f64, Command)]| path(acting)[PLACES - 1].y;
        assert_eq!(path(&[]), path(&[(0.4, level)]));
        let [short, long] = [0.2, 0.4].map(|until_s| east_m(&[(until_s, right), (0.4, level)]));
        assert!(0.5 < short && short + 0.5 < long, "{short} {long}");
        // Nothing acts beyond the delay of a new command.
        assert_eq!(path(&[(0.4, right)]), path(&[(5.0, right)]));
    }

    #[test]
    fn what_cannot_be_avoided_is_met_late() {
        let config = SteerConfig::default();
        let shell: Vec<Obstacle> = (0..2000)
            .map(|i| {
                let (azimuth, height) = (0.7 * f64::from(i), f64::from(i) / 1000.0 - 1.0);
                let level = (1.0 - height * height).sqrt();
                let bearing = DVec3::new(azimuth.cos() * level, azimuth.sin() * level, height);
                Obstacle { place_ned_m: bearing * 15.0, radius_m: 1.0 }
            })
            .collect();
        let arc = cheapest(&config, &start(0.0), &shell);
        let straight = super::arc(
            &config,
            &start(0.0),
            &Near::new(&config.params, 12.0, &shell),
            Command::default(),
            1.0,
            0.0,
        );
        assert!(arc.danger > 1.0 && arc.danger < straight.danger, "{} {}", arc.danger, straight.danger);
    }

    #[test]
    fn the_nearest_passage_is_found_among_any_number() {
        let config = SteerConfig::default();
        for count in [0, 1, 7, 8, 9, 33] {
            let balls: Vec<Obstacle> = (0..count).map(|i| ball(5.0 + f64::from(i), 2.0, 0.3)).collect();
            let at = DVec3::new(3.0, 1.0, 0.5);
            let each =
                balls.iter().map(|o| o.place_ned_m.distance(at) / (o.radius_m + config.params.radius_m));
            let expected = each.fold(f64::from(FAR), f64::min);
            let found = Near::new(&config.params, 100.0, &balls).passage(at);
            assert!((found - expected).abs() < 1e-5, "{count}: {found} {expected}");
        }
    }
}
