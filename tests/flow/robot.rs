//! Time to contact of a real flying robot, compared with motion capture; needs the data set `opticflow_direct`.

use viewsphere::camera::{Camera, Lens};
use viewsphere::flow::Farneback;
use viewsphere::frame::Size;
use viewsphere::io::picture;
use viewsphere::sphere::{ExtraOutputs, Sphere};
use viewsphere::{Backend, Pipeline, PipelineConfig};

use crate::data;
use crate::quantile::quantile;

/// Frames per second.
const RATE_HZ: f64 = 60.0;
/// The least confidence that is compared: towards the end the floor is near, and the images are blurred.
const LEAST_CONFIDENCE: f32 = 0.15;

/// A camera of about the right field of view: the compared rates do not depend on it.
fn camera() -> Camera {
    Camera { size: Size::new(320, 240), f_u: 300.0, f_v: 300.0, u_0: 159.5, v_0: 119.5, lens: Lens::NONE }
}

/// The rate at which the ground comes nearer, 1/s, half-way between each frame and the previous one.
fn measured(folder: &std::path::Path) -> Vec<(f64, f64)> {
    let config = PipelineConfig {
        algorithm: Farneback::accurate().into(),
        sphere: Sphere { window: 12, least_confidence: 0.01, ..Sphere::default() },
        fields: ExtraOutputs { looming: true, ..ExtraOutputs::default() },
        ..PipelineConfig::default()
    };
    let mut pipeline =
        Pipeline::new(Backend::Cpu, &camera(), &config).unwrap_or_else(|error| panic!("{error}"));
    let cells = *pipeline.cells();
    let mut rates = Vec::new();
    for number in 2310..=2400 {
        let path = folder.join(format!("test{number}.png"));
        let image = picture::read(&path).unwrap_or_else(|error| panic!("{error}"));
        let frame = image.frame().unwrap_or_else(|error| panic!("{error}"));
        let time_s = f64::from(number) / RATE_HZ;
        let cue = pipeline.process(&frame, time_s).unwrap_or_else(|error| panic!("{error}"));
        let Some(looming) = cue.looming else { continue };
        // The central cell, where the divergence on the sphere equals that in the plane: 2/τ over flat ground below.
        let stride = cells.size.stride();
        let at = |channel: usize| looming[(4 * 15 + channel) * stride + 20];
        if at(3) >= LEAST_CONFIDENCE {
            rates.push((f64::from(number) - 0.5, 0.5 * RATE_HZ * f64::from(at(1))));
        }
    }
    rates
}

/// Frame number and rate of approach by motion capture.
fn truth(folder: &std::path::Path) -> Vec<(f64, f64)> {
    let path = folder.join("derived_mocap_per_frame.csv");
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{error}"));
    let row = |line: &str| {
        let value = |column: usize| line.split(',').nth(column).and_then(|field| field.parse::<f64>().ok());
        Some((value(0)?, -value(11)?))
    };
    text.lines().filter_map(row).collect()
}

fn at(series: &[(f64, f64)], place: f64) -> Option<f64> {
    let after = series.iter().position(|(x, _)| *x >= place)?;
    let ((x1, y1), (x0, y0)) = (series[after], series[after.checked_sub(1)?]);
    Some(y0 + (y1 - y0) * (place - x0) / (x1 - x0))
}

/// Correlation, root mean square error in 1/s, and median relative error of the time to contact, for a lag in seconds.
fn compare(measured: &[(f64, f64)], truth: &[(f64, f64)], lag_s: f64) -> [f64; 3] {
    let pairs: Vec<(f64, f64)> = (measured.iter())
        .filter_map(|(place, rate)| Some((*rate, at(truth, place - lag_s * RATE_HZ)?)))
        .filter(|(_, truth_hz)| *truth_hz > 1.0 / 3.1)
        .collect();
    let n = pairs.len() as f64;
    let mean = |value: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(value).sum::<f64>() / n;
    let (a, b) = (mean(&|p| p.0), mean(&|p| p.1));
    let (aa, bb) = (mean(&|p| (p.0 - a).powi(2)), mean(&|p| (p.1 - b).powi(2)));
    let ab = mean(&|p| (p.0 - a) * (p.1 - b));
    let mut errors: Vec<f64> = pairs.iter().map(|(found, truth)| (truth / found - 1.0).abs()).collect();
    [ab / (aa * bb).sqrt(), mean(&|p| (p.0 - p.1).powi(2)).sqrt(), quantile(&mut errors, 0.5)]
}

#[test]
fn the_robot_meets_the_ground_when_the_flow_says() {
    let Some(folder) = data::set("opticflow_direct") else { return };
    let (measured, truth) = (measured(&folder), truth(&folder));
    let lags = (-20..=40).map(|i| f64::from(i) * 2e-3);
    let best = lags
        .map(|lag_s| (lag_s, compare(&measured, &truth, lag_s)))
        .min_by(|a, b| a.1[1].total_cmp(&b.1[1]))
        .unwrap_or_else(|| panic!("no lag"));
    let at_source = compare(&measured, &truth, 0.0);
    println!(
        "{} pairs; at the source's lag {at_source:.4?}; best at {:.3} s {:.4?}",
        measured.len(),
        best.0,
        best.1
    );
    assert!(measured.len() > 55 && at_source[2] <= 0.08 && best.1[2] <= 0.055 && best.1[0] >= 0.97);
}
