//! On-board measurements, compared with the true state.

use glam::{DMat3, DQuat};
use viewsphere::camera::FRD_FROM_CAMERA;
use viewsphere::imu::{Gyro, GyroConfig};
use viewsphere::sim::vehicle::{
    AirspeedModel, GyroErrors, GyroModel, STEP_S, VaneErrors, VaneModel, Vehicle, Wind,
};

use super::*;

/// A gyro after a slalom, and the states after each step.
fn flight(vehicle: &mut dyn Vehicle, errors: &GyroErrors, seed: u64) -> (Gyro, Vec<VehicleState>) {
    let mut gyro =
        Gyro::new(GyroConfig { camera_from_gyro: FRD_FROM_CAMERA.transpose(), ..GyroConfig::default() })
            .unwrap();
    let mut model = GyroModel::new(errors, seed).unwrap();
    let mut states = vec![vehicle.state()];
    gyro.push(model.sample(&states[0]));
    for step in 0..12 * 240 {
        vehicle.advance(&slalom(f64::from(step) * STEP_S), STEP_S);
        states.push(vehicle.state());
        gyro.push(model.sample(&vehicle.state()));
    }
    (gyro, states)
}

/// The error of the gyro's rotation between two states, compared with the camera's true one: a rotation vector in
/// radians.
fn error_rad(gyro: &Gyro, from: &VehicleState, to: &VehicleState) -> DVec3 {
    let measured = gyro.prev_from_cur(from.time_s, to.time_s).unwrap();
    let truth: DMat3 = from.camera_pose().world_from_camera.transpose() * to.camera_pose().world_from_camera;
    DQuat::from_mat3(&(measured * truth.transpose())).to_scaled_axis()
}

#[test]
fn a_gyro_without_errors_gives_the_rotation_back() {
    let (gyro, states) = flight(&mut airframe(12.0, Wind::calm()), &GyroErrors::NONE, 0);
    for pair in states.windows(9).step_by(8) {
        let error = error_rad(&gyro, &pair[0], &pair[8]).length();
        // Linear between samples: h² T/12 of the rates' second derivative, some 300 rad/s³ where commands change.
        assert!(error <= 2e-5, "{error} rad at {} s", pair[0].time_s);
    }
    let (gyro, states) = flight(&mut turner(12.0, Wind::calm()), &GyroErrors::NONE, 0);
    for pair in states.windows(9).step_by(8) {
        let error = error_rad(&gyro, &pair[0], &pair[8]).length();
        assert!(error <= 2e-5, "{error} rad at {} s", pair[0].time_s);
    }
}

#[test]
fn noise_adds_up_as_its_density_says() {
    let errors = GyroErrors { bias_walk_rad_s2_rthz: 0.0, ..GyroErrors::default() };
    let (mut of_frames, mut of_flights, mut flights) = (0.0, 0.0, 0.0);
    let mut frames = 0.0;
    for seed in 0..40 {
        let (gyro, states) = flight(&mut turner(12.0, Wind::calm()), &errors, seed);
        of_flights += error_rad(&gyro, &states[0], &states[2880]).length_squared() / 3.0;
        flights += 3.0;
        for pair in states.windows(9).step_by(8) {
            of_frames += error_rad(&gyro, &pair[0], &pair[8]).length_squared() / 3.0;
            frames += 3.0;
        }
    }
    // The density times √T, and variances within five standard deviations of theirs.
    let density = 3.4e-4_f64;
    let flight_variance = of_flights / (flights / 3.0) / (density * density * 12.0);
    near("flight", flight_variance, 1.0, 5.0 * (2.0_f64 / flights).sqrt());
    // The samples at both ends of a frame count half each, so that seven and two halves make 7.5 of eight.
    let frame_variance = of_frames / (frames / 3.0) / (density * density / 30.0);
    near("frame", frame_variance, 7.5 / 8.0, 5.0 * (2.0_f64 / frames).sqrt());
}

#[test]
fn white_noise_over_frames_and_bias_are_as_asked() {
    let noise = 0.2_f64.to_radians();
    let bias = 0.1_f64.to_radians();
    let errors = GyroErrors::over_frames(noise, 1.0 / 30.0, bias);
    let mut gyro = GyroModel::new(&errors, 3).unwrap();
    let mut state = turner(12.0, Wind::calm()).state();
    let count = 20_000;
    let (mut sum, mut square) = (DVec3::ZERO, DVec3::ZERO);
    for frame in 0..count {
        let mut mean = DVec3::ZERO;
        for step in 1..=8 {
            state.time_s = f64::from(8 * frame + step) * STEP_S;
            mean += gyro.sample(&state).gyro_rad_s / 8.0;
        }
        sum += mean;
        square += (mean - DVec3::splat(bias)) * (mean - DVec3::splat(bias));
    }
    let n = f64::from(count);
    for axis in 0..3 {
        near("bias", sum[axis] / n, bias, 5.0 * noise / n.sqrt());
        near("noise", (square[axis] / n).sqrt() / noise, 1.0, 5.0 / (2.0 * n).sqrt());
    }
}

#[test]
fn the_bias_walks() {
    let errors = GyroErrors { noise_rad_s_rthz: 0.0, ..GyroErrors::default() };
    let count = 2000;
    let mut square = 0.0;
    for seed in 0..count {
        let mut gyro = GyroModel::new(&errors, seed).unwrap();
        let mut state = turner(12.0, Wind::calm()).state();
        let first = gyro.sample(&state).gyro_rad_s;
        for step in 1..=100 {
            state.time_s = 0.1 * f64::from(step);
            gyro.sample(&state);
        }
        square += (gyro.sample(&state).gyro_rad_s - first).length_squared();
    }
    // The density times √T after ten seconds; the axes are independent.
    let variance = square / (3.0 * count as f64) / (3.9e-5_f64.powi(2) * 10.0);
    near("variance", variance, 1.0, 5.0 * (2.0 / (3.0 * count as f64)).sqrt());
}

#[test]
fn airspeed_is_wrong_by_the_same_share_all_the_way() {
    let shares: Vec<f64> = (0..2000)
        .map(|seed| {
            let sensor = AirspeedModel::new(AirspeedModel::USUAL, seed).unwrap();
            let share =
                |speed_m_s: f64| sensor.speed_m_s(&turner(speed_m_s, Wind::calm()).state()) / speed_m_s;
            near("share", share(9.0), share(16.0), 1e-12);
            share(12.0) - 1.0
        })
        .collect();
    assert!(shares.iter().all(|share| share.abs() <= 0.03));
    let n = shares.len() as f64;
    // Uniform over ±3 %: a standard deviation of 3 %/√3.
    near("mean", shares.iter().sum::<f64>() / n, 0.0, 5.0 * 0.03 / (3.0 * n).sqrt());
    assert!(shares.iter().any(|share| *share > 0.028) && shares.iter().any(|share| *share < -0.028));
    assert!(AirspeedModel::new(-0.1, 0).is_err() && AirspeedModel::new(f64::NAN, 0).is_err());
}

#[test]
fn vanes_show_where_the_air_comes_from() {
    let mut plane = airframe(12.0, Wind::calm());
    let state = *fly(&mut plane, &bank(60.0), 1.0).last().unwrap();
    let truth = state.air_velocity_body_m_s.normalize();
    let direction = VaneModel::new(&VaneErrors::NONE, 0).unwrap().direction_body(&state);
    assert!((direction - truth).length() <= 1e-12);

    let errors = VaneErrors::default();
    let (mut fixed, mut jitter) = (0.0, 0.0);
    let (models, times) = (2000, 20);
    for seed in 0..models {
        let mut vanes = VaneModel::new(&errors, seed).unwrap();
        let shown: Vec<DVec3> = (0..times).map(|_| vanes.direction_body(&state)).collect();
        let mean = shown.iter().sum::<DVec3>() / times as f64;
        fixed += (mean - truth).length_squared() / 2.0;
        jitter +=
            shown.iter().map(|one| (one - mean).length_squared() / 2.0).sum::<f64>() / (times - 1) as f64;
    }
    let [fixed, jitter] = [fixed, jitter].map(|sum: f64| (sum / models as f64).sqrt());
    // Five standard deviations of 4000 draws are 6 %; that the angles are large adds less than 1 %.
    near("fixed", fixed / errors.fixed_rad, 1.0, 0.06);
    near("jitter", jitter / errors.jitter_rad, 1.0, 0.06);
    assert!(VaneModel::new(&VaneErrors { fixed_rad: -1.0, ..errors }, 0).is_err());
}
