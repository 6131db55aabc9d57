//! The engine's statistics.

use std::time::Duration;

use viewsphere::frame::{Image, Size};
use viewsphere::stream::TimeSource;
use viewsphere::{Backend, Config, StreamConfig};

use super::pictures::{backends, engine, flows, gray};
use crate::need::{self, Without};

const SIZE: Size = Size::new(130, 97);

fn images(count: u32) -> Vec<Image> {
    (0..count).map(|n| gray(n, SIZE)).collect()
}

#[test]
fn every_step_has_its_time_and_together_they_fit_the_latency() {
    for (name, backend) in backends() {
        let config = Config {
            stream: StreamConfig { timestamps: true, ..StreamConfig::default() },
            ..Config::default()
        };
        let mut engine = engine(&backend, SIZE, &config);
        let first = engine.process(&images(1)[0].frame().unwrap()).unwrap().is_none();
        assert!(first);
        let of_first = engine.stage_times().len();
        let source = engine.time_source();
        match (name, source) {
            ("CPU", _) => assert_eq!(source, TimeSource::Host),
            (_, TimeSource::None) => {
                assert_eq!(of_first, 0);
                let none = Err::<(), _>("the adapter has no timestamps");
                need::found("a GPU that tells the time", none, Without::Part);
                continue;
            }
            _ => assert_eq!(source, TimeSource::Gpu),
        }
        let mut latency = Duration::ZERO;
        let mut whole = 0;
        for image in images(6) {
            latency = engine.process(&image.frame().unwrap()).unwrap().unwrap().latency;
            whole += usize::from(!engine.stage_times().is_empty());
        }
        assert!(whole > 0, "{name}: no frame's times were believed");
        if !engine.stage_times().is_empty() {
            let stages = engine.stage_times();
            let steps: Vec<_> = engine.plan().steps(0).map(|step| step.kernel.name).collect();
            assert_eq!(stages.iter().map(|stage| stage.kernel).collect::<Vec<_>>(), steps, "{name}");
            assert_eq!(of_first, engine.plan().ingest[0].len(), "{name}");
            let sum: Duration = stages.iter().map(|stage| stage.time).sum();
            assert!(sum > Duration::ZERO && sum <= latency, "{name}: {sum:?} of {latency:?}");
        }
    }
}

#[test]
fn without_timestamps_there_are_no_times() {
    for (_, backend) in backends() {
        let mut engine = engine(&backend, SIZE, &Config::default());
        flows(&mut engine, &images(3));
        assert!(engine.stage_times().is_empty());
        assert_eq!(engine.time_source(), TimeSource::None);
    }
}

#[test]
fn latencies_and_counts_are_of_what_was_done() {
    for (name, backend) in backends() {
        let mut engine = engine(&backend, SIZE, &Config::default());
        assert_eq!(engine.latency().count, 0);
        let mut seen = Vec::new();
        for image in images(8) {
            seen.extend(engine.process(&image.frame().unwrap()).unwrap().map(|output| output.latency));
        }
        seen.sort();
        let latency = engine.latency();
        assert_eq!((latency.count, latency.p50, latency.max), (7, seen[3], seen[6]), "{name}");
        assert_eq!((latency.p90, latency.p99), (seen[6], seen[6]), "{name}");
        let stats = engine.stats();
        assert_eq!((stats.submitted, stats.done, stats.dropped, stats.losses), (8, 8, 0, 0), "{name}");
        assert_eq!(stats.on_cpu, matches!(backend, Backend::Cpu));
    }
}

#[test]
fn what_is_not_asked_for_is_not_read() {
    for (name, backend) in backends() {
        let config = Config { read_flow: false, ..Config::default() };
        let mut small = engine(&backend, SIZE, &config);
        small.process(&images(1)[0].frame().unwrap()).unwrap();
        let output = small.process(&images(2)[1].frame().unwrap()).unwrap().unwrap();
        assert!(output.flow.is_none() && output.confidence.is_none());
        assert_eq!(output.frame, 1);
        let large = engine(&backend, SIZE, &Config::default());
        assert!(small.buffer_bytes() < large.buffer_bytes(), "{name}");
        assert!(small.buffer_bytes() > small.plan().bytes(), "{name}");
    }
}

#[test]
fn the_adapter_is_named() {
    for (name, backend) in backends() {
        let engine = engine(&backend, SIZE, &Config::default());
        assert_eq!(engine.adapter().starts_with("CPU, "), name == "CPU", "{}", engine.adapter());
    }
}
