//! The loss of a GPU, simulated by `destroy`.

use viewsphere::frame::{Image, Size};
use viewsphere::gpu::Gpu;
use viewsphere::stream::OnLoss;
use viewsphere::{Backend, Config, Engine, StreamConfig};
use viewsphere::{Error, Result};

use super::pictures::{assert_same, flows, gray};
use crate::need;

const SIZE: Size = Size::new(65, 48);

fn images() -> Vec<Image> {
    (0..3).map(|n| gray(n, SIZE)).collect()
}

/// A separate device, because the shared one must live.
fn own() -> Option<Gpu> {
    Some(need::gpu()?.reopen().unwrap())
}

fn destroy(engine: &Engine) {
    engine.gpu().unwrap().device().destroy();
}

fn lost<T>(result: Result<T>) -> bool {
    matches!(result, Err(Error::DeviceLost { .. }))
}

/// Submits frames until one fails, which must happen soon.
fn until_lost(engine: &mut Engine, images: &[Image]) {
    let results: Vec<bool> = images.iter().map(|i| lost(engine.process(&i.frame().unwrap()))).collect();
    assert!(results[0], "the loss was not noticed by the next frame");
}

#[test]
fn the_device_is_brought_back_once_and_the_stream_begins_anew() {
    let Some(gpu) = own() else { return };
    let images = images();
    let mut engine = Engine::new(Backend::Gpu(gpu), SIZE, &Config::default()).unwrap();
    let expected = flows(&mut engine, &images);
    destroy(&engine);
    until_lost(&mut engine, &images[..1]);
    let stats = engine.stats();
    assert_eq!((stats.losses, stats.rebuilt, stats.on_cpu), (1, 1, false));
    // The first frame of these gives no flow: `flows` checks it.
    for (a, b) in flows(&mut engine, &images).iter().zip(&expected) {
        assert_same(a, b, "after the rebuild");
    }
    destroy(&engine);
    until_lost(&mut engine, &images[..1]);
    assert!(lost(engine.process(&images[0].frame().unwrap())));
    assert!(lost(engine.submit(&images[0].frame().unwrap())));
    assert_eq!(engine.stats().losses, 2);
    assert!(engine.gpu().is_none());
}

#[test]
fn frames_in_flight_tell_of_the_loss() {
    let Some(gpu) = own() else { return };
    let images = images();
    let mut engine = Engine::new(Backend::Gpu(gpu), SIZE, &Config::default()).unwrap();
    flows(&mut engine, &images);
    let tickets: Vec<_> = images[..2].iter().map(|i| engine.submit(&i.frame().unwrap()).unwrap()).collect();
    destroy(&engine);
    // The first one may have been done before.
    let first = engine.wait(tickets[0]);
    assert!(matches!(first, Ok(None | Some(_)) | Err(Error::DeviceLost { .. })), "{first:?}");
    assert!(lost(engine.wait(tickets[1])));
    // Reported once; then the ticket is no longer valid.
    assert!(matches!(engine.wait(tickets[1]), Err(Error::Ticket { .. })));
    assert_eq!(engine.stats().losses, 1);
    flows(&mut engine, &images);
}

#[test]
fn after_a_second_loss_the_cpu_goes_on() {
    let Some(gpu) = own() else { return };
    let images = images();
    let config = Config {
        stream: StreamConfig { on_loss: OnLoss::Cpu, ..StreamConfig::default() },
        ..Config::default()
    };
    let mut engine = Engine::new(Backend::Gpu(gpu), SIZE, &config).unwrap();
    for _ in 0..2 {
        flows(&mut engine, &images);
        destroy(&engine);
        until_lost(&mut engine, &images[..1]);
    }
    let stats = engine.stats();
    assert_eq!((stats.losses, stats.rebuilt, stats.on_cpu), (2, 1, true));
    assert!(engine.adapter().starts_with("CPU, "), "{}", engine.adapter());
    let expected = flows(&mut Engine::new(Backend::Cpu, SIZE, &config).unwrap(), &images);
    for (a, b) in flows(&mut engine, &images).iter().zip(&expected) {
        assert_same(a, b, "on the CPU");
    }
}

#[test]
fn a_callers_device_works_and_is_not_brought_back() {
    let Some(own) = own() else { return };
    let images = images();
    let expected =
        flows(&mut Engine::new(Backend::Gpu(own.clone()), SIZE, &Config::default()).unwrap(), &images);
    let theirs = Gpu::from_device(own.device().clone(), own.queue().clone());
    let mut engine = Engine::new(Backend::Gpu(theirs), SIZE, &Config::default()).unwrap();
    for (a, b) in flows(&mut engine, &images).iter().zip(&expected) {
        assert_same(a, b, "on the caller's device");
    }
    destroy(&engine);
    until_lost(&mut engine, &images[..1]);
    assert_eq!((engine.stats().losses, engine.stats().rebuilt), (1, 0));
    assert!(lost(engine.process(&images[0].frame().unwrap())));
}
