//! Time to contact while a camera comes nearer, through a distorted lens, against the truth.

mod common;

use common::flight::{Flight, fly, quantile, true_rates_hz};
use glam::DVec3;
use viewsphere::PipelineConfig;
use viewsphere::sim::World;
use viewsphere::sim::scenes;

/// Errors of the time to contact of all sectors, relative to the truth, at times from 4 s to 0.7 s before contact.
fn errors(world: impl Fn() -> viewsphere::Result<World>, distance_m: f64, speed_m_s: f64) -> Vec<f64> {
    let world = world().unwrap_or_else(|error| panic!("{error}"));
    let flight =
        Flight { start_world: DVec3::ZERO, velocity_world: DVec3::Z * speed_m_s, omega_rad_s: DVec3::ZERO };
    let mut all = Vec::new();
    for contact_s in [4.0, 2.5, 1.6, 1.0, 0.7] {
        let time_s = distance_m / speed_m_s - contact_s;
        let mut last = Vec::new();
        let mut known = 0;
        let mut heading = String::new();
        fly(PipelineConfig::default(), &world, &flight, time_s, 4, |cue, ideal| {
            last.clear();
            known = 0;
            heading = format!("{:.4} {:.4}", cue.heading.direction, cue.heading.error_rad);
            if cue.invalid.is_some() {
                return;
            }
            let truth = true_rates_hz(&world, &flight, cue.time_s, cue.sectors, ideal);
            for (sector, rate_hz) in cue.sectors.sectors.iter().zip(truth) {
                let (Some(rate_hz), true) = (rate_hz, sector.coverage > 0.5) else { continue };
                known += 1;
                let found_s = cue.sectors.time_to_contact_s(sector)[1].unwrap_or(f64::INFINITY);
                last.push((found_s * rate_hz - 1.0).abs().min(10.0));
            }
        });
        let mut signed = last.clone();
        println!(
            "{speed_m_s} m/s, {contact_s} s: {known} sectors, median {:.3}, 90 % {:.3}; heading {heading}",
            quantile(&mut signed, 0.5),
            quantile(&mut signed, 0.9),
        );
        all.extend(last);
    }
    all
}

fn holds(world: impl Fn() -> viewsphere::Result<World>, distance_m: f64) {
    for speed_m_s in [10.0, 20.0, 30.0] {
        let mut errors = errors(&world, distance_m, speed_m_s);
        let median = quantile(&mut errors, 0.5);
        println!(
            "{speed_m_s} m/s: median {median:.3}, 90 % {:.3}, {} values",
            quantile(&mut errors, 0.9),
            errors.len()
        );
        assert!(errors.len() > 300 && median <= 0.05, "{median}");
    }
}

#[test]
fn a_frontal_wall() {
    holds(|| scenes::frontal_wall(130.0), 130.0);
}

#[test]
fn a_wall_at_30_degrees() {
    holds(|| scenes::oblique_wall(130.0, 30f64.to_radians()), 130.0);
}

#[test]
fn a_wall_at_60_degrees() {
    holds(|| scenes::oblique_wall(130.0, 60f64.to_radians()), 130.0);
}

#[test]
fn a_pillar() {
    holds(|| scenes::pillar(130.0, 3.0), 130.0);
}
