//! Time to contact while a camera comes nearer, through a distorted lens, against the truth.

mod common;

use common::flight::{Flight, fly, quantile, true_rates_hz};
use glam::DVec3;
use viewsphere::PipelineConfig;
use viewsphere::sim::World;
use viewsphere::sim::scenes;

/// Errors of the time to contact of all sectors that show what is at least this near (1 is what lies straight ahead),
/// relative to the truth, at times from 4 s to 0.7 s before contact.
fn errors(
    world: impl Fn(f64) -> viewsphere::Result<World>,
    distance_m: f64,
    speed_m_s: f64,
    near: f64,
) -> Vec<f64> {
    let world = world(speed_m_s).unwrap_or_else(|error| panic!("{error}"));
    let flight =
        Flight { start_world: DVec3::ZERO, velocity_world: DVec3::Z * speed_m_s, omega_rad_s: DVec3::ZERO };
    let mut all = Vec::new();
    for contact_s in [4.0, 2.5, 1.6, 1.0, 0.7] {
        let time_s = distance_m / speed_m_s - contact_s;
        let mut last = Vec::new();
        fly(PipelineConfig::default(), &world, &flight, time_s, 4, |cue, ideal| {
            last.clear();
            if cue.invalid.is_some() {
                return;
            }
            let truth = true_rates_hz(&world, &flight, cue.time_s, cue.sectors, ideal);
            for (sector, rate_hz) in cue.sectors.sectors.iter().zip(truth) {
                let (Some(rate_hz), true) = (rate_hz, sector.coverage > 0.5) else { continue };
                if rate_hz * contact_s < near {
                    continue;
                }
                let found_s = cue.sectors.time_to_contact_s(sector)[1].unwrap_or(f64::INFINITY);
                last.push((found_s * rate_hz - 1.0).abs().min(10.0));
            }
        });
        all.extend(last);
    }
    all
}

fn holds(world: impl Fn(f64) -> viewsphere::Result<World>, distance_m: f64, near: f64, bound: f64) {
    for speed_m_s in [10.0, 20.0, 30.0] {
        let mut errors = errors(&world, distance_m, speed_m_s, near);
        let median = quantile(&mut errors, 0.5);
        let high = quantile(&mut errors, 0.9);
        println!("{speed_m_s} m/s: median {median:.4}, 90 % {high:.4}, {} values", errors.len());
        assert!(errors.len() > 100 && median <= bound, "{median} of {} values", errors.len());
    }
}

// What was measured is a third to a half of the bounds.

#[test]
fn a_frontal_wall() {
    holds(|_| scenes::frontal_wall(130.0), 130.0, 0.0, 0.01);
}

#[test]
fn a_wall_at_30_degrees() {
    holds(|_| scenes::oblique_wall(130.0, 30f64.to_radians()), 130.0, 0.0, 0.01);
}

#[test]
fn a_wall_at_60_degrees() {
    holds(|_| scenes::oblique_wall(130.0, 60f64.to_radians()), 130.0, 0.0, 0.02);
}

/// A pillar 0.6 s of flight wide: two sectors at 4 s. What is behind it is 60 m further away. A pillar narrower than a
/// sector and the flow's window shares them with what is behind it, and seems further away than it is.
#[test]
fn a_pillar() {
    holds(|speed_m_s| scenes::pillar(130.0, 0.3 * speed_m_s), 130.0, 0.7, 0.05);
}
