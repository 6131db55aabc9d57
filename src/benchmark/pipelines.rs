//! The cost of whole pipelines, from raw frames to sectors, compared with the flow alone frame by frame in one run.

use std::time::Instant;

use glam::DVec3;

use super::stream::check_frames;
use super::times::Times;
use crate::backend::Backend;
use crate::camera::{Camera, Lens};
use crate::engine::{Config, Engine};
use crate::error::Result;
use crate::eval::Scene;
use crate::flow::Algorithm;
use crate::frame::{Image, Size};
use crate::imu::{GyroConfig, GyroSample};
use crate::pipeline::{Pipeline, PipelineConfig};
use crate::sphere::{Derotation, Sphere};

/// Frames before the measurement begins.
const WARM_UP: u32 = 4;
/// Frames of the synthetic scene.
const FRAMES: u32 = 6;
/// Frame rate.
const RATE_HZ: f64 = 30.0;

/// One of the computations that are compared.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Contender {
    /// The computation's name.
    pub name: &'static str,
    /// The time of a frame.
    pub ms: Times,
    /// The median of the per-frame ratios to the flow alone, in a stream.
    pub of_stream: f64,
    /// The median of the per-frame ratios to the flow alone, of separate pairs.
    pub of_pairs: f64,
}

/// The figures of one backend at one frame size.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct PipelineFigures {
    /// The name of the GPU adapter, or of the CPU backend.
    pub backend: String,
    /// The frames' width in pixels.
    pub width: u32,
    /// The frames' height in pixels.
    pub height: u32,
    /// The number of frames timed.
    pub frames: u32,
    /// The computations, the flow alone first.
    pub contenders: Vec<Contender>,
}

/// What a contender runs per frame.
type FrameFn<'a> = Box<dyn FnMut(u32) -> Result<()> + 'a>;

/// Times whole pipelines on one backend at one frame size, interleaved frame by frame with the flow alone.
///
/// # Errors
/// [`Error::Parameter`](crate::Error::Parameter) for a number of frames outside 2 to 100 000, and for a size or an algorithm
/// out of range; what the device fails with.
pub fn pipelines(
    backend: &Backend,
    size: Size,
    algorithm: &Algorithm,
    frames: u32,
) -> Result<PipelineFigures> {
    check_frames(frames)?;
    let scene = Scene::new(size)?;
    let images: Vec<Image> = (0..FRAMES).map(|number| scene.frame(number)).collect();
    let image = |number: u32| images[(number % FRAMES) as usize].frame();
    let config = Config { algorithm: algorithm.clone(), read_flow: false, ..Config::default() };
    let mut stream = Engine::new(backend.clone(), size, &config)?;
    let mut pairs = Engine::new(backend.clone(), size, &config)?;
    let name = stream.adapter();
    let mut contenders: Vec<(&'static str, FrameFn<'_>)> = vec![
        ("flow alone, stream", Box::new(|number| stream.process(&image(number)?).map(|_| ()))),
        (
            "flow alone, separate pairs",
            Box::new(|number| {
                pairs.reset();
                pairs.process(&image(number + 1)?)?;
                pairs.process(&image(number)?).map(|_| ())
            }),
        ),
    ];
    let gyro = Some(GyroConfig::default());
    for (name, gyro, derotation, certainty) in [
        ("to sectors, no gyro", None, Derotation::Before, false),
        ("to sectors, derotated after", gyro, Derotation::After, false),
        ("to sectors, search primed with the rotation", gyro, Derotation::Primed, false),
        ("to sectors, derotated before", gyro, Derotation::Before, false),
        ("the same, with certainty", gyro, Derotation::Before, true),
    ] {
        let config = PipelineConfig {
            algorithm: algorithm.clone(),
            certainty,
            sphere: Sphere { derotation, ..Sphere::default() },
            gyro,
            ..PipelineConfig::default()
        };
        let mut pipeline = Pipeline::new(backend.clone(), &camera(size)?, &config)?;
        let run = move |number: u32| {
            let time_s = f64::from(number) / RATE_HZ;
            for i in 0..4 {
                let gyro_rad_s = DVec3::new(0.1, -0.4, 0.8);
                let time_s = time_s + f64::from(i) / (4.0 * RATE_HZ);
                pipeline.push_gyro(GyroSample { time_s, gyro_rad_s });
            }
            pipeline.process(&image(number)?, time_s).map(|_| ())
        };
        contenders.push((name, Box::new(run)));
    }
    let mut times: Vec<Vec<f64>> = vec![Vec::new(); contenders.len()];
    for number in 0..frames + WARM_UP {
        for (times, (_, run)) in times.iter_mut().zip(&mut contenders) {
            let start = Instant::now();
            run(number)?;
            if number >= WARM_UP {
                times.push(start.elapsed().as_secs_f64() * 1e3);
            }
        }
    }
    let ratio =
        |of: &[f64], to: &[f64]| Times::new(of.iter().zip(to).map(|(of, to)| of / to).collect()).median;
    let figures = |(times_of, (name, _)): (&Vec<f64>, &(&'static str, FrameFn<'_>))| Contender {
        name,
        ms: Times::new(times_of.clone()),
        of_stream: ratio(times_of, &times[0]),
        of_pairs: ratio(times_of, &times[1]),
    };
    let contenders = times.iter().zip(&contenders).map(figures).collect();
    Ok(PipelineFigures { backend: name, width: size.width, height: size.height, frames, contenders })
}

/// A wide-angle camera with typical barrel distortion.
fn camera(size: Size) -> Result<Camera> {
    let [width, height] = [size.width, size.height].map(f64::from);
    let lens = Lens::new(&[-0.28, 0.075, 3e-4, -2e-4, 0.0])?;
    Ok(Camera { size, f_u: 0.53 * width, f_v: 0.53 * width, u_0: 0.504 * width, v_0: 0.492 * height, lens })
}
