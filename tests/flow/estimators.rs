//! Properties of every estimator: the same bytes every time, no NaN at any size, a stream with the bits of single
//! pairs (of the first one, for an estimator with memory), a certainty that masks, and both executors near each other.

use viewsphere::flow::{Algorithm, FlowOptions, Initial, Parameters, plan};
use viewsphere::frame::{FlowField, Image, PixelFormat, Plane, Size};
use viewsphere::kernels::test_inputs::Random;
use viewsphere::{Backend, Config, Engine};

use crate::need;
use crate::pair::{Beside, On, flow, flow_of_last};

const SIZE: Size = Size::new(131, 97);
const MOTION: [f32; 2] = [1.5, -0.75];

/// A texture that moves by [`MOTION`] from frame to frame.
fn moving(frame: u8, size: Size) -> Image {
    let time = f32::from(frame);
    let value = |i: usize| {
        let (x, y) = ((i % size.width as usize) as f32, (i / size.width as usize) as f32);
        let [u, v] = [x - time * MOTION[0], y - time * MOTION[1]];
        let waves = [[0.31, 0.17], [-0.23, 0.29], [0.11, -0.37], [0.43, 0.05]];
        let sum: f32 = waves.iter().zip(1..).map(|([a, b], n)| (a * u + b * v + n as f32).sin()).sum();
        (128.0 + 28.0 * sum).round() as u8
    };
    Image { size, format: PixelFormat::Gray8, data: (0..size.pixels()).map(value).collect() }
}

/// The frames of a test: a pair, or enough for an estimator with memory to settle.
fn frames(algorithm: &Algorithm) -> Vec<Image> {
    (0..if algorithm.has_memory() { 24 } else { 2 }).map(|n| moving(n, SIZE)).collect()
}

/// The flow of the frames' last pair.
fn last(on: On<'_>, algorithm: &Algorithm, frames: &[Image], certainty: Option<&Plane>) -> FlowField {
    let beside = Beside { certainty: certainty.map(|plane| [plane, plane]), ..Beside::default() };
    flow_of_last(on, algorithm.clone(), &frames.iter().collect::<Vec<_>>(), beside)
}

fn bits(field: &FlowField) -> Vec<[u32; 2]> {
    field.data.iter().map(|d| d.map(f32::to_bits)).collect()
}

/// Endpoint errors of the pixels that `counts` takes, sorted.
fn errors(field: &FlowField, counts: impl Fn(usize, usize) -> bool) -> Vec<f32> {
    let width = field.size.width as usize;
    let pixels = field.data.iter().enumerate().filter(|(i, _)| counts(i % width, i / width));
    let mut errors: Vec<f32> = pixels.map(|(_, [u, v])| (u - MOTION[0]).hypot(v - MOTION[1])).collect();
    errors.sort_by(f32::total_cmp);
    errors
}

fn executors(f: impl Fn(On<'_>)) {
    f(On::Cpu);
    if let Some(gpu) = need::gpu_if_any() {
        f(On::Gpu(&gpu));
    }
}

/// Every buffer is one that a step or a port uses: levels that are left out, and parts that are not wanted, take no memory.
fn allocates_what_it_uses(algorithm: &Algorithm) {
    for (name, _) in algorithm.presets() {
        for options in 0..8 {
            let [certainty, confidence, given] = [1, 2, 4].map(|bit| options & bit > 0);
            let initial = if given { Initial::Given } else { Initial::Zero };
            let options = FlowOptions { certainty, confidence, initial };
            let algorithm = Algorithm::named(algorithm.name(), name).unwrap();
            let plan = plan(&algorithm, Size::new(320, 240), PixelFormat::Gray8, options).unwrap();
            let mut used = vec![false; plan.bufs.len()];
            let steps = plan.setup.iter().chain(plan.steps(0)).chain(plan.steps(1));
            let of_steps = steps
                .flat_map(|step| step.inputs.iter().copied().chain(step.outputs.iter().map(|(buf, _)| *buf)));
            let of_ports = plan.inputs.iter().chain(&plan.outputs).flat_map(|port| port.bufs);
            of_steps.chain(of_ports).for_each(|buf| used[buf.index()] = true);
            let unused = plan.bufs.iter().zip(used).filter(|(_, used)| !used).map(|(buf, _)| &buf.name);
            let unused: Vec<&String> = unused.collect();
            assert!(unused.is_empty(), "{} {name} {options:?}: {unused:?}", algorithm.name());
        }
    }
}

fn finds_a_motion_and_gives_the_same_bytes_twice(algorithm: &Algorithm) {
    let frames = frames(algorithm);
    executors(|on| {
        let [first, second] = [(); 2].map(|()| last(on, algorithm, &frames, None));
        assert!(bits(&first) == bits(&second), "{} on the {}", algorithm.name(), on.name());
        let errors = errors(&first, |x, y| (20..110).contains(&x) && (20..77).contains(&y));
        let median = errors[errors.len() / 2];
        // Rounding to whole gray levels causes errors of a few hundredths of a pixel for this texture.
        assert!(median <= 0.05, "{} on the {}: {median} px", algorithm.name(), on.name());
    });
}

fn gives_numbers_at_every_size(algorithm: &Algorithm) {
    let small = (1..=9).flat_map(|width| (1..=9).map(move |height| Size::new(width, height)));
    for size in small.chain([(31, 33), (64, 1), (1, 64), (64, 64)].map(|(w, h)| Size::new(w, h))) {
        let mut random = Random::new(1);
        let mut noise = || Image {
            size,
            format: PixelFormat::Gray8,
            data: (0..size.pixels()).map(|_| (256.0 * random.next()) as u8).collect(),
        };
        let field = flow(On::Cpu, algorithm.clone(), [&noise(), &noise()], None);
        assert!(field.data.as_flattened().iter().all(|d| d.is_finite()), "{}, {size}", algorithm.name());
    }
}

fn a_stream_gives_the_bits_of_pairs(algorithm: &Algorithm) {
    let frames: Vec<Image> = (0..4).map(|n| moving(n, SIZE)).collect();
    let backends = [Some(Backend::Cpu), need::gpu_if_any().map(Backend::Gpu)];
    for backend in backends.into_iter().flatten() {
        let config = Config { algorithm: algorithm.clone(), ..Config::default() };
        let mut engine = Engine::new(backend.clone(), SIZE, &config).unwrap();
        let on = match &backend {
            Backend::Cpu => On::Cpu,
            Backend::Gpu(gpu) => On::Gpu(gpu),
        };
        for (n, frame) in frames.iter().enumerate() {
            let output = engine.process(&frame.frame().unwrap()).unwrap();
            let Some(found) = output.and_then(|output| output.flow) else { continue };
            let pair = flow(on, algorithm.clone(), [&frames[n - 1], frame], None);
            // With memory only the first pair is like one of two frames alone.
            let alike = !algorithm.has_memory() || n == 1;
            assert!(
                (bits(found) == bits(&pair)) == alike,
                "{} on the {}, frame {n}",
                algorithm.name(),
                on.name()
            );
        }
        // A reset leaves no trace, and frames of both parities give the same.
        for _ in 0..2 {
            engine.reset();
            engine.process(&frames[0].frame().unwrap()).unwrap();
            let output = engine.process(&frames[1].frame().unwrap()).unwrap();
            let found = output.and_then(|output| output.flow).unwrap();
            let pair = flow(on, algorithm.clone(), [&frames[0], &frames[1]], None);
            assert!(bits(found) == bits(&pair), "{} on the {}, after a reset", algorithm.name(), on.name());
            engine.reset();
            engine.process(&frames[0].frame().unwrap()).unwrap();
        }
    }
}

fn a_certainty_masks(algorithm: &Algorithm) {
    let hidden = |x: usize, y: usize| (50..80).contains(&x) && (35..60).contains(&y);
    let width = SIZE.width as usize;
    let share = |i: usize| if hidden(i % width, i / width) { 0.0 } else { 1.0 };
    let certainty = Plane { size: SIZE, data: (0..SIZE.pixels()).map(share).collect() };
    let frames: Vec<Image> = frames(algorithm)
        .into_iter()
        .map(|mut image| {
            for (i, value) in image.data.iter_mut().enumerate() {
                if hidden(i % width, i / width) {
                    // A pattern that does not move.
                    *value = if (i % width / 3 + i / width / 3).is_multiple_of(2) { 250 } else { 5 };
                }
            }
            image
        })
        .collect();
    let near = |x: usize, y: usize| (42..88).contains(&x) && (27..68).contains(&y) && !hidden(x, y);
    let of = |with: bool| {
        let errors = errors(&last(On::Cpu, algorithm, &frames, with.then_some(&certainty)), near);
        errors.iter().sum::<f32>() / errors.len() as f32
    };
    let [without, with] = [of(false), of(true)];
    println!("{}: {without} px without, {with} px with", algorithm.name());
    assert!(with < 0.2 && 3.0 * with < without, "{}: {without} and {with} px", algorithm.name());
}

fn the_confidence_tells_texture_from_none(algorithm: &Algorithm) {
    let frames = frames(algorithm).into_iter().map(|mut image| {
        image.data[..SIZE.pixels() / 2].fill(128);
        image
    });
    let config = Config { algorithm: algorithm.clone(), confidence: true, ..Config::default() };
    let mut engine = Engine::new(Backend::Cpu, SIZE, &config).unwrap();
    let mut plane = None;
    for frame in frames {
        let output = engine.process(&frame.frame().unwrap()).unwrap();
        plane = output.and_then(|output| output.confidence.cloned());
    }
    let plane = plane.unwrap();
    let at = |x: usize, y: usize| plane.data[y * SIZE.width as usize + x];
    assert!(at(65, 15) < 0.1 && at(65, 80) > 0.5, "{}: {} and {}", algorithm.name(), at(65, 15), at(65, 80));
}

fn both_executors_agree(algorithm: &Algorithm) {
    let Some(gpu) = need::gpu() else { return };
    let frames = frames(algorithm);
    let [cpu, gpu] = [On::Cpu, On::Gpu(&gpu)].map(|on| last(on, algorithm, &frames, None));
    let differences = cpu.data.iter().zip(&gpu.data).map(|([a, b], [c, d])| (a - c).hypot(b - d));
    let largest = differences.fold(0.0, f32::max);
    // Each kernel is within its bound; where there is texture everywhere, that comes to some 10⁻⁴ px of a pair.
    assert!(largest <= 5e-3, "{}: {largest} px", algorithm.name());
}

macro_rules! tests {
    ($($module:ident: $Type:ident),*) => { $(mod $module {
        fn algorithm() -> viewsphere::flow::Algorithm {
            viewsphere::flow::$Type::default().into()
        }
        tests!(@each
            allocates_what_it_uses finds_a_motion_and_gives_the_same_bytes_twice gives_numbers_at_every_size a_stream_gives_the_bits_of_pairs
            a_certainty_masks the_confidence_tells_texture_from_none both_executors_agree
        );
    })* };
    (@each $($test:ident)*) => { $(
        #[test]
        fn $test() {
            super::$test(&algorithm());
        }
    )* };
}
viewsphere::for_each_estimator!(tests);

mod farneback_tv_with_memory {
    fn algorithm() -> viewsphere::flow::Algorithm {
        viewsphere::flow::FarnebackTv { third_frame: 0.5, carry: 0.5, ..Default::default() }.into()
    }
    tests!(@each
        finds_a_motion_and_gives_the_same_bytes_twice gives_numbers_at_every_size a_stream_gives_the_bits_of_pairs
        a_certainty_masks the_confidence_tells_texture_from_none both_executors_agree
    );
}

#[test]
fn every_estimator_is_found_by_its_name() {
    for (name, _) in Algorithm::ALL {
        assert_eq!(Algorithm::named(name, "default").unwrap().name(), *name);
        assert!(Algorithm::named(name, "no such preset").is_err());
    }
    assert!(Algorithm::named("no such method", "default").is_err());
    assert_eq!(viewsphere::flow::Farneback::NAME, Algorithm::default().name());
}
