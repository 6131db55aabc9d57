//! The residual rotation in the flow on the view sphere.

use glam::DVec3;
use viewsphere::PipelineConfig;
use viewsphere::camera::Camera;
use viewsphere::frame::Size;
use viewsphere::sim::{World, scenes};
use viewsphere::sphere::{Derotation, ExtraOutputs, Grid, Sphere, model};

use crate::quantile::quantile;
use crate::straight::{FlightPath, RATE_HZ, fly};

fn config(derotation: Derotation) -> PipelineConfig {
    PipelineConfig {
        sphere: Sphere { derotation, ..Sphere::default() },
        fields: ExtraOutputs { spherical_flow: true, looming: true, ..ExtraOutputs::default() },
        ..PipelineConfig::default()
    }
}

/// The flow of every pixel on the sphere, in radians per frame.
fn spherical_flows(field: &[f32], size: Size) -> impl Iterator<Item = (DVec3, [f64; 2])> {
    let stride = size.stride();
    (0..size.height as usize).flat_map(move |y| {
        (0..size.width as usize).map(move |x| {
            let at = |channel: usize| f64::from(field[(3 * y + channel) * stride + x]);
            (DVec3::new(at(0), at(1), at(2)), [x as f64, y as f64])
        })
    })
}

/// Whether the flow of a pixel's cell is reliable.
fn trusted(looming: &[f32], [x, y]: [f64; 2], size: Size) -> bool {
    let stride = Size::new(size.width.div_ceil(8), 1).stride();
    looming[(4 * (y as usize / 8) + 3) * stride + x as usize / 8] >= 0.1
}

/// The signed mean divergence of the reliable cells of each sector, 1/s.
fn mean_divergences_hz(looming: &[f32], ideal: &Camera, grid: &Grid) -> Vec<f64> {
    let cells = Size::new(ideal.size.width.div_ceil(8), ideal.size.height.div_ceil(8));
    let mut sums = vec![(0.0, 0.0); grid.len()];
    for y in 0..cells.height {
        for x in 0..cells.width {
            let at =
                |channel: usize| f64::from(looming[(4 * y as usize + channel) * cells.stride() + x as usize]);
            let ray = ideal.ray([f64::from(8 * x) + 3.5, f64::from(8 * y) + 3.5]);
            if let (Some([column, row]), true) = (ray.and_then(|ray| grid.sector(ray)), at(3) >= 0.1) {
                let sum = &mut sums[row * grid.columns + column];
                *sum = (sum.0 + RATE_HZ * at(1), sum.1 + 1.0);
            }
        }
    }
    sums.into_iter().filter(|(_, count)| *count > 0.0).map(|(sum, count)| sum / count).collect()
}

/// Rotation in degrees per second about the camera's axes: pitch, yaw, roll.
fn turning(degrees_s: [f64; 3], velocity_world: DVec3) -> FlightPath {
    let omega_rad_s = DVec3::from_array(degrees_s.map(f64::to_radians));
    FlightPath { start_world: DVec3::ZERO, velocity_world, omega_rad_s }
}

fn world() -> World {
    scenes::frontal_wall(12.0).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn a_turn_alone_leaves_next_to_nothing() {
    for degrees_s in [[60.0, 0.0, 0.0], [0.0, 60.0, 0.0], [0.0, 0.0, 60.0], [35.0, -35.0, 35.0]] {
        let flight = turning(degrees_s, DVec3::ZERO);
        let (mut squares, mut pixels, mut divergences, mut means) = (0.0, 0, Vec::new(), Vec::new());
        fly(config(Derotation::Before), &world(), &flight, 0.05, 3, |cue, ideal| {
            let (Some(looming), Some(spherical_flow)) = (cue.looming, cue.spherical_flow) else { return };
            for (flow, pixel) in spherical_flows(spherical_flow, ideal.size) {
                if trusted(looming, pixel, ideal.size) {
                    squares += flow.length_squared() * ideal.f_u * ideal.f_v;
                    pixels += 1;
                }
            }
            divergences.extend(cue.sectors.sectors.iter().filter(|s| s.is_known()).map(|s| s.divergence_hz));
            means.extend(mean_divergences_hz(looming, ideal, &cue.sectors.grid));
        });
        let rms_px = (squares / f64::from(pixels)).sqrt();
        let rms = |values: &[f64]| (values.iter().map(|d| d * d).sum::<f64>() / values.len() as f64).sqrt();
        // The upper quantile of the positive part, and the signed mean.
        let (divergence_hz, mean_hz) = (rms(&divergences), rms(&means));
        println!(
            "{degrees_s:?} °/s: {rms_px:.4} px, {divergence_hz:.4} and {mean_hz:.4} /s, {pixels} pixels, {} sectors",
            divergences.len()
        );
        assert!(
            rms_px <= 0.05 && divergence_hz <= 0.05 && mean_hz <= 0.05,
            "{rms_px} {divergence_hz} {mean_hz}"
        );
        assert!(pixels > 550_000 && divergences.len() > 400 && means.len() > 400);
    }
}

/// Median and 90th percentile of the error of the translational flow, in pixels.
fn translational_error_px(derotation: Derotation, degrees_s: [f64; 3]) -> [f64; 2] {
    let world = world();
    let flight = turning(degrees_s, DVec3::new(0.0, 0.0, 10.0));
    let mut errors = Vec::new();
    fly(config(derotation), &world, &flight, 0.1, 4, |cue, ideal: &Camera| {
        let (Some(looming), Some(spherical_flow)) = (cue.looming, cue.spherical_flow) else { return };
        let pose = flight.pose(cue.time_s);
        let moved = flight.velocity_camera(cue.time_s) / RATE_HZ;
        for (found, pixel) in spherical_flows(spherical_flow, ideal.size) {
            if !trusted(looming, pixel, ideal.size) {
                continue;
            }
            let Some(now) = ideal.ray(pixel) else { continue };
            let point = now / world.seen(&pose, now).nearness_per_m;
            let (_, expected) = model::midpoint_flow((point + moved).normalize(), now);
            errors.push((found - expected).length() * ideal.f_u);
        }
    });
    assert!(errors.len() > 400_000, "{}", errors.len());
    [quantile(&mut errors, 0.5), quantile(&mut errors, 0.9)]
}

#[test]
fn a_hard_roll_is_taken_out_before_the_flow() {
    for (degrees_s, median_px, high_px) in
        [([0.0; 3], 0.08, 0.3), ([0.0, -24.0, 60.0], 0.08, 0.3), ([0.0, -60.0, 150.0], 0.08, 0.3)]
    {
        let [median, high] = translational_error_px(Derotation::Before, degrees_s);
        println!("{degrees_s:?} °/s before: {median:.4} px, 90 % {high:.4} px");
        assert!(median <= median_px && high <= high_px, "{median} {high}");
    }
}

#[test]
fn taken_out_later_it_costs_accuracy() {
    let hard = [0.0, -60.0, 150.0];
    let before = translational_error_px(Derotation::Before, hard);
    for derotation in [Derotation::After, Derotation::Primed] {
        let later = translational_error_px(derotation, hard);
        println!("{derotation:?}: {later:.4?} px; before {before:.4?}");
        assert!(later[1] > before[1], "{derotation:?}: {later:?}");
    }
}
