//! The same bytes every time, and no NaN for any legal size, setting and image.

use proptest::prelude::*;
use viewsphere::Error;
use viewsphere::flow::{
    Algorithm, Border, Farneback, FlowOptions, Initial, Motion, Outside, Update, Window, plan,
};
use viewsphere::frame::{FlowField, Image, PixelFormat, Size};
use viewsphere::kernels::test_inputs::Random;

use crate::need;
use crate::pair::{On, flow};

/// Random bytes, so that no two windows are alike.
fn noise(size: Size, format: PixelFormat, seed: u32) -> Image {
    let mut random = Random::new(seed);
    let data = (0..size.pixels() * format.bytes()).map(|_| (256.0 * random.next()) as u8).collect();
    Image { size, format, data }
}

fn noise_flow(on: On<'_>, config: &Farneback, size: Size, format: PixelFormat) -> FlowField {
    flow(on, config.clone(), [&noise(size, format, 1), &noise(size, format, 2)], None)
}

fn bits(field: &FlowField) -> Vec<[u32; 2]> {
    field.data.iter().map(|d| d.map(f32::to_bits)).collect()
}

fn finite(field: &FlowField) -> bool {
    field.data.as_flattened().iter().all(|d| d.is_finite())
}

/// Wide enough for rows to be distributed over threads, with three levels.
const LARGE: Size = Size::new(203, 151);

fn same_twice(on: On<'_>) {
    for (window, update) in
        [(Window::Box, Update::Flow), (Window::Gaussian, Update::Flow), (Window::Gaussian, Update::Increment)]
    {
        let config = Farneback { window, update, ..Farneback::default() };
        let [first, second] = [(); 2].map(|()| bits(&noise_flow(on, &config, LARGE, PixelFormat::Gray8)));
        assert!(first == second, "two runs on the {} differ, {window:?}, {update:?}", on.name());
        assert!(first.iter().any(|d| *d != first[0]), "a field of one value would show nothing");
    }
}

#[test]
fn the_cpu_gives_the_same_bytes_twice() {
    same_twice(On::Cpu);
}

#[test]
fn the_gpu_gives_the_same_bytes_twice() {
    let Some(gpu) = need::gpu() else { return };
    same_twice(On::Gpu(&gpu));
}

#[test]
fn the_cpu_gives_the_same_bytes_whatever_the_threads() {
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| bits(&noise_flow(On::Cpu, &Farneback::default(), LARGE, PixelFormat::Gray8)))
    };
    let one = with(1);
    assert!(with(2) == one && with(5) == one);
}

fn small_sizes() -> impl Iterator<Item = Size> {
    let small = (1..=9).flat_map(|width| (1..=9).map(move |height| Size::new(width, height)));
    small.chain([(31, 33), (32, 32), (33, 31), (64, 1), (1, 64), (64, 64)].map(|(w, h)| Size::new(w, h)))
}

fn numbers_at(on: On<'_>, sizes: impl Iterator<Item = Size>) {
    for size in sizes {
        let field = noise_flow(on, &Farneback::default(), size, PixelFormat::Gray8);
        assert_eq!(field.data.len(), size.pixels());
        assert!(finite(&field), "{size} on the {}: {field:?}", on.name());
    }
}

#[test]
fn the_cpu_gives_numbers_at_every_small_size() {
    numbers_at(On::Cpu, small_sizes());
}

#[test]
fn the_gpu_gives_numbers_at_small_sizes() {
    let Some(gpu) = need::gpu() else { return };
    // Pipelines are created for every size, so one size in three must do.
    numbers_at(
        On::Gpu(&gpu),
        small_sizes().filter(|size| (size.width + size.height) % 3 == 2 || size.width > 9),
    );
}

/// Every legal parameter for which a plan can be checked in a short time.
fn legal() -> impl Strategy<Value = Farneback> {
    let window = prop_oneof![Just(Window::Box), Just(Window::Gaussian)];
    let update = prop_oneof![Just(Update::Flow), Just(Update::Increment), Just(Update::Normalized)];
    let outside = prop_oneof![Just(Outside::First), Just(Outside::Nothing)];
    let motion = prop_oneof![Just(Motion::Constant), Just(Motion::Affine)];
    let border = prop_oneof![Just(Border::Replicate), Just(Border::Normalized)];
    let shape = (window, update, outside, motion, border);
    let scale =
        prop_oneof![4 => 0.1..0.95, 1 => Just(f64::MIN_POSITIVE), 1 => Just(1.0 - f64::EPSILON / 2.0)];
    let sigma = prop_oneof![4 => 0.0..3.0, 1 => 0.0..=100.0];
    (scale, 0..=32_u32, 2..=1024_u32, 1..=1000_u32, 1..=32_u32, sigma, shape).prop_map(
        |(pyr_scale, levels, winsize, iterations, poly_n, poly_sigma, shape)| {
            let (window, update, outside, motion, border) = shape;
            Farneback {
                pyr_scale,
                levels,
                winsize,
                iterations: if window == Window::Box && update != Update::Flow { 1 } else { iterations },
                poly_n,
                poly_sigma,
                window,
                update,
                outside,
                motion,
                border,
            }
        },
    )
}

fn small_size() -> impl Strategy<Value = Size> {
    (1..=72_u32, 1..=72_u32).prop_map(|(width, height)| Size::new(width, height))
}

fn format() -> impl Strategy<Value = PixelFormat> {
    prop_oneof![
        Just(PixelFormat::Gray8),
        Just(PixelFormat::Gray16),
        Just(PixelFormat::Rgb8),
        Just(PixelFormat::Rgba8)
    ]
}

fn named(config: &Farneback) -> Option<&'static str> {
    let size = Size::new(40, 40);
    let algorithm = Algorithm::from(config.clone());
    let plan = plan(&algorithm, size, PixelFormat::Gray8, FlowOptions::default());
    match (algorithm.validate(), plan.map(|_| ())) {
        (Ok(()), Ok(())) => None,
        (Err(Error::Parameter { name, .. }), Err(Error::Parameter { name: again, .. })) if name == again => {
            Some(name)
        }
        other => panic!("{other:?}"),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn legal_parameters_make_a_plan(config in legal(), size in small_size(), initial_flow: bool) {
        // The plan is checked when it is built.
        let config = Farneback { iterations: config.iterations.min(20), ..config };
        let initial = if initial_flow { Initial::Given } else { Initial::Zero };
        let options = FlowOptions { initial, ..FlowOptions::default() };
        let plan = plan(&config.into(), size, PixelFormat::Gray8, options);
        prop_assert!(plan.is_ok(), "{:?}", plan.err());
    }

    #[test]
    fn legal_parameters_give_numbers(config in legal(), size in small_size(), format in format()) {
        let config = Farneback { iterations: 1 + (config.iterations - 1) % 3, levels: config.levels % 4, ..config };
        let field = noise_flow(On::Cpu, &config, size, format);
        prop_assert!(finite(&field), "{field:?}");
    }

    #[test]
    fn integers_out_of_range_are_named(config in legal(), above in 1025..=u32::MAX) {
        let cases = [
            ("levels", Farneback { levels: above, ..config.clone() }),
            ("winsize", Farneback { winsize: above, ..config.clone() }),
            ("winsize", Farneback { winsize: above % 2, ..config.clone() }),
            ("iterations", Farneback { iterations: above, ..config.clone() }),
            ("iterations", Farneback { iterations: 0, ..config.clone() }),
            ("poly_n", Farneback { poly_n: above, ..config.clone() }),
            ("poly_n", Farneback { poly_n: 0, ..config }),
        ];
        for (name, config) in cases {
            prop_assert_eq!(named(&config), Some(name));
        }
    }

    #[test]
    fn numbers_out_of_range_are_named(config in legal(), wrong in prop_oneof![
        Just(f64::NAN), Just(f64::INFINITY), Just(f64::NEG_INFINITY), -1e9..-1e-300, 100.001..1e9,
    ]) {
        prop_assert_eq!(named(&Farneback { pyr_scale: wrong, ..config.clone() }), Some("pyr_scale"));
        prop_assert_eq!(named(&Farneback { poly_sigma: wrong, ..config }), Some("poly_sigma"));
    }
}

#[test]
fn the_ends_of_the_ranges_are_as_documented() {
    let base = Farneback::default;
    for legal in [
        Farneback { levels: 0, winsize: 2, iterations: 1, poly_n: 1, poly_sigma: 0.0, ..base() },
        Farneback { levels: 32, winsize: 1024, iterations: 1000, poly_n: 32, poly_sigma: 100.0, ..base() },
        Farneback { window: Window::Box, ..Farneback::increment() },
    ] {
        assert_eq!(named(&legal), None);
    }
    for (name, wrong) in [
        ("pyr_scale", Farneback { pyr_scale: 0.0, ..base() }),
        ("pyr_scale", Farneback { pyr_scale: 1.0, ..base() }),
        ("levels", Farneback { levels: 33, ..base() }),
        ("winsize", Farneback { winsize: 1, ..base() }),
        ("winsize", Farneback { winsize: 1025, ..base() }),
        ("iterations", Farneback { iterations: 1001, ..base() }),
        ("iterations", Farneback { window: Window::Box, iterations: 2, ..Farneback::increment() }),
        ("poly_n", Farneback { poly_n: 33, ..base() }),
        ("poly_sigma", Farneback { poly_sigma: 100.000_001, ..base() }),
    ] {
        assert_eq!(named(&wrong), Some(name));
    }
}
