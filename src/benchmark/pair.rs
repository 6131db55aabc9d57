//! The time of a pair.

use super::processor_time::ProcessorTime;
use super::timed;
use crate::backend::Backend;
use crate::engine::{Config, Engine};
use crate::error::{Error, Result};
use crate::eval::PairTime;
use crate::flow::Algorithm;
use crate::frame::Frame;
use crate::quantile::median;

/// Measures how long the flow of a pair takes, without a confidence: the median of `repeats` runs, at least 1, after one run
/// that is not timed.
///
/// # Errors
/// [`Error::Parameter`] for no repetitions; as [`Engine::new`] and [`Engine::process`].
pub fn pair_time(
    backend: &Backend,
    algorithm: &Algorithm,
    frames: [&Frame<'_>; 2],
    repeats: u32,
) -> Result<PairTime> {
    let config = Config { algorithm: algorithm.clone(), format: frames[0].format(), ..Config::default() };
    let mut engine = Engine::new(backend.clone(), frames[0].size(), &config)?;
    let mut run = || -> Result<(f64, Option<f64>)> {
        engine.reset();
        let start = ProcessorTime::now();
        let (done, wall_ms) = timed(|| {
            engine.process(frames[0])?;
            engine.process(frames[1]).map(|_| ())
        });
        done?;
        Ok((wall_ms, start.and_then(|start| Some(ProcessorTime::now()?.ms_since(start)))))
    };
    run()?;
    let runs = (0..repeats).map(|_| run()).collect::<Result<Vec<_>>>()?;
    let none = || Error::parameter("repeats", repeats, "1 and more");
    let processor: Option<Vec<f64>> = runs.iter().map(|(_, processor_ms)| *processor_ms).collect();
    Ok(PairTime {
        wall_ms: median(runs.iter().map(|(wall_ms, _)| *wall_ms)).ok_or_else(none)?,
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
    fn a_pair_takes_time() {
        let scene = Scene::new(Size::new(64, 48)).unwrap();
        let images = [scene.frame(0), scene.frame(1)];
        let frames = [images[0].frame().unwrap(), images[1].frame().unwrap()];
        let time =
            |repeats| pair_time(&Backend::Cpu, &Algorithm::default(), [&frames[0], &frames[1]], repeats);
        assert!(time(2).unwrap().wall_ms > 0.0);
        assert_eq!(time(0).unwrap_err().to_string(), "repeats is 0, expected 1 and more");
    }
}
