//! Steering from synthetic views: signs, limits, memory, and the behaviour without a cue.

use glam::{DMat3, DVec3};
use viewsphere::camera::{Camera, FRD_FROM_CAMERA, Lens, world_from_body};
use viewsphere::frame::Size;
use viewsphere::sphere::{Grid, Heading, Sectors};
use viewsphere::steer::{
    Danger, Goal, Observation, Policy, Source, SteerConfig, SteerParams, Steering, View,
};

const SPEED_M_S: f64 = 12.0;

fn grid() -> Grid {
    let size = Size::new(320, 240);
    let camera = Camera { size, f_u: 160.0, f_v: 160.0, u_0: 159.5, v_0: 119.5, lens: Lens::NONE };
    Grid::over(&camera, [32, 24]).unwrap()
}

/// The view of balls, given in the camera's frame, from a camera that flies straight ahead.
fn view(balls_camera_m: &[(DVec3, f64)]) -> Sectors {
    let mut sectors = Sectors::unknown(grid());
    sectors.interval_s = 1.0 / 30.0;
    for at in 0..sectors.grid.len() {
        let p = sectors.grid.bearing(at % sectors.grid.columns, at / sectors.grid.columns);
        let met = balls_camera_m.iter().filter_map(|(centre, radius)| {
            let along = centre.dot(p);
            let aside = (centre.length_squared() - along * along).max(0.0);
            (along > 0.0 && aside < radius * radius).then(|| along - (radius * radius - aside).sqrt())
        });
        let nearest = met.fold(f64::INFINITY, f64::min);
        let rate = SPEED_M_S / nearest;
        let sector = &mut sectors.sectors[at];
        (sector.coverage, sector.confidence) = (1.0, 1.0);
        sector.nearness_rate_hz = [rate; 3];
        sector.divergence_hz = 2.0 * rate;
        sector.flow_rad_s = rate * (p * p.z - DVec3::Z);
    }
    sectors
}

fn observation<'a>(time_s: f64, attitude: DMat3, sectors: Option<&'a Sectors>) -> Observation<'a> {
    let heading = Heading { direction: DVec3::Z, error_rad: 0.01 };
    Observation {
        time_s,
        ned_from_body: attitude,
        airspeed_m_s: SPEED_M_S,
        motion_body: None,
        goal: Goal::default(),
        view: sectors.map(|sectors| View { sectors, heading }),
    }
}

fn steering(policy: Policy, danger: Danger) -> Steering {
    Steering::new(SteerParams { policy, danger, ..SteerParams::default() }.into()).unwrap()
}

/// A large obstacle ahead, more of it to the right (1) or to the left (−1).
fn ahead(side: f64) -> Vec<(DVec3, f64)> {
    (0..8).map(|i| (DVec3::new(side * (2.0 * f64::from(i) - 2.0), 0.0, 22.0), 2.5)).collect()
}

#[test]
fn every_policy_that_sees_turns_to_the_free_side() {
    for danger in [Danger::Nearness, Danger::Divergence, Danger::Blend] {
        for policy in [Policy::Balance, Policy::Potential, Policy::Heading, Policy::Arc] {
            for side in [-1.0, 1.0] {
                let sectors = view(&ahead(side));
                let mut steering = steering(policy, danger);
                let mut bank = 0.0;
                for frame in 0..4 {
                    let o = observation(f64::from(frame) / 30.0, DMat3::IDENTITY, Some(&sectors));
                    bank = steering.update(&o).command.bank_rad;
                }
                assert!(bank * side < -0.02, "{policy:?} {danger:?}, obstacle at {side}: bank {bank}");
            }
        }
    }
}

#[test]
fn the_goal_is_turned_to_and_none_looks_at_nothing_else() {
    for policy in [Policy::None, Policy::Balance, Policy::Potential, Policy::Heading, Policy::Arc] {
        for yaw_rad in [-0.6, 0.6] {
            let sectors = view(&[]);
            let mut o = observation(0.0, DMat3::IDENTITY, Some(&sectors));
            o.goal = Goal { yaw_rad, too_low_m: None };
            let bank = steering(policy, Danger::Nearness).update(&o).command.bank_rad;
            assert!(bank * yaw_rad > 0.0, "{policy:?}: {bank} for {yaw_rad}");
        }
    }
    let blocked = view(&ahead(1.0));
    let o = observation(0.0, DMat3::IDENTITY, Some(&blocked));
    assert_eq!(steering(Policy::None, Danger::Nearness).update(&o).command.bank_rad, 0.0);
}

#[test]
fn an_altitude_is_returned_to() {
    let sectors = view(&[]);
    for too_low_m in [-4.0, 4.0] {
        let mut o = observation(0.0, DMat3::IDENTITY, Some(&sectors));
        o.goal.too_low_m = Some(too_low_m);
        let climb = steering(Policy::Arc, Danger::Nearness).update(&o).command.climb_rad;
        assert!(climb * too_low_m > 0.0, "{climb} when {too_low_m} m too low");
    }
}

/// Banked or not, the map is level: an obstacle ahead at the camera's height lies on its horizon.
#[test]
fn the_map_is_level_whatever_the_bank() {
    for roll in [-0.9, -0.3, 0.0, 0.5, 1.0] {
        let attitude = world_from_body(roll, 0.0, 0.4);
        let ball_ned = world_from_body(0.0, 0.0, 0.4) * DVec3::new(18.0, 5.0, 0.0);
        let camera_from_ned = (attitude * FRD_FROM_CAMERA).transpose();
        let sectors = view(&[(camera_from_ned * ball_ned, 1.5)]);
        let mut steering = steering(Policy::Arc, Danger::Nearness);
        for frame in 0..8 {
            steering.update(&observation(f64::from(frame) / 30.0, attitude, Some(&sectors)));
        }
        let map = steering.map();
        let highest =
            (0..map.grid.len()).max_by(|a, b| map.rates_hz[*a].total_cmp(&map.rates_hz[*b])).unwrap();
        let [azimuth, elevation] =
            map.grid.angles_rad(highest % map.grid.columns, highest / map.grid.columns);
        assert!((azimuth - (5.0_f64 / 18.0).atan()).abs() < 0.09, "roll {roll}: azimuth {azimuth}");
        assert!(elevation.abs() < 0.16, "roll {roll}: elevation {elevation}");
    }
}

#[test]
fn what_has_left_the_view_is_remembered_for_a_while() {
    // The map's memory of the previous frame is relative to the direction of motion; so sudden a rotation would carry
    // it along.
    let params = SteerParams { smoothing: 1.0, ..SteerParams::default() };
    let mut steering = Steering::new(params.into()).unwrap();
    let seen = view(&[(DVec3::new(7.0, 0.0, 10.0), 1.5)]);
    steering.update(&observation(0.0, DMat3::IDENTITY, Some(&seen)));
    let before = steering.obstacles().len();
    assert!(before > 0);
    // The aircraft turns to the left: the obstacle is now beyond the right border.
    let away = world_from_body(0.0, 0.0, -0.9);
    let nothing = view(&[]);
    steering.update(&observation(1.0 / 30.0, away, Some(&nothing)));
    let remembered = steering.obstacles().to_vec();
    assert!(!remembered.is_empty() && remembered.len() <= before);
    // It has flown on by 0.4 m meanwhile, so that all obstacles are nearer.
    assert!(remembered.iter().all(|o| (8.0..13.5).contains(&o.place_ned_m.length())), "{remembered:?}");
    steering.update(&observation(2.0, away, Some(&nothing)));
    assert!(steering.obstacles().is_empty());
}

/// A sector whose flow is not trusted shows nothing: what was seen there before is remembered.
#[test]
fn what_is_merely_unknown_is_remembered() {
    let mut seen = view(&[(DVec3::new(3.0, 0.0, 10.0), 1.5)]);
    let params = SteerParams { smoothing: 1.0, ..SteerParams::default() };
    for (coverage, remembered) in [(0.0, true), (1.0, false)] {
        let mut steering = Steering::new(params.into()).unwrap();
        steering.update(&observation(0.0, DMat3::IDENTITY, Some(&seen)));
        assert!(!steering.obstacles().is_empty());
        let mut nothing = view(&[]);
        nothing.sectors.iter_mut().for_each(|sector| sector.coverage = coverage);
        steering.update(&observation(1.0 / 30.0, DMat3::IDENTITY, Some(&nothing)));
        assert_eq!(!steering.obstacles().is_empty(), remembered, "coverage {coverage}");
    }
    // Half an interval after the moment of its rate, the obstacle is nearer by what was flown since.
    seen.interval_s = 0.5;
    let nearest = |seen: &Sectors| {
        let mut steering = Steering::new(params.into()).unwrap();
        steering.update(&observation(0.0, DMat3::IDENTITY, Some(seen)));
        steering.obstacles().iter().map(|o| o.place_ned_m.length()).fold(f64::INFINITY, f64::min)
    };
    let late = nearest(&seen);
    seen.interval_s = 0.0;
    assert!((nearest(&seen) - late - 0.25 * SPEED_M_S).abs() < 1e-9, "{late}");
}

#[test]
fn without_a_cue_it_holds_and_then_levels_and_climbs() {
    let config = SteerParams::default();
    let mut steering = Steering::new(config.into()).unwrap();
    let none = steering.update(&observation(0.0, DMat3::IDENTITY, None));
    assert_eq!(none.source, Source::Recovery);
    let sectors = view(&ahead(1.0));
    let last = steering.update(&observation(0.1, DMat3::IDENTITY, Some(&sectors)));
    assert_eq!(last.source, Source::Cue);
    let held = steering.update(&observation(0.1 + 0.9 * config.on_invalid.hold_s, DMat3::IDENTITY, None));
    assert_eq!((held.source, held.command), (Source::Held, last.command));
    let later = steering.update(&observation(0.1 + 1.1 * config.on_invalid.hold_s, DMat3::IDENTITY, None));
    assert_eq!(later.source, Source::Recovery);
    assert_eq!((later.command.bank_rad, later.command.climb_rad), (0.0, config.on_invalid.climb_rad));
}

#[test]
fn what_is_not_a_number_is_no_cue_and_no_command() {
    let sectors = view(&ahead(1.0));
    let mut spoilt = sectors.clone();
    for sector in &mut spoilt.sectors {
        sector.nearness_rate_hz = [f64::NAN; 3];
        sector.divergence_hz = f64::NAN;
        sector.flow_rad_s = DVec3::NAN;
    }
    for policy in [Policy::None, Policy::Balance, Policy::Potential, Policy::Heading, Policy::Arc] {
        let mut steering = steering(policy, Danger::Blend);
        let good = observation(0.0, DMat3::IDENTITY, Some(&sectors));
        for o in [
            Observation { time_s: f64::NAN, ..good },
            Observation { ned_from_body: DMat3::NAN, ..good },
            Observation { airspeed_m_s: f64::NAN, ..good },
            Observation { airspeed_m_s: 0.0, ..good },
            Observation { airspeed_m_s: f64::INFINITY, ..good },
        ] {
            assert_ne!(steering.update(&o).source, Source::Cue, "{o:?}");
        }
        let decision = steering.update(&observation(0.1, DMat3::IDENTITY, Some(&spoilt)));
        assert!(decision.command.bank_rad.is_finite() && decision.command.climb_rad.is_finite());
    }
}

#[test]
fn limits_hold_and_parameters_are_checked() {
    let config = SteerParams { max_bank_rad: 0.3, ..SteerParams::default() };
    for policy in [Policy::None, Policy::Balance, Policy::Potential, Policy::Heading, Policy::Arc] {
        let mut steering = Steering::new(SteerParams { policy, ..config }.into()).unwrap();
        let sectors = view(&[(DVec3::new(1.0, 0.0, 4.0), 2.5)]);
        let command = steering.update(&observation(0.0, DMat3::IDENTITY, Some(&sectors))).command;
        assert!(
            command.bank_rad.abs() <= 0.3 && command.climb_rad.abs() <= config.max_climb_rad,
            "{policy:?}"
        );
    }
    let wrong = |change: fn(&mut SteerConfig)| {
        let mut config = SteerConfig::default();
        change(&mut config);
        config
    };
    for (name, config) in [
        ("max_bank_rad", wrong(|config| config.params.max_bank_rad = 2.0)),
        ("latency_s", wrong(|config| config.aircraft.latency_s = -0.1)),
        ("lag_s", wrong(|config| config.aircraft.response.lag_s = f64::INFINITY)),
        ("smoothing", wrong(|config| config.params.smoothing = f64::NAN)),
        ("body_from_camera", wrong(|config| config.aircraft.body_from_camera = 2.0 * DMat3::IDENTITY)),
    ] {
        let error = Steering::new(config).unwrap_err().to_string();
        assert!(error.contains(name) && !error.contains('\n'), "{error}");
    }
}
