//! The flow that the pipeline measures in flight, compared with the true flow on the view sphere.

use viewsphere::Backend;
use viewsphere::sim::CourseKind;
use viewsphere::sim::flight::{Flight, FlightConfig, Measured, Sensor};

/// Two seconds of flight.
const FRAMES: usize = 60;

/// Flies for `FRAMES` frames, 320 by 240 pixels through a lens with noise, and returns the measured ones.
fn measured(world: &str, seed: u64) -> Vec<Measured> {
    let config = FlightConfig { measure: true, ..FlightConfig::default() };
    assert!(config.sensor == Sensor::Images && config.renderer.noise_levels > 0.0);
    assert!(config.camera.lens.coefficients[0] != 0.0 && config.camera.size.width == 320);
    let course = world.parse::<CourseKind>().unwrap().course(seed).unwrap();
    let mut flight = Flight::new([Backend::Cpu, Backend::Cpu], &course, &config).unwrap();
    let mut measured = Vec::new();
    for _ in 0..FRAMES {
        let ended = flight.step(|seen| {
            assert_eq!(seen.record.measured.is_some(), seen.record.invalid.is_none());
            assert_eq!(seen.record.measured.is_some(), seen.divergences.is_some());
            measured.extend(seen.record.measured);
            Ok(())
        });
        assert_eq!(ended.unwrap(), None);
    }
    measured
}

fn median(values: impl Iterator<Item = Option<f64>>) -> f64 {
    let mut values: Vec<f64> = values.flatten().collect();
    assert!(values.len() > 20, "{values:?}");
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[track_caller]
fn check(world: &str, seed: u64) {
    let frames = measured(world, seed);
    assert!(frames.len() > FRAMES - 5, "{}", frames.len());
    let flow_px = median(frames.iter().map(|frame| frame.better_half_error_px));
    let all_px = median(frames.iter().map(|frame| frame.trusted_error_px));
    let contact = median(frames.iter().map(|frame| frame.contact_error));
    let trusted = median(frames.iter().map(|frame| Some(frame.trusted)));
    let cells: usize = frames.iter().map(|frame| frame.contact_cells).sum();
    let found = format!(
        "{world} {seed}: {flow_px:.4} px, {all_px:.4} px in all of {trusted:.3} of the view, time to contact {contact:.4} \
         in {cells} cells"
    );
    println!("{found}");
    assert!(trusted > 0.3 && cells > 1000, "{found}");
    assert!(!(flow_px > 0.1) && !(contact > 0.1), "{found}");
}

#[test]
fn in_a_forest() {
    check("forest", 1);
}

#[test]
fn in_a_city() {
    check("city", 1);
}

#[test]
fn in_a_corridor() {
    check("corridor", 1);
}
