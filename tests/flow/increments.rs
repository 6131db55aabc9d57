//! Windows of increments: where they are more accurate than windows of the flow, and that they find the same motion
//! elsewhere.

use viewsphere::flow::{Farneback, Update, Window};
use viewsphere::frame::{FlowField, Image, PixelFormat, Size};

use crate::need;
use crate::pair::{On, flow};

const SIZE: Size = Size::new(160, 120);

/// A frame of a moved image, by a map from its pixels to those of the image.
///
/// The image's contrast rises and falls tenfold every 24 pixels, so that in most windows one side dominates.
fn frame(of: impl Fn([f64; 2]) -> [f64; 2]) -> Image {
    let level = |[x, y]: [f64; 2]| {
        let waves = [[0.83, 0.31], [-0.42, 0.77], [0.57, -0.69], [0.24, 1.02]];
        let sum: f64 = waves.iter().zip(0..).map(|([p, q], k)| (p * x + q * y + f64::from(k)).sin()).sum();
        let contrast = |at: f64| 0.55 + 0.45 * (at * std::f64::consts::TAU / 24.0).sin();
        128.0 + 30.0 * sum * contrast(x) * contrast(y)
    };
    let pixels = (0..SIZE.pixels()).map(|i| [i % SIZE.width as usize, i / SIZE.width as usize]);
    let data = pixels.map(|[x, y]| level(of([x as f64, y as f64])).round() as u8).collect();
    Image { size: SIZE, format: PixelFormat::Gray8, data }
}

/// Median length of the difference from the true flow, away from the border, in pixels.
fn error_px(found: &FlowField, truth: impl Fn([f64; 2]) -> [f64; 2]) -> f64 {
    let mut errors = Vec::new();
    for y in 20..SIZE.height as usize - 20 {
        for x in 20..SIZE.width as usize - 20 {
            let [u, v] = found.data[y * SIZE.width as usize + x].map(f64::from);
            let [t_u, t_v] = truth([x as f64, y as f64]);
            errors.push((u - t_u).hypot(v - t_v));
        }
    }
    errors.sort_by(f64::total_cmp);
    errors[errors.len() / 2]
}

fn settings(update: Update, iterations: u32) -> Farneback {
    Farneback { winsize: 21, window: Window::Gaussian, iterations, update, ..Farneback::default() }
}

/// Approach: the flow grows by 0.04 px per pixel from the centre.
#[test]
fn increments_keep_what_changes_within_the_window() {
    const GROWTH: f64 = 0.04;
    let middle = [80.0, 60.0];
    let from_middle = |at: [f64; 2]| [at[0] - middle[0], at[1] - middle[1]];
    let frames = [
        frame(|at| at),
        frame(|at| std::array::from_fn(|k| middle[k] + from_middle(at)[k] / (1.0 + GROWTH))),
    ];
    for iterations in [1, 2, 3] {
        let error = |update| {
            let found = flow(On::Cpu, settings(update, iterations), frames.each_ref(), None);
            error_px(&found, |at| from_middle(at).map(|from| GROWTH * from))
        };
        let [whole, increment] = [Update::Flow, Update::Increment].map(error);
        println!("{iterations} iterations: {whole:.4} px, increments {increment:.4} px");
        assert!(!(increment > 0.6 * whole), "{iterations} iterations: {increment} against {whole} px");
    }
}

#[test]
fn both_find_a_motion_that_is_the_same_everywhere() {
    let motion = [2.3, -1.4];
    let frames = [frame(|at| at), frame(|at| std::array::from_fn(|k| at[k] - motion[k]))];
    for update in [Update::Flow, Update::Increment] {
        let found = flow(On::Cpu, settings(update, 2), frames.each_ref(), None);
        let error = error_px(&found, |_| motion);
        println!("{update:?}: {error:.4} px");
        // A twentieth of a pixel: the error from rounding these images to whole gray levels.
        assert!(!(error > 0.05), "{update:?}: {error} px");
    }
}

/// The buffers of even and odd iterations are in their places on both sides.
#[test]
fn the_gpu_finds_the_same_increments() {
    let Some(gpu) = need::gpu() else { return };
    let frames = [frame(|at| at), frame(|at| [at[0] - 1.2, at[1] + 0.7])];
    for iterations in [1, 2, 3] {
        let config = settings(Update::Increment, iterations);
        let [cpu, gpu] = [On::Cpu, On::Gpu(&gpu)].map(|on| flow(on, &config, frames.each_ref(), None));
        let apart = cpu.data.as_flattened().iter().zip(gpu.data.as_flattened()).map(|(a, b)| (a - b).abs());
        let furthest = apart.fold(0.0, |most: f32, one| if one > most || one.is_nan() { one } else { most });
        // Roundings of some 10⁻⁶ px, which each level and iteration passes on.
        assert!(!(furthest > 1e-3), "{iterations} iterations: {furthest} px");
    }
}
