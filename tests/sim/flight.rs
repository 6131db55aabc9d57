//! The closed loop: it flies, it is deterministic bit for bit, and it reports a fault within a frame.

use glam::{DMat3, DVec3};
use viewsphere::Backend;
use viewsphere::sim::flight::{Body, Fault, Flight, FlightConfig, Outcome, Record, Sensor, Summary};
use viewsphere::sim::vehicle::VerticalSpeedErrors;
use viewsphere::sim::{Course, CourseKind, Surface};
use viewsphere::steer::{Danger, Policy, Source};

use crate::need;

const CPU: [Backend; 2] = [Backend::Cpu, Backend::Cpu];

fn course(name: &str, seed: u64) -> Course {
    name.parse::<CourseKind>().unwrap().course(seed).unwrap()
}

fn config(sensor: Sensor) -> FlightConfig {
    FlightConfig { sensor, ..FlightConfig::default() }
}

/// Flies for at most `frames` frames.
fn records(backends: [Backend; 2], course: &Course, config: &FlightConfig, frames: usize) -> Vec<Record> {
    let mut flight = Flight::new(backends, course, config).unwrap();
    let mut records = Vec::new();
    while records.len() < frames {
        let summary = flight.step(|seen| {
            records.push(seen.record.clone());
            Ok(())
        });
        if summary.unwrap().is_some() {
            break;
        }
    }
    records
}

fn fly(course: &Course, config: &FlightConfig) -> Summary {
    Flight::new(CPU, course, config).unwrap().fly(|_| Ok(())).unwrap()
}

#[test]
fn what_sees_flies_past_the_wall_and_what_does_not_hits_it() {
    let wall = course("wall", 3);
    for sensor in [Sensor::Depth, Sensor::Flow, Sensor::NoisyFlow] {
        let summary = fly(&wall, &config(sensor));
        assert_eq!(summary.outcome, Outcome::Reached, "{sensor:?}: {summary:?}");
        // With noise some flights circle once before they pass: that alone is 50 m.
        let least = if sensor == Sensor::NoisyFlow { 0.5 } else { 0.7 };
        assert!(summary.least_clearance_m > 0.6 && summary.efficiency() > least, "{summary:?}");
    }
    let mut blind = config(Sensor::Depth);
    blind.steer.policy = Policy::None;
    let summary = fly(&course("wall:offset=0", 3), &blind);
    assert_eq!(summary.outcome, Outcome::Crashed, "{summary:?}");
    assert!(summary.progress_m > 50.0 && summary.least_clearance_m <= 0.6, "{summary:?}");
}

/// Two walls in a row: a flight that is flown on touches both, and what it counts has no part in where it flies.
#[test]
fn what_is_flown_on_counts_every_touch() {
    let wall = |north_m: f64| {
        Surface::cuboid(DVec3::new(north_m, 0.0, -10.0), DMat3::IDENTITY, DVec3::new(0.5, 40.0, 20.0))
            .unwrap()
    };
    let mut twice = course("wall:distance=40:width=40:incidence=0:offset=0:past=40", 3);
    twice.world.surfaces.push(wall(60.0));
    let mut ends = config(Sensor::Depth);
    ends.steer.policy = Policy::None;
    let on = FlightConfig { fly_on: true, ..ends.clone() };
    let [ended, flown] = [&ends, &on].map(|config| fly(&twice, config));
    assert_eq!((ended.outcome, ended.touches), (Outcome::Crashed, 1));
    assert_eq!((flown.outcome, flown.touches), (Outcome::Crashed, 2), "{flown:?}");
    assert!(ended.progress_m < 40.0 && flown.progress_m >= 80.0, "{} {}", ended.progress_m, flown.progress_m);
    assert_eq!((flown.optimality(), flown.goal_speed_m_s(), flown.progress()), (None, None, 1.0));
    let [before, same] = [&ends, &on].map(|config| records(CPU, &twice, config, 60));
    assert_eq!(before, same);
    // Without a touch nothing differs.
    let free = course("wall", 3);
    let [ended, flown] =
        [false, true].map(|fly_on| fly(&free, &FlightConfig { fly_on, ..config(Sensor::Depth) }));
    assert_eq!(ended, flown);
    let [optimality, speed_m_s] = [ended.optimality().unwrap(), ended.goal_speed_m_s().unwrap()];
    assert!(
        (-0.01..0.2).contains(&optimality) && (9.0..12.5).contains(&speed_m_s),
        "{optimality} {speed_m_s}"
    );
}

#[test]
fn each_policy_but_the_potential_field_flies_a_corridor_of_true_depth() {
    // A potential field oscillates between the walls until it touches one.
    for policy in [Policy::Balance, Policy::Heading, Policy::Arc] {
        for danger in [Danger::Nearness, Danger::Divergence, Danger::Blend] {
            let mut config = config(Sensor::Depth);
            (config.steer.policy, config.steer.danger) = (policy, danger);
            let records = records(CPU, &course("corridor", 2), &config, 150);
            let last = records.last().unwrap();
            // Five seconds without touching a wall; the corridor curves by more than its width in that time.
            assert!(records.len() == 150 && last.progress_m > 45.0, "{policy:?} {danger:?}: {last:?}");
        }
    }
}

#[test]
fn the_same_flight_again_is_the_same_bit_for_bit() {
    let city = course("city", 5);
    for sensor in [Sensor::NoisyFlow, Sensor::Images] {
        let config = config(sensor);
        assert_eq!(records(CPU, &city, &config, 25), records(CPU, &city, &config, 25), "{sensor:?}");
    }
    let other = records(CPU, &course("city", 6), &config(Sensor::Images), 25);
    assert_ne!(records(CPU, &city, &config(Sensor::Images), 25), other);
}

#[test]
fn pictures_tell_the_direction_of_motion_and_the_time_to_contact() {
    let mut config = config(Sensor::Images);
    config.steer.policy = Policy::None;
    let records = records(CPU, &course("wall:incidence=0:offset=0", 1), &config, 240);
    let mut errors: Vec<f64> = records.iter().skip(5).filter_map(|r| r.heading_error_rad).collect();
    errors.sort_by(f64::total_cmp);
    // A median of 0.2° is usual.
    assert!(errors.len() > 100 && errors[errors.len() / 2] < 0.02, "{errors:?}");
    let near = records.iter().filter(|r| r.true_contact_s.is_some_and(|time| (0.7..3.0).contains(&time)));
    let mut off: Vec<f64> =
        near.map(|r| (r.contact_s.unwrap_or(1e3) / r.true_contact_s.unwrap() - 1.0).abs()).collect();
    off.sort_by(f64::total_cmp);
    assert!(off.len() > 30 && off[off.len() / 2] < 0.1, "{off:?}");
}

/// Among trees the flow alone shows a heading that is too low.
#[test]
fn the_vertical_speed_gives_the_headings_elevation() {
    let forest = course("forest:density=1/64", 3);
    let median_deg = |vertical_speed: Option<VerticalSpeedErrors>| {
        let config = FlightConfig { vertical_speed, ..config(Sensor::Images) };
        let records = records(CPU, &forest, &config, 120);
        let mut errors_deg: Vec<f64> =
            records[60..].iter().filter_map(|record| Some(record.heading_error_rad?.to_degrees())).collect();
        errors_deg.sort_by(f64::total_cmp);
        errors_deg[errors_deg.len() / 2]
    };
    let exact = VerticalSpeedErrors { fixed_m_s: 0.0, jitter_m_s: 0.0 };
    let [by_flow, exact, usual] = [None, Some(exact), Some(VerticalSpeedErrors::default())].map(median_deg);
    assert!(exact < 0.7 && usual < 0.8 * by_flow, "{exact} {usual} {by_flow}");
}

/// The frames of a flight with a fault from 0.5 s to 0.8 s, to some time after its end.
fn with_fault(backends: [Backend; 2], fault: &str) -> Vec<Record> {
    with_faults(backends, &[&format!("{fault}:0.5..0.8")])
}

fn with_faults(backends: [Backend; 2], faults: &[&str]) -> Vec<Record> {
    let mut config = config(Sensor::Images);
    config.faults = faults.iter().map(|fault| fault.parse().unwrap()).collect();
    records(backends, &course("wall", 3), &config, 36)
}

#[test]
fn each_fault_is_said_within_a_frame_and_passes() {
    for (fault, reason) in [
        ("frozen", "the image is identical to the previous one"),
        ("black", "is trusted"),
        ("gyro-lost", "gyro"),
        ("gyro-bias=5", "the flow shows a rotation of"),
        ("nan", "NaN s since the previous frame"),
    ] {
        let records = with_fault(CPU, fault);
        assert_eq!(records.len(), 36, "{fault}");
        assert!((1..15).all(|i| records[i].invalid.is_none()), "{fault}");
        let said: Vec<_> = (15..18).filter_map(|i| records[i].invalid.as_deref()).collect();
        assert!(said[0].contains(reason), "{fault}: {said:?}");
        assert!(records[15].invalid.is_some() || records[16].invalid.is_some(), "{fault}: {said:?}");
        assert_eq!(records[35].invalid, None, "{fault}");
        let sources: Vec<Source> = records.iter().map(|record| record.source).collect();
        // Held at first; if the fault lasts longer than the hold time, the wings are levelled.
        assert!(sources.contains(&Source::Held) || sources[0..].contains(&Source::Recovery), "{fault}");
        assert_eq!(sources[35], Source::Cue, "{fault}");
    }
}

#[test]
fn dropped_frames_are_said_and_the_rest_goes_on() {
    let mut config = config(Sensor::Images);
    config.faults = vec!["dropped=0.2".parse().unwrap()];
    let records = records(CPU, &course("wall", 3), &config, 60);
    let dropped = records.iter().filter(|r| r.invalid.as_deref() == Some("the frame was dropped")).count();
    assert!((4..=24).contains(&dropped), "{dropped} of 60");
    let valid = records.iter().filter(|r| r.invalid.is_none()).count();
    assert!(valid + dropped >= 58, "{valid} valid, {dropped} dropped");
}

#[test]
fn a_lost_device_is_said_and_brought_back_once() {
    let Some(shared) = need::gpu() else { return };
    let gpu = || Backend::Gpu(shared.reopen().unwrap());
    let records = with_faults([gpu(), gpu()], &["device-lost:0.5", "device-lost:0.8"]);
    assert_eq!(records.len(), 36);
    let lost = |frame: usize| records[frame].invalid.as_ref().is_some_and(|why| why.contains("lost"));
    assert!((lost(15) || lost(16)) && records[20..24].iter().all(|r| r.invalid.is_none()));
    // The engine reopens the device once; after that the aircraft flies without a cue.
    assert!((25..36).all(lost) && records[35].source == Source::Recovery);
}

#[test]
fn what_is_out_of_range_is_refused() {
    let wall = course("wall", 1);
    let refused = |change: fn(&mut FlightConfig), name: &str| {
        let mut config = config(Sensor::Depth);
        change(&mut config);
        let error = Flight::new(CPU, &wall, &config).err().unwrap().to_string();
        assert!(error.contains(name) && !error.contains('\n'), "{error}");
    };
    refused(|c| c.speed_m_s = 0.0, "speed_m_s");
    refused(|c| c.radius_m = f64::NAN, "radius_m");
    refused(|c| c.latency_frames = 31, "latency_frames");
    refused(|c| c.patience = 0.5, "patience");
    refused(|c| c.flow_noise.blur_px = -1.0, "flow_noise.blur_px");
    refused(
        |c| {
            c.body =
                Body::Turn(viewsphere::sim::vehicle::TurnParams { bank_lag_s: -1.0, ..Default::default() })
        },
        "bank_lag_s",
    );
    refused(
        |c| {
            c.faults =
                vec![Fault { kind: viewsphere::sim::flight::FaultKind::Black, from_s: 2.0, until_s: 1.0 }]
        },
        "fault",
    );
}
