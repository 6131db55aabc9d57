//! Wrong frames, full engines, missed deadlines.

use std::time::{Duration, Instant};

use viewsphere::frame::{Image, PixelFormat, Size};
use viewsphere::stream::Ticket;
use viewsphere::{Backend, Config, StreamConfig};
use viewsphere::{Engine, Error};

use super::pictures::{assert_same, backends, engine, flows, gray, picture};
use crate::need::{self, Without};

const SIZE: Size = Size::new(65, 48);

fn submit(engine: &mut Engine, n: u32) -> viewsphere::Result<Ticket> {
    engine.submit(&gray(n, SIZE).frame().unwrap())
}

#[test]
fn a_wrong_frame_leaves_the_stream_as_it_was() {
    let images: Vec<Image> = (0..3).map(|n| gray(n, SIZE)).collect();
    for (name, backend) in backends() {
        let expected = flows(&mut engine(&backend, SIZE, &Config::default()), &images);
        let mut engine = engine(&backend, SIZE, &Config::default());
        engine.process(&images[0].frame().unwrap()).unwrap();
        let other = gray(0, Size::new(66, 48));
        let error = engine.process(&other.frame().unwrap()).unwrap_err();
        assert_eq!(error.to_string(), "frame is 66×48, expected 65×48");
        let other = picture(0, SIZE, PixelFormat::Rgb8);
        let error = engine.process(&other.frame().unwrap()).unwrap_err();
        assert_eq!(error.to_string(), "frame format is rgb8, expected gray8");
        for (image, expected) in images[1..].iter().zip(&expected) {
            let output = engine.process(&image.frame().unwrap()).unwrap().unwrap();
            assert_same(output.flow.unwrap(), expected, name);
        }
        assert_eq!(engine.stats().done, 3);
    }
}

#[test]
fn wrong_configurations_are_refused() {
    for (config, text) in [
        (
            Config { stream: StreamConfig { in_flight: 0, ..StreamConfig::default() }, ..Config::default() },
            "in_flight is 0, expected 1 to 8",
        ),
        (
            Config { stream: StreamConfig { in_flight: 9, ..StreamConfig::default() }, ..Config::default() },
            "in_flight is 9, expected 1 to 8",
        ),
        (
            Config {
                stream: StreamConfig { in_flight: 1, drop_oldest: true, ..StreamConfig::default() },
                ..Config::default()
            },
            "in_flight is 1, expected 2 to 8 where the oldest is dropped",
        ),
    ] {
        let Err(error) = Engine::new(Backend::Cpu, SIZE, &config) else { panic!("{config:?} is taken") };
        assert_eq!(error.to_string(), text);
    }
    let Err(error) = Engine::new(Backend::Cpu, Size::new(0, 9), &Config::default()) else {
        panic!("no columns are taken")
    };
    assert!(matches!(error, Error::Parameter { name: "size", .. }), "{error}");
}

#[test]
fn a_full_engine_is_busy_until_a_frame_is_taken() {
    for (name, backend) in backends() {
        let mut engine = engine(&backend, SIZE, &Config::default());
        let first = submit(&mut engine, 0).unwrap();
        let second = submit(&mut engine, 1).unwrap();
        let error = submit(&mut engine, 2).unwrap_err();
        assert!(matches!(error, Error::Busy { in_flight: 2, limit: 2 }), "{name}: {error}");
        assert!(engine.wait(first).unwrap().is_none());
        let third = submit(&mut engine, 2).unwrap();
        assert_eq!(engine.wait(third).unwrap().unwrap().previous, second.frame(), "{name}");
        assert!(engine.wait(second).unwrap().is_some());
    }
}

#[test]
fn a_ticket_is_good_once_and_for_its_engine() {
    for (_, backend) in backends() {
        let mut one = engine(&backend, SIZE, &Config::default());
        let mut other = engine(&backend, SIZE, &Config::default());
        let ticket = submit(&mut one, 0).unwrap();
        submit(&mut other, 0).unwrap();
        assert!(matches!(other.wait(ticket), Err(Error::Ticket { ticket: 0 })));
        assert!(matches!(other.poll(&ticket), Err(Error::Ticket { .. })));
        one.wait(ticket).unwrap();
        assert!(matches!(one.wait(ticket), Err(Error::Ticket { ticket: 0 })));
    }
}

#[test]
fn polling_ends() {
    for (name, backend) in backends() {
        let mut engine = engine(&backend, SIZE, &Config::default());
        submit(&mut engine, 0).unwrap();
        let ticket = submit(&mut engine, 1).unwrap();
        let begin = Instant::now();
        while !engine.poll(&ticket).unwrap() {
            assert!(begin.elapsed() < Duration::from_secs(60), "{name}");
            std::thread::sleep(Duration::from_millis(1));
        }
        assert!(engine.poll(&ticket).unwrap());
        assert!(engine.wait(ticket).unwrap().is_some());
    }
}

#[test]
fn the_oldest_waiting_frame_gives_way() {
    let images: Vec<Image> = (0..4).map(|n| gray(n, SIZE)).collect();
    for (name, backend) in backends() {
        let config = Config {
            stream: StreamConfig { drop_oldest: true, ..StreamConfig::default() },
            ..Config::default()
        };
        let mut engine = engine(&backend, SIZE, &config);
        let tickets: Vec<_> = images.iter().map(|i| engine.submit(&i.frame().unwrap()).unwrap()).collect();
        let output = engine.wait(tickets[3]).unwrap().unwrap();
        // Which frames were dropped depends on the GPU's speed; each flow must be that of its pair.
        let previous = output.previous as usize;
        let flow = output.flow.unwrap().clone();
        assert!(previous < 3, "{name}");
        let pair = [images[previous].clone(), images[3].clone()];
        let expected = flows(&mut super::pictures::engine(&backend, SIZE, &Config::default()), &pair);
        assert_same(&flow, &expected[0], name);
        let stats = engine.stats();
        assert_eq!((stats.submitted, stats.dropped), (4, 2), "{name}");
        let gone = tickets[..3].iter().filter(|t| matches!(engine.wait(**t), Err(Error::Ticket { .. })));
        assert_eq!(gone.count(), 2, "{name}");
    }
}

#[test]
fn a_late_frame_may_be_asked_for_again() {
    let size = Size::new(320, 240);
    let images: Vec<Image> = (0..2).map(|n| gray(n, size)).collect();
    for (name, backend) in backends() {
        let expected = flows(&mut engine(&backend, size, &Config::default()), &images);
        let config = Config {
            stream: StreamConfig { deadline: Some(Duration::ZERO), ..StreamConfig::default() },
            ..Config::default()
        };
        let mut engine = engine(&backend, size, &config);
        // A GPU may be done before the host asks, but not every time.
        let late = (0..50).find_map(|_| {
            engine.reset();
            let first = engine.submit(&images[0].frame().unwrap()).unwrap();
            let second = engine.submit(&images[1].frame().unwrap()).unwrap();
            let error = engine.wait(second).err();
            while matches!(engine.wait(first), Err(Error::Timeout { .. })) {}
            error.map(|error| (second, error))
        });
        let (ticket, error) = late.expect(name);
        let expected_frame = ticket.frame();
        assert!(
            matches!(error, Error::Timeout { frame, deadline_ms: 0, .. } if frame == expected_frame),
            "{name}: {error}"
        );
        let begin = Instant::now();
        let flow = loop {
            match engine.wait(ticket) {
                Ok(output) => break output.unwrap().flow.unwrap().clone(),
                Err(Error::Timeout { .. }) => assert!(begin.elapsed() < Duration::from_secs(60)),
                Err(error) => panic!("{name}: {error}"),
            }
        };
        assert_same(&flow, &expected[0], name);
        assert!(engine.stats().timeouts > 0);
    }
}

#[test]
fn a_frame_that_is_late_in_process_is_given_up() {
    let size = Size::new(320, 240);
    let images: Vec<Image> = (0..2).map(|n| gray(n, size)).collect();
    for (name, backend) in backends() {
        let config = Config {
            stream: StreamConfig { deadline: Some(Duration::ZERO), ..StreamConfig::default() },
            warm_start: true,
            ..Config::default()
        };
        let mut engine = engine(&backend, size, &config);
        for image in images.iter().cycle().take(6) {
            match engine.process(&image.frame().unwrap()) {
                Err(Error::Timeout { .. }) => {}
                // The GPU may be done at once, or still be busy with frames that were given up.
                Ok(_) | Err(Error::Busy { .. }) if name == "GPU" => {}
                other => panic!("{name}: {other:?}"),
            }
        }
        let stats = engine.stats();
        assert_eq!(stats.dropped + stats.done, stats.submitted, "{name}");
        assert!(name == "GPU" || stats.dropped == 6, "{name}: {stats:?}");
        assert_eq!(stats.timeouts, stats.dropped, "{name}");
    }
}

#[test]
fn a_size_beyond_the_adapter_is_refused() {
    let Some(gpu) = need::gpu() else { return };
    let limits = gpu.limits();
    let limit = limits.max_buffer_size.min(limits.max_storage_buffer_binding_size);
    let size = Size::new(Size::MAX_SIDE, Size::MAX_SIDE);
    let limited =
        if limit < 16 * size.pixels() as u64 { Ok(()) } else { Err("the adapter takes every size") };
    if need::found("an adapter that refuses the largest size", limited, Without::Nothing).is_none() {
        return;
    }
    let Err(error) = Engine::new(Backend::Gpu(gpu), size, &Config::default()) else { panic!("taken") };
    assert!(matches!(error, Error::TooLarge { .. }), "{error}");
    assert!(error.to_string().contains("16384×16384"), "{error}");
}
