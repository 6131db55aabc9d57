//! Runs an algorithm on a pair of frames.

use std::time::Instant;

use super::processor_time::ProcessorTime;
use crate::backend::Backend;
use crate::engine::{Config, Engine};
use crate::error::{Error, Result};
use crate::flow::Algorithm;
use crate::frame::{FlowField, Frame, Plane};
use crate::quantile::median;

/// The flow of a pair and what it cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// The flow in pixels, from the first frame to the second.
    pub flow: FlowField,
    /// Its confidence per pixel, 0 to 1.
    pub confidence: Plane,
    /// The time, if it was measured.
    pub time: Option<PairTime>,
}

/// The time that a pair takes: both frames from the host's memory to the flow in the host's memory, without a
/// confidence. In a stream, where the results of the previous frame are kept, a frame takes less.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PairTime {
    /// Wall time in milliseconds: the median of all repetitions.
    pub wall_ms: f64,
    /// Processor time of all threads in milliseconds: the median. `None` where the system does not tell it (other than
    /// Linux).
    pub processor_ms: Option<f64>,
}

/// Computes the flow of a pair and its confidence, and then `repeats` times the flow alone, timed, after a run that is
/// not. With 0 repeats nothing is timed.
///
/// # Errors
/// As [`Engine::new`] and [`Engine::process`].
pub fn estimate(
    backend: &Backend,
    algorithm: &Algorithm,
    frames: [&Frame<'_>; 2],
    repeats: u32,
) -> Result<Estimate> {
    let config = Config { algorithm: algorithm.clone(), format: frames[0].format(), ..Config::default() };
    let with_confidence = Config { confidence: true, ..config.clone() };
    let mut engine = Engine::new(backend.clone(), frames[0].size(), &with_confidence)?;
    let missing = || Error::parameter("flow", "missing", "one for the second frame");
    engine.process(frames[0])?;
    let output = engine.process(frames[1])?.ok_or_else(missing)?.into_owned();
    drop(engine);
    let (flow, confidence) = output.flow.zip(output.confidence).ok_or_else(missing)?;
    let time = if repeats > 0 { Some(timed(backend, &config, frames, repeats)?) } else { None };
    Ok(Estimate { flow, confidence, time })
}

fn timed(backend: &Backend, config: &Config, frames: [&Frame<'_>; 2], repeats: u32) -> Result<PairTime> {
    let mut engine = Engine::new(backend.clone(), frames[0].size(), config)?;
    let mut run = || -> Result<(f64, Option<f64>)> {
        engine.reset();
        let (processor, start) = (ProcessorTime::now(), Instant::now());
        engine.process(frames[0])?;
        engine.process(frames[1])?;
        let wall_ms = start.elapsed().as_secs_f64() * 1e3;
        Ok((wall_ms, processor.and_then(|start| Some(ProcessorTime::now()?.ms_since(start)))))
    };
    run()?;
    let runs = (0..repeats).map(|_| run()).collect::<Result<Vec<_>>>()?;
    let processor: Option<Vec<f64>> = runs.iter().map(|(_, processor_ms)| *processor_ms).collect();
    Ok(PairTime {
        wall_ms: median(runs.iter().map(|(wall_ms, _)| *wall_ms)).unwrap_or(f64::NAN),
        processor_ms: processor.and_then(median),
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::eval::Scene;
    use crate::frame::Size;

    #[test]
    fn the_flow_is_that_of_an_engine_and_the_time_is_measured_on_request() {
        let scene = Scene::new(Size::new(64, 48)).unwrap();
        let images = [scene.frame(0), scene.frame(1)];
        let [first, second] = [images[0].frame().unwrap(), images[1].frame().unwrap()];
        let algorithm = Algorithm::default();
        let found = estimate(&Backend::Cpu, &algorithm, [&first, &second], 2).unwrap();
        let mut engine = Engine::new(Backend::Cpu, scene_size(&found), &Config::default()).unwrap();
        engine.process(&first).unwrap();
        assert_eq!(engine.process(&second).unwrap().unwrap().flow, Some(&found.flow));
        assert!(found.time.is_some_and(|time| time.wall_ms > 0.0));
        assert!(estimate(&Backend::Cpu, &algorithm, [&first, &second], 0).unwrap().time.is_none());
    }

    fn scene_size(found: &Estimate) -> Size {
        assert_eq!(found.confidence.size, found.flow.size);
        found.flow.size
    }

    #[test]
    fn frames_of_two_sizes_are_refused() {
        let frame = |width: u32| Scene::new(Size::new(width, 48)).unwrap().frame(0);
        let images = [frame(64), frame(65)];
        let [first, second] = [images[0].frame().unwrap(), images[1].frame().unwrap()];
        let error = estimate(&Backend::Cpu, &Algorithm::default(), [&first, &second], 0).unwrap_err();
        assert_eq!(error.code(), "size-mismatch");
    }
}
