//! The confidence orders the flow by its error.

use viewsphere::eval::{Scene, endpoint_error};
use viewsphere::flow::{Farneback, Window};
use viewsphere::frame::{Image, Size};
use viewsphere::{Backend, Config, Engine};

const SIZE: Size = Size::new(320, 240);

/// Mean endpoint error in px of ten equal shares of the pixels, from the least confident to the most.
fn deciles(flow: Farneback, frames: &[Image; 2], scene: &Scene) -> [f64; 10] {
    let config = Config { algorithm: flow.into(), confidence: true, ..Config::default() };
    let mut engine = Engine::new(Backend::Cpu, SIZE, &config).expect("the configuration is legal");
    engine.process(&frames[0].frame().expect("whole")).expect("the CPU computes");
    let output =
        engine.process(&frames[1].frame().expect("whole")).expect("the CPU computes").expect("a pair");
    let error = endpoint_error(&scene.flow(0), output.flow.expect("asked for")).expect("one size").data;
    let confidence = &output.confidence.expect("asked for").data;
    assert!(confidence.iter().all(|c| (0.0..=1.0).contains(c)));
    let mut pixels: Vec<(f32, f32)> = confidence.iter().copied().zip(error).collect();
    pixels.sort_by(|a, b| a.0.total_cmp(&b.0));
    let share = pixels.len() / 10;
    std::array::from_fn(|i| {
        pixels[i * share..][..share].iter().map(|(_, error)| f64::from(*error)).sum::<f64>() / share as f64
    })
}

fn settings() -> [(&'static str, Farneback); 3] {
    [
        ("default", Farneback::default()),
        ("accurate", Farneback::accurate()),
        ("gaussian", Farneback { window: Window::Gaussian, ..Farneback::default() }),
    ]
}

/// Above the floor, where both shares are as good as the frames' 8 bits allow, errors must fall.
fn assert_falls(name: &str, deciles: [f64; 10]) {
    const FLOOR_PX: f64 = 0.03;
    let falls = deciles.windows(2).all(|pair| pair[1] < pair[0].max(FLOOR_PX));
    assert!(falls, "{name}: {deciles:?}");
    assert!(
        deciles[9] < 0.1 * deciles[0],
        "{name}: the best tenth is hardly better than the worst: {deciles:?}"
    );
}

#[test]
fn error_falls_as_confidence_rises_on_texture() {
    let scene = Scene::new(SIZE).expect("a legal size");
    for (name, flow) in settings() {
        assert_falls(name, deciles(flow, &[scene.frame(0), scene.frame(1)], &scene));
    }
}

#[test]
fn error_falls_as_confidence_rises_where_a_third_is_flat() {
    let scene = Scene::new(SIZE).expect("a legal size");
    let frames = [0, 1].map(|i| {
        let mut image = scene.frame(i);
        for row in image.data.chunks_exact_mut(SIZE.width as usize) {
            row[..SIZE.width as usize / 3].fill(100);
        }
        image
    });
    for (name, flow) in settings() {
        let all = deciles(flow, &frames, &scene);
        // A third of the pixels has no texture, so three tenths are in no order, and the fourth is mixed, as it has the
        // border of the flat part. From there on errors fall, and the best tenth is far better than each flat one.
        let (flat, rest) = all.split_at(3);
        assert!(flat.iter().all(|error| *error > 5.0 * rest[6]), "{name}: {all:?}");
        assert!(rest[1..].windows(2).all(|pair| pair[1] < pair[0].max(0.03)), "{name}: {all:?}");
    }
}
