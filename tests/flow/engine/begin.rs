//! The initial flow of a pair: zero, a given flow, or the flow of the previous pair.

use viewsphere::Error;
use viewsphere::frame::{FlowField, Image, Plane, Size, UNKNOWN_FLOW};
use viewsphere::{Config, Engine, FrameInputs};

use super::pictures::{assert_same, backends, bits, engine, flows, gray};

const SIZE: Size = Size::new(97, 66);

fn images() -> Vec<Image> {
    (0..4).map(|n| gray(n, SIZE)).collect()
}

fn constant(uv: [f32; 2]) -> FlowField {
    FlowField { size: SIZE, data: vec![uv; SIZE.pixels()] }
}

/// The second frame's flow, with a given initial flow.
fn begun(engine: &mut Engine, images: &[Image], initial: &FlowField) -> FlowField {
    engine.reset();
    assert!(engine.process(&images[0].frame().unwrap()).unwrap().is_none());
    let frame_inputs = FrameInputs { initial_flow: Some(initial), ..FrameInputs::default() };
    let output = engine.process_with(&images[1].frame().unwrap(), &frame_inputs).unwrap().unwrap();
    output.flow.unwrap().clone()
}

#[test]
fn a_warm_start_differs_from_a_cold_one_from_the_second_pair_on() {
    let images = images();
    for (name, backend) in backends() {
        let cold = flows(&mut engine(&backend, SIZE, &Config::default()), &images);
        let config = Config { warm_start: true, ..Config::default() };
        let warm = flows(&mut engine(&backend, SIZE, &config), &images);
        // The first pair begins with zero motion both times, though by different steps.
        assert_same(&warm[0], &cold[0], name);
        assert!(bits(&warm[1]) != bits(&cold[1]) && bits(&warm[2]) != bits(&cold[2]), "{name}");
    }
}

#[test]
fn a_warm_start_is_the_flow_before_given_by_hand() {
    let images = images();
    for (name, backend) in backends() {
        let config = Config { warm_start: true, ..Config::default() };
        let warm = flows(&mut engine(&backend, SIZE, &config), &images);
        let given = begun(&mut engine(&backend, SIZE, &config), &images[1..], &warm[0]);
        assert_same(&warm[1], &given, name);
    }
}

#[test]
fn a_given_flow_is_begun_with_and_forgotten() {
    let images = images();
    let config = Config { initial_flow: true, ..Config::default() };
    for (name, backend) in backends() {
        let mut engine = engine(&backend, SIZE, &config);
        let cold = flows(&mut engine, &images);
        let zero = begun(&mut engine, &images, &constant([0.0; 2]));
        assert_same(&zero, &cold[0], name);
        let given = begun(&mut engine, &images, &constant([2.0, -1.0]));
        assert!(bits(&given) != bits(&zero), "{name}: the given flow was not used");
        let unknown = begun(&mut engine, &images, &constant([UNKNOWN_FLOW, f32::NAN]));
        assert_same(&unknown, &zero, name);
        // Without a warm start the next pair begins with zero motion again.
        let next = engine.process(&images[2].frame().unwrap()).unwrap().unwrap();
        assert_same(next.flow.unwrap(), &cold[1], name);
    }
}

#[test]
fn inputs_that_are_not_provided_for_or_do_not_fit_are_refused() {
    let images = images();
    let field = constant([1.0, 1.0]);
    let plane = Plane { size: SIZE, data: vec![1.0; SIZE.pixels()] };
    for (name, backend) in backends() {
        let mut engine = engine(&backend, SIZE, &Config::default());
        let first = images[0].frame().unwrap();
        let frame_inputs = FrameInputs { initial_flow: Some(&field), ..FrameInputs::default() };
        let error = engine.submit_with(&first, &frame_inputs).unwrap_err();
        assert!(matches!(error, Error::Parameter { name: "initial_flow", .. }), "{name}: {error}");
        let frame_inputs = FrameInputs { certainty: Some(&plane), ..FrameInputs::default() };
        let error = engine.submit_with(&first, &frame_inputs).unwrap_err();
        assert!(matches!(error, Error::Parameter { name: "certainty", .. }), "{name}: {error}");
        let mut warm = Engine::new(backend, SIZE, &Config { warm_start: true, ..Config::default() }).unwrap();
        let other = FlowField { size: Size::new(97, 65), data: vec![[0.0; 2]; 97 * 65] };
        let frame_inputs = FrameInputs { initial_flow: Some(&other), ..FrameInputs::default() };
        let error = warm.submit_with(&first, &frame_inputs).unwrap_err();
        assert!(matches!(error, Error::SizeMismatch { .. }), "{name}: {error}");
        let short = FlowField { size: SIZE, data: vec![[0.0; 2]; 5] };
        let frame_inputs = FrameInputs { initial_flow: Some(&short), ..FrameInputs::default() };
        let error = warm.submit_with(&first, &frame_inputs).unwrap_err();
        assert!(matches!(error, Error::Length { found: 5, .. }), "{name}: {error}");
        assert_eq!((engine.stats().submitted, warm.stats().submitted), (0, 0));
    }
}
