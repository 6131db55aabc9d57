//! Steady wind and gusts.

use viewsphere::sim::vehicle::{Gusts, STEP_S, Vehicle, Wind};

use super::*;

const AWAY: DVec3 = DVec3::new(4.0, -3.0, 0.0);

/// A flight in a steady wind is the one in calm air, carried along.
#[test]
fn a_steady_wind_carries_the_flight_along() {
    let blown = |wind: DVec3| -> [Vec<VehicleState>; 2] {
        let wind = || Wind::new(wind, None, 0).unwrap();
        let vehicles: [Box<dyn Vehicle>; 2] =
            [Box::new(airframe(12.0, wind())), Box::new(turner(12.0, wind()))];
        vehicles.map(|mut vehicle| fly(vehicle.as_mut(), &bank(45.0), 8.0))
    };
    for (windy, calm) in blown(AWAY).into_iter().flatten().zip(blown(DVec3::ZERO).into_iter().flatten()) {
        // Rounding only.
        let off = windy.position_ned_m - calm.position_ned_m - AWAY * calm.time_s;
        assert!(off.length() <= 1e-9, "{off}");
        assert!((windy.velocity_ned_m_s - calm.velocity_ned_m_s - AWAY).length() <= 1e-10);
        assert!((windy.air_velocity_body_m_s - calm.air_velocity_body_m_s).length() <= 1e-10);
    }
}

/// The airframe's climb is relative to the ground, as a barometer measures it; the coordinated turn's is relative to
/// the air.
#[test]
fn an_updraught_lifts_the_point_and_not_the_airframe() {
    let up = || Wind::new(DVec3::new(0.0, 0.0, -1.0), None, 0).unwrap();
    let climbed_m = |states: Vec<VehicleState>| height_m(&states[2399]) - height_m(&states[1199]);
    near("point", climbed_m(fly(&mut turner(12.0, up()), &bank(0.0), 10.0)), 5.0, 1e-9);
    // A proportional loop: 0.1° of a climb at 12 m/s are 0.02 m/s.
    near("airframe", climbed_m(fly(&mut airframe(12.0, up()), &bank(0.0), 10.0)), 0.0, 0.2);
}

#[test]
fn gusts_have_their_deviation_and_their_length() {
    let gusts = Gusts::MODERATE;
    let mut wind = Wind::new(AWAY, Some(gusts), 7).unwrap();
    let count = 200_000;
    let step_m = 25.0;
    let drawn: Vec<DVec3> = (0..count)
        .map(|_| {
            wind.advance(step_m);
            (wind.ned_m_s() - AWAY) / gusts.intensity_m_s
        })
        .collect();
    let n = f64::from(count);
    let mean = drawn.iter().sum::<DVec3>() / n;
    let square = drawn.iter().map(|gust| gust * gust).sum::<DVec3>() / n;
    let neighbours = drawn.windows(2).map(|pair| pair[0] * pair[1]).sum::<DVec3>() / n;
    let apart = drawn.iter().map(|gust| gust.x * gust.y).sum::<f64>() / n;
    for axis in 0..3 {
        let alike = (-step_m / gusts.length_m[axis]).exp();
        // Neighbouring draws correlate: the number of independent ones, for the mean and for squares.
        let fresh = n * (1.0 - alike) / (1.0 + alike);
        let fresh_squares = n * (1.0 - alike * alike) / (1.0 + alike * alike);
        // Five standard deviations of each estimate.
        near("mean", mean[axis], 0.0, 5.0 / fresh.sqrt());
        near("variance", square[axis], 1.0, 5.0 * (2.0 / fresh_squares).sqrt());
        near("correlation", neighbours[axis], alike, 5.0 * (2.0 / fresh_squares).sqrt());
    }
    let alike = (-step_m / 200.0_f64).exp();
    near("north with east", apart, 0.0, 5.0 / (n * (1.0 - alike * alike) / (1.0 + alike * alike)).sqrt());
}

/// The step does not affect a gust's statistics: many small steps equal one large one.
#[test]
fn many_small_steps_are_alike_as_one_large_one() {
    let gusts = Gusts { intensity_m_s: DVec3::ONE, length_m: DVec3::splat(50.0) };
    let mut product = 0.0;
    let count = 20_000;
    for seed in 0..count {
        let mut wind = Wind::new(DVec3::ZERO, Some(gusts), seed).unwrap();
        let before = wind.ned_m_s();
        (0..50).for_each(|_| wind.advance(0.5));
        product += before.dot(wind.ned_m_s()) / 3.0;
    }
    // Five standard deviations of the mean of three independent axes, each at most √2.
    near("correlation", product / count as f64, (-0.5_f64).exp(), 5.0 * (2.0 / (3.0 * count as f64)).sqrt());
}

#[test]
fn a_seed_is_a_wind_and_another_seed_another() {
    let flown = |seed| {
        let wind = Wind::new(AWAY, Some(Gusts::LIGHT), seed).unwrap();
        *fly(&mut airframe(12.0, wind), &bank(20.0), 5.0).last().unwrap()
    };
    assert_eq!(flown(1), flown(1));
    assert!((flown(1).position_ned_m - flown(2).position_ned_m).length() > 0.1);
}

/// Gusts change with the distance flown through the air.
#[test]
fn both_vehicles_meet_the_gusts_of_their_way() {
    let wind = Wind::new(AWAY, Some(Gusts::MODERATE), 5).unwrap();
    let vehicles: [Box<dyn Vehicle>; 2] =
        [Box::new(airframe(12.0, wind.clone())), Box::new(turner(12.0, wind.clone()))];
    for mut vehicle in vehicles {
        let mut wind = wind.clone();
        let first = wind.ned_m_s();
        for _ in 0..2400 {
            wind.advance(vehicle.state().air_velocity_body_m_s.length() * STEP_S);
            vehicle.advance(&bank(30.0), STEP_S);
            let state = vehicle.state();
            let met = state.velocity_ned_m_s - state.world_from_body * state.air_velocity_body_m_s;
            assert!((met - wind.ned_m_s()).length() <= 1e-9, "{met} at {} s", state.time_s);
        }
        assert!((wind.ned_m_s() - first).length() > 0.1);
    }
}

/// A minute of slalom in moderate gusts: the loop stays stable.
#[test]
fn the_airframe_flies_in_gusts() {
    for seed in 0..4 {
        let wind = Wind::new(AWAY, Some(Gusts::MODERATE), seed).unwrap();
        let mut plane = airframe(14.0, wind);
        while plane.state().time_s < 60.0 {
            let command = slalom(plane.state().time_s);
            plane.advance(&command, STEP_S);
            let state = plane.state();
            let speed = state.air_velocity_body_m_s.length();
            assert!((9.0..19.0).contains(&speed) && bank_deg(&state).abs() < 70.0, "seed {seed}: {state:?}");
            assert!((height_m(&state) - 50.0).abs() < 20.0, "seed {seed}: {state:?}");
        }
    }
}

#[test]
fn what_is_no_wind_is_refused() {
    assert!(Wind::new(DVec3::NAN, None, 0).is_err());
    assert!(Wind::new(DVec3::X * 100.0, None, 0).is_ok());
    let text = Wind::new(DVec3::X * 1e9, None, 0).unwrap_err().to_string();
    assert_eq!(text, "steady_ned_m_s is 1000000000, expected -100 to 100");
    let wrong = [
        Gusts { intensity_m_s: DVec3::new(1.0, -1.0, 1.0), ..Gusts::LIGHT },
        Gusts { length_m: DVec3::new(1.0, 1.0, 0.0), ..Gusts::LIGHT },
        Gusts { length_m: DVec3::NAN, ..Gusts::LIGHT },
    ];
    for gusts in wrong {
        assert!(Wind::new(DVec3::ZERO, Some(gusts), 0).is_err());
    }
}
