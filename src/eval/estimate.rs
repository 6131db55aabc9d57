//! Runs an algorithm on a pair of frames.

use crate::backend::Backend;
use crate::engine::{Config, Engine};
use crate::error::{Error, Result};
use crate::flow::Algorithm;
use crate::frame::{FlowField, Frame, Plane};

/// The flow of a pair.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// The flow in pixels, from the first frame to the second.
    pub flow: FlowField,
    /// Its confidence per pixel, 0 to 1.
    pub confidence: Plane,
}

/// The time that a pair takes: both frames from the host's memory to the flow in the host's memory, without a
/// confidence. In a stream, where the results of the previous frame are kept, a frame takes less.
/// [`benchmark::pair_time`](crate::benchmark::pair_time) measures it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PairTime {
    /// Wall time in milliseconds: the median of all repetitions.
    pub wall_ms: f64,
    /// Processor time of all threads in milliseconds: the median. `None` where the system does not tell it (other than
    /// Linux).
    pub processor_ms: Option<f64>,
}

/// Computes the flow of a pair and its confidence.
///
/// # Errors
/// As [`Engine::new`] and [`Engine::process`].
pub fn estimate(backend: &Backend, algorithm: &Algorithm, frames: [&Frame<'_>; 2]) -> Result<Estimate> {
    let config = Config {
        algorithm: algorithm.clone(),
        format: frames[0].format(),
        confidence: true,
        ..Config::default()
    };
    let mut engine = Engine::new(backend.clone(), frames[0].size(), &config)?;
    let missing = || Error::parameter("flow", "missing", "one for the second frame");
    engine.process(frames[0])?;
    let output = engine.process(frames[1])?.ok_or_else(missing)?.into_owned();
    let (flow, confidence) = output.flow.zip(output.confidence).ok_or_else(missing)?;
    Ok(Estimate { flow, confidence })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::eval::Scene;
    use crate::frame::Size;

    #[test]
    fn the_flow_is_that_of_an_engine() {
        let size = Size::new(64, 48);
        let scene = Scene::new(size).unwrap();
        let images = [scene.frame(0), scene.frame(1)];
        let [first, second] = [images[0].frame().unwrap(), images[1].frame().unwrap()];
        let found = estimate(&Backend::Cpu, &Algorithm::default(), [&first, &second]).unwrap();
        let mut engine = Engine::new(Backend::Cpu, size, &Config::default()).unwrap();
        engine.process(&first).unwrap();
        assert_eq!(engine.process(&second).unwrap().unwrap().flow, Some(&found.flow));
        assert_eq!(found.confidence.size, size);
    }

    #[test]
    fn frames_of_two_sizes_are_refused() {
        let frame = |width: u32| Scene::new(Size::new(width, 48)).unwrap().frame(0);
        let images = [frame(64), frame(65)];
        let [first, second] = [images[0].frame().unwrap(), images[1].frame().unwrap()];
        let error = estimate(&Backend::Cpu, &Algorithm::default(), [&first, &second]).unwrap_err();
        assert_eq!(error.code(), "size-mismatch");
    }
}
