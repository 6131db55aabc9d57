//! The rotation between two exposures from a gyro's samples: compared with closed forms and recorded flights, and with
//! bad samples.

use std::path::Path;

use glam::{DMat3, DQuat, DVec3};
use proptest::prelude::*;
use viewsphere::Error;
use viewsphere::imu::{Gyro, GyroConfig, GyroFault, GyroSample};
use viewsphere::io::gyro_log;

use crate::data;

/// A rotation about all axes at once with varying rates: yaw, pitch and roll at a time.
fn angles(t: f64) -> [f64; 3] {
    [0.9 * (1.3 * t).sin() + 0.4 * t, 0.7 * (2.1 * t + 0.3).sin(), 1.1 * (1.7 * t + 1.0).sin()]
}

fn world_from_body(t: f64) -> DMat3 {
    let [yaw, pitch, roll] = angles(t);
    DMat3::from_rotation_z(yaw) * DMat3::from_rotation_y(pitch) * DMat3::from_rotation_x(roll)
}

/// The rates of that motion in the body's frame, by the derivatives of its angles.
fn body_rate_rad_s(t: f64) -> DVec3 {
    let [_, pitch, roll] = angles(t);
    let yaw_rate = 0.9 * 1.3 * (1.3 * t).cos() + 0.4;
    let pitch_rate = 0.7 * 2.1 * (2.1 * t + 0.3).cos();
    let roll_rate = 1.1 * 1.7 * (1.7 * t + 1.0).cos();
    let unroll = DMat3::from_rotation_x(roll).transpose();
    let unpitch = DMat3::from_rotation_y(pitch).transpose();
    unroll * (unpitch * DVec3::Z * yaw_rate + DVec3::Y * pitch_rate) + DVec3::X * roll_rate
}

fn angle_rad(a: DMat3, b: DMat3) -> f64 {
    // Of a small angle the sine is exact where the cosine is not.
    let m = a.transpose() * b;
    let twice_sine = DVec3::new(m.y_axis.z - m.z_axis.y, m.z_axis.x - m.x_axis.z, m.x_axis.y - m.y_axis.x);
    let twice_cosine = m.x_axis.x + m.y_axis.y + m.z_axis.z - 1.0;
    twice_sine.length().atan2(twice_cosine)
}

fn filled(config: GyroConfig, rate_hz: f64, rate: impl Fn(f64) -> DVec3) -> Gyro {
    let mut gyro = Gyro::new(config).unwrap();
    for i in 0..=(3.0 * rate_hz) as u32 {
        let time_s = f64::from(i) / rate_hz;
        gyro.push(GyroSample { time_s, gyro_rad_s: rate(time_s) });
    }
    gyro
}

/// The largest error of the rotations between frames at 30 Hz, radians.
fn worst_error_rad(gyro: &Gyro) -> f64 {
    let times = (0..80).map(|i| 0.0107 + f64::from(i) / 30.0);
    let error = |t: f64| {
        let truth = world_from_body(t).transpose() * world_from_body(t + 1.0 / 30.0);
        angle_rad(truth, gyro.prev_from_cur(t, t + 1.0 / 30.0).unwrap())
    };
    times.map(error).fold(0.0, f64::max)
}

#[test]
fn a_motion_about_changing_axes_is_integrated_to_the_second_order() {
    let errors = [100.0, 200.0, 400.0, 800.0]
        .map(|rate_hz| worst_error_rad(&filled(GyroConfig::default(), rate_hz, body_rate_rad_s)));
    println!("worst errors per frame at 100, 200, 400, 800 Hz: {errors:?} rad");
    // h² Δt/12 of the second derivative, which is under 20 rad/s³ here: 1.4e-6 rad at 200 Hz.
    assert!(errors[1] < 1.4e-6, "{errors:?}");
    for pair in errors.windows(2) {
        assert!((3.0..5.0).contains(&(pair[0] / pair[1])), "a quarter at half the distance: {errors:?}");
    }
}

#[test]
fn rates_that_run_straight_are_integrated_to_the_fourth_order() {
    let rate = |t: f64| DVec3::new(1.0 - 2.0 * t, 0.5 + 3.0 * t, -2.0 + t);
    let truth = filled(GyroConfig { history: 1 << 20, ..GyroConfig::default() }, 10_000.0, rate);
    let error = |rate_hz| {
        let coarse = filled(GyroConfig::default(), rate_hz, rate);
        angle_rad(truth.prev_from_cur(0.0, 3.0).unwrap(), coarse.prev_from_cur(0.0, 3.0).unwrap())
    };
    let errors = [25.0, 50.0, 100.0].map(error);
    for pair in errors.windows(2) {
        assert!((12.0..20.0).contains(&(pair[0] / pair[1])), "a sixteenth at half the distance: {errors:?}");
    }
    assert!(errors[0] < 1e-5, "{errors:?}");
}

#[test]
fn bias_offset_and_mounting_are_taken_into_account() {
    let bias_rad_s = DVec3::new(0.02, -0.03, 0.05);
    let camera_from_gyro =
        DMat3::from_quat(DQuat::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 1.9));
    let config = GyroConfig { bias_rad_s, time_offset_s: 0.25, camera_from_gyro, ..GyroConfig::default() };
    // The gyro's clock is a quarter of a second behind: its time t is t + 0.25 of the camera's clock.
    let to_gyro = camera_from_gyro.transpose();
    let gyro = filled(config, 400.0, |t| to_gyro * body_rate_rad_s(t + 0.25) + bias_rad_s);
    for t in [0.3, 1.0, 2.2] {
        let truth = world_from_body(t).transpose() * world_from_body(t + 0.04);
        let found = gyro.prev_from_cur(t, t + 0.04).unwrap();
        assert!(angle_rad(truth, found) < 1e-6);
        let mean = gyro.mean_rate_rad_s(t, t + 0.04).unwrap();
        // Simpson's rule of the true rates.
        let expected =
            (body_rate_rad_s(t) + 4.0 * body_rate_rad_s(t + 0.02) + body_rate_rad_s(t + 0.04)) / 6.0;
        assert!((mean - expected).length() < 1e-4, "{mean} {expected}");
    }
    assert!(matches!(gyro.prev_from_cur(0.24, 0.3), Err(GyroFault::NotCovered { .. })));
}

#[test]
fn rotations_of_neighbouring_intervals_add_up() {
    let gyro = filled(GyroConfig::default(), 200.0, body_rate_rad_s);
    let turn = |a, b| gyro.prev_from_cur(a, b).unwrap();
    let parts = turn(0.1, 0.1234) * turn(0.1234, 0.2) * turn(0.2, 0.33);
    assert!(angle_rad(parts, turn(0.1, 0.33)) < 1e-9);
    assert!(angle_rad(turn(0.5, 0.5), DMat3::IDENTITY) < 1e-15);
    assert!(gyro.mean_rate_rad_s(0.5, 0.5).is_err());
}

/// A gyro with samples at these times, each with a rate of 1 rad/s about the axis down.
fn at(times: &[f64]) -> Gyro {
    let mut gyro = Gyro::new(GyroConfig::default()).unwrap();
    for &time_s in times {
        gyro.push(GyroSample { time_s, gyro_rad_s: DVec3::Y });
    }
    gyro
}

#[test]
fn what_is_not_covered_is_a_fault_with_its_reason() {
    let said = |gyro: &Gyro, a, b| gyro.prev_from_cur(a, b).unwrap_err().to_string();
    assert_eq!(said(&at(&[]), 0.0, 0.1), "no gyro sample has arrived");
    let gyro = at(&[1.0, 1.01, 1.02, 1.1, 1.11]);
    let text =
        "1.000000 s to 1.120000 s is not covered by gyro samples, which reach from 1.000000 s to 1.110000 s";
    assert_eq!(said(&gyro, 1.0, 1.12), text);
    let text = "no gyro sample between 1.020000 s and 1.100000 s, a gap of at most 0.05 s is allowed";
    assert_eq!(said(&gyro, 1.015, 1.105), text);
    assert!(gyro.prev_from_cur(1.0, 1.02).is_ok() && gyro.prev_from_cur(1.1, 1.11).is_ok());
    let text = "frame at 1.000000 s follows one at 1.010000 s, times must rise";
    assert_eq!(said(&gyro, 1.01, 1.0), text);
    for (a, b) in [(f64::NAN, 1.0), (1.0, f64::NAN), (f64::NEG_INFINITY, f64::INFINITY)] {
        assert!(gyro.prev_from_cur(a, b).is_err());
    }
}

#[test]
fn a_sample_that_is_no_number_spoils_what_it_touches_and_no_more() {
    let mut gyro = at(&[1.00, 1.01]);
    gyro.push(GyroSample { time_s: 1.02, gyro_rad_s: DVec3::new(0.0, f64::NAN, 0.0) });
    // No valid sample has arrived since: the reason is the bad sample, not a late gyro.
    assert_eq!(gyro.prev_from_cur(1.0, 1.02), Err(GyroFault::NotANumber { time_s: 1.02 }));
    for time_s in [1.03, 1.04] {
        gyro.push(GyroSample { time_s, gyro_rad_s: DVec3::Y });
    }
    for (from, to) in [(1.005, 1.015), (1.0, 1.04), (1.02, 1.03)] {
        assert_eq!(gyro.prev_from_cur(from, to), Err(GyroFault::NotANumber { time_s: 1.02 }));
    }
    assert!(gyro.prev_from_cur(1.0, 1.01).is_ok());
    assert!(gyro.prev_from_cur(1.03, 1.04).is_ok());
    gyro.push(GyroSample { time_s: f64::NAN, gyro_rad_s: DVec3::Y });
    gyro.push(GyroSample { time_s: 1.05, gyro_rad_s: DVec3::Y });
    assert_eq!(gyro.prev_from_cur(1.04, 1.05), Err(GyroFault::NotANumber { time_s: 1.04 }));
}

#[test]
fn a_sample_that_runs_backwards_spoils_what_it_touches_and_no_more() {
    let gyro = at(&[1.00, 1.01, 1.02, 1.015, 1.03, 1.04]);
    let fault = Err(GyroFault::Backwards { time_s: 1.015, after_s: 1.02 });
    // Whether 1.02 or 1.015 is wrong is unknown: both sides of 1.02 are invalid.
    assert_eq!(gyro.prev_from_cur(1.012, 1.018), fault);
    assert_eq!(gyro.prev_from_cur(1.022, 1.028), fault);
    assert!(gyro.prev_from_cur(1.00, 1.01).is_ok());
    assert!(gyro.prev_from_cur(1.03, 1.04).is_ok());
    assert_eq!(
        gyro.prev_from_cur(1.022, 1.028).unwrap_err().to_string(),
        "a gyro sample of 1.015000 s came after one of 1.020000 s, times must rise"
    );
    assert!(at(&[1.00, 1.01, 1.01, 1.02]).prev_from_cur(1.0, 1.02).is_ok(), "the same sample twice");
}

#[test]
fn a_time_far_ahead_is_forgotten_by_the_second_sample_behind_it() {
    let gyro = at(&[1.00, 1.01, 900.0, 1.02, 1.03, 1.04]);
    assert!(gyro.prev_from_cur(1.00, 1.01).is_ok());
    assert!(matches!(gyro.prev_from_cur(1.01, 1.02), Err(GyroFault::Backwards { .. })));
    assert!(gyro.prev_from_cur(1.02, 1.04).is_ok());
}

#[test]
fn a_clock_that_is_set_back_counts_from_then_on() {
    let gyro = at(&[700.0, 700.01, 700.02, 0.0, 0.01, 0.02]);
    assert!(gyro.prev_from_cur(0.0, 0.02).is_ok());
    assert!(matches!(gyro.prev_from_cur(700.0, 700.01), Err(GyroFault::NotCovered { .. })));
}

#[test]
fn the_oldest_samples_go() {
    let mut gyro = Gyro::new(GyroConfig { history: 16, ..GyroConfig::default() }).unwrap();
    for i in 0..10_000 {
        gyro.push(GyroSample { time_s: f64::from(i) * 0.01, gyro_rad_s: DVec3::Y });
    }
    assert!(gyro.prev_from_cur(99.84, 99.99).is_ok());
    assert!(matches!(gyro.prev_from_cur(99.83, 99.99), Err(GyroFault::NotCovered { .. })));
}

fn decode(text: &str) -> viewsphere::Result<Vec<GyroSample>> {
    gyro_log::decode(Path::new("g.csv"), text.as_bytes())
}

#[test]
fn logs_in_use_are_read() {
    let ours =
        "time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s\r\n0.5,1,2,3\r\n\r\n0.6,nan,2,3\r\n0.1,1,-inf,3\r\n";
    let samples = decode(ours).unwrap();
    assert_eq!(samples[0], GyroSample { time_s: 0.5, gyro_rad_s: DVec3::new(1.0, 2.0, 3.0) });
    assert!(samples.len() == 3 && samples[1].gyro_rad_s.x.is_nan() && samples[2].time_s == 0.1);
    assert_eq!(decode("0.5, 1, 2, 3").unwrap(), samples[..1]);
    let euroc = "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],a_RS_S_x [m s^-2],\
                 a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n500000000,1,2,3,9,9,9\n";
    assert_eq!(decode(euroc).unwrap(), samples[..1]);
    let degrees = decode("\u{feff}time_s,gyro_x_deg_s,gyro_y_deg_s,gyro_z_deg_s\n0.5,180,0,-90\n").unwrap();
    let expected = DVec3::new(std::f64::consts::PI, 0.0, -std::f64::consts::FRAC_PI_2);
    assert!((degrees[0].gyro_rad_s - expected).length() < 1e-15);
}

#[test]
fn logs_that_are_not_logs_are_errors_that_name_the_line() {
    for (text, message) in [
        ("", "g.csv: number of gyro samples is 0, expected at least 1"),
        ("1,2,3,4\n1,2,3\n", "g.csv: gyro log is \"1,2,3\" in line 2, expected 4 numbers, comma-separated"),
        (
            "1,2,3,4\n\n1,2,x,4\n",
            "g.csv: gyro log is \"1,2,x,4\" in line 3, expected 4 numbers, comma-separated",
        ),
        ("1,2,3,4,5\n", "g.csv: gyro log is \"1,2,3,4,5\" in line 1, expected 4 numbers, comma-separated"),
    ] {
        assert_eq!(decode(text).unwrap_err().to_string(), message);
    }
    let no_gyro = decode("time_s,a_x,a_y,a_z\n").unwrap_err().to_string();
    assert!(no_gyro.contains("line 1, expected time_s,gyro_x_rad_s"), "{no_gyro}");
    let long = decode(&format!("1,2,3,4\n{}\n", "9".repeat(5000))).unwrap_err().to_string();
    assert!(long.contains("line 2") && long.len() < 120, "{long}");
    assert!(matches!(gyro_log::read("/nonexistent/gyro.csv"), Err(Error::Io { .. })));
}

/// Numbers of a line, the first of which are nanoseconds.
fn numbers(line: &str) -> Vec<f64> {
    line.split(',').map(|field| field.trim().parse().unwrap()).collect()
}

#[test]
fn a_recorded_flight_agrees_with_motion_capture() {
    let Some(folder) = data::set("euroc_v101") else { return };
    let camera = std::fs::read_to_string(folder.join("cam0_sensor.yaml")).unwrap();
    let extrinsics = camera.split_once("data: [").unwrap().1.split_once(']').unwrap().0;
    let t: Vec<f64> = extrinsics.split(',').map(|e| e.trim().parse().unwrap()).collect();
    // T_BS takes the camera's frame to the body's, which is the gyro's: its rows are the columns of the inverse.
    let camera_from_gyro = DMat3::from_cols(
        DVec3::new(t[0], t[1], t[2]),
        DVec3::new(t[4], t[5], t[6]),
        DVec3::new(t[8], t[9], t[10]),
    );
    let truth = std::fs::read_to_string(folder.join("derived_groundtruth_slice.csv")).unwrap();
    let truth: Vec<Vec<f64>> = truth.lines().skip(1).map(numbers).collect();
    let bias_rad_s = DVec3::from_slice(&truth[0][11..14]);
    let config = GyroConfig { bias_rad_s, camera_from_gyro, ..GyroConfig::default() };
    let mut gyro = Gyro::new(config).unwrap();
    gyro_log::read(folder.join("derived_imu0_slice.csv"))
        .unwrap()
        .into_iter()
        .for_each(|sample| gyro.push(sample));

    let mut frames: Vec<f64> = std::fs::read_dir(folder.join("cam0"))
        .unwrap()
        .map(|entry| entry.unwrap().path().file_stem().unwrap().to_str().unwrap().parse().unwrap())
        .collect();
    frames.sort_by(f64::total_cmp);
    let world_from_camera = |time_ns: f64| {
        // The two files round their nanoseconds differently.
        let row = truth.iter().find(|row| (row[0] - time_ns).abs() < 1e3).unwrap();
        let [w, x, y, z] = [row[4], row[5], row[6], row[7]];
        DMat3::from_quat(DQuat::from_xyzw(x, y, z, w).normalize()) * camera_from_gyro.transpose()
    };
    let errors_deg: Vec<f64> = frames
        .windows(2)
        .map(|pair| {
            let expected = world_from_camera(pair[0]).transpose() * world_from_camera(pair[1]);
            let found = gyro.prev_from_cur(pair[0] / 1e9, pair[1] / 1e9).unwrap();
            angle_rad(expected, found).to_degrees()
        })
        .collect();
    println!("degrees per frame: {errors_deg:.4?}");
    assert_eq!(errors_deg.len(), 9);
    // The noise of the gyro and the motion capture together is half of this.
    assert!(errors_deg.iter().all(|error| *error <= 0.02), "{errors_deg:?}");
}

fn any_sample() -> impl Strategy<Value = GyroSample> {
    let number = prop_oneof![8 => -10.0..10.0_f64, 1 => any::<f64>()];
    (number.clone(), number.clone(), number.clone(), number)
        .prop_map(|(t, x, y, z)| GyroSample { time_s: t, gyro_rad_s: DVec3::new(x, y, z) })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_samples_panic_and_every_answer_is_a_rotation(
        samples in prop::collection::vec(any_sample(), 0..60),
        sorted in any::<bool>(),
        from in -10.0..10.0_f64,
        length in 0.0..1.0_f64,
    ) {
        let mut samples = samples;
        if sorted {
            samples.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
        }
        let config = GyroConfig { max_gap_s: 5.0, history: 32, ..GyroConfig::default() };
        let mut gyro = Gyro::new(config).unwrap();
        for sample in samples {
            gyro.push(sample);
            if let Ok(turn) = gyro.prev_from_cur(from, from + length) {
                let off = turn * turn.transpose() - DMat3::IDENTITY;
                prop_assert!(off.to_cols_array().iter().all(|e| e.abs() <= 1e-12));
                prop_assert!((turn.determinant() - 1.0).abs() <= 1e-12);
            }
            let _ = gyro.mean_rate_rad_s(from, from + length);
        }
    }

    #[test]
    fn noise_in_place_of_a_log_never_panics(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let _ = gyro_log::decode(Path::new("g.csv"), &bytes[..]);
    }

    #[test]
    fn damaged_logs_never_panic(text in "[0-9.,#a-z \n\\[\\]()_-]{0,200}") {
        let _ = decode(&format!("#timestamp [ns],gx,gy,gz\n{text}"));
        let _ = decode(&text);
    }
}

proptest! {
    // Each case waits until it is on the disk: a few of many samples.
    #![proptest_config(ProptestConfig { cases: 16, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_log_keeps_every_number_to_the_last_bit(samples in prop::collection::vec(any_sample(), 1..400)) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("gyro.csv");
        gyro_log::write(&path, &samples).unwrap();
        let back = gyro_log::read(&path).unwrap();
        prop_assert_eq!(back.len(), samples.len());
        for (a, b) in samples.iter().zip(&back) {
            let bits = |s: &GyroSample| {
                let DVec3 { x, y, z } = s.gyro_rad_s;
                // The bits of a NaN are not written.
                [s.time_s, x, y, z].map(|v| if v.is_nan() { f64::NAN.to_bits() } else { v.to_bits() })
            };
            prop_assert_eq!(bits(a), bits(b));
        }
    }
}
