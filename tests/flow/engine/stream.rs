//! A stream's results equal those of its pairs.

use viewsphere::frame::{FlowField, Frame, Image, PixelFormat, Size};
use viewsphere::{Backend, Config, StreamConfig};

use super::pictures::{assert_same, backends, bits, engine, flows, gray, picture};

fn pair_by_pair(backend: &Backend, config: &Config, images: &[Image]) -> Vec<FlowField> {
    let one = |pair: &[Image]| flows(&mut engine(backend, pair[0].size, config), pair).remove(0);
    images.windows(2).map(one).collect()
}

#[test]
fn a_stream_is_its_pairs_bit_for_bit() {
    for (name, backend) in backends() {
        for (width, height) in [(1, 1), (7, 5), (65, 33), (130, 97)] {
            let size = Size::new(width, height);
            let config = Config::default();
            let images: Vec<Image> = (0..5).map(|n| gray(n, size)).collect();
            let stream = flows(&mut engine(&backend, size, &config), &images);
            let pairs = pair_by_pair(&backend, &config, &images);
            for (n, (a, b)) in stream.iter().zip(&pairs).enumerate() {
                assert_eq!(bits(a), bits(b), "{name}, {size}, pair {n}");
            }
            if width > 7 {
                assert!(bits(&stream[0]) != bits(&stream[1]), "{name}, {size}: all pairs look alike");
            }
        }
    }
}

#[test]
fn a_stream_in_every_format_is_its_pairs() {
    let size = Size::new(71, 50);
    for (name, backend) in backends() {
        for format in [PixelFormat::Gray8, PixelFormat::Gray16, PixelFormat::Rgb8, PixelFormat::Rgba8] {
            let config = Config { format, ..Config::default() };
            let images: Vec<Image> = (0..4).map(|n| picture(n, size, format)).collect();
            let stream = flows(&mut engine(&backend, size, &config), &images);
            let pairs = pair_by_pair(&backend, &config, &images);
            for (a, b) in stream.iter().zip(&pairs) {
                assert_same(a, b, &format!("{name}, {format}"));
            }
        }
    }
}

#[test]
fn what_lies_between_the_rows_does_not_matter() {
    let size = Size::new(71, 50);
    for (name, backend) in backends() {
        for format in [PixelFormat::Gray8, PixelFormat::Rgb8] {
            let config = Config { format, ..Config::default() };
            let images = [0, 1].map(|n| picture(n, size, format));
            let expected = flows(&mut engine(&backend, size, &config), &images).remove(0);
            let row = 71 * format.bytes();
            let wide = images.map(|image| {
                let rows = image.data.chunks(row);
                rows.flat_map(|r| r.iter().copied().chain([0xAB; 13])).collect::<Vec<u8>>()
            });
            let mut engine = engine(&backend, size, &config);
            let frames = wide.each_ref().map(|d| Frame::with_stride(size, format, row + 13, d).unwrap());
            assert!(engine.process(&frames[0]).unwrap().is_none());
            let output = engine.process(&frames[1]).unwrap().unwrap();
            assert_same(output.flow.unwrap(), &expected, name);
        }
    }
}

#[test]
fn two_runs_give_the_same_bytes() {
    let size = Size::new(130, 97);
    let images: Vec<Image> = (0..6).map(|n| gray(n, size)).collect();
    for (name, backend) in backends() {
        let run = || flows(&mut engine(&backend, size, &Config::default()), &images);
        for (a, b) in run().iter().zip(&run()) {
            assert_same(a, b, name);
        }
    }
}

#[test]
fn after_a_reset_the_stream_is_as_new() {
    let size = Size::new(65, 48);
    let images: Vec<Image> = (0..4).map(|n| gray(n, size)).collect();
    for (name, backend) in backends() {
        for warm_start in [false, true] {
            let config = Config { warm_start, ..Config::default() };
            let mut engine = engine(&backend, size, &config);
            let before = flows(&mut engine, &images);
            // An odd number of frames, so that the parities are exchanged afterwards.
            engine.reset();
            flows(&mut engine, &images[..3]);
            engine.reset();
            let after = flows(&mut engine, &images);
            for (a, b) in before.iter().zip(&after) {
                assert_same(a, b, &format!("{name}, warm start {warm_start}"));
            }
        }
    }
}

#[test]
fn frames_in_flight_give_what_frames_in_turn_give() {
    let size = Size::new(130, 97);
    let images: Vec<Image> = (0..7).map(|n| gray(n, size)).collect();
    for (name, backend) in backends() {
        for in_flight in [1, 2, 3, 8] {
            let config = Config {
                stream: StreamConfig { in_flight, ..StreamConfig::default() },
                warm_start: true,
                ..Config::default()
            };
            let expected = flows(&mut engine(&backend, size, &config), &images);
            let mut engine = engine(&backend, size, &config);
            let mut found = Vec::new();
            for group in images.chunks(in_flight) {
                let tickets: Vec<_> =
                    group.iter().map(|image| engine.submit(&image.frame().unwrap()).unwrap()).collect();
                for ticket in tickets {
                    let output = engine.wait(ticket).unwrap();
                    found.extend(output.map(|o| (o.frame, o.previous, o.flow.unwrap().clone())));
                }
            }
            assert_eq!(found.len(), expected.len());
            for (n, ((frame, previous, flow), expected)) in (0..).zip(found.iter().zip(&expected)) {
                assert_eq!((*frame, *previous), (n + 1, n), "{name}");
                assert_same(flow, expected, &format!("{name}, {in_flight} in flight"));
            }
        }
    }
}

#[test]
fn frames_may_be_waited_for_in_any_order() {
    let size = Size::new(65, 48);
    let images: Vec<Image> = (0..3).map(|n| gray(n, size)).collect();
    for (name, backend) in backends() {
        let config =
            Config { stream: StreamConfig { in_flight: 3, ..StreamConfig::default() }, ..Config::default() };
        let expected = flows(&mut engine(&backend, size, &config), &images);
        let mut engine = engine(&backend, size, &config);
        let tickets: Vec<_> = images.iter().map(|i| engine.submit(&i.frame().unwrap()).unwrap()).collect();
        for n in [2, 1] {
            let output = engine.wait(tickets[n]).unwrap().unwrap();
            assert_same(output.flow.unwrap(), &expected[n - 1], name);
        }
        assert!(engine.wait(tickets[0]).unwrap().is_none());
    }
}
