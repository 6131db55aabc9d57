//! The time of a frame of a stream, and of each kernel in it.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use super::copy;
use super::figures::{KernelFigures, Startup, StreamFigures};
use super::times::{Times, timed};
use crate::backend::Backend;
use crate::engine::{Config, Engine};
use crate::error::{Error, Result};
use crate::eval::Scene;
use crate::flow::{self, Algorithm};
use crate::frame::{Image, Size};
use crate::gpu::FlopCounter;
use crate::plan::{BufId, Plan};
use crate::stream::{StreamConfig, TimeSource};

/// Frames of the synthetic scene, played forwards and backwards.
const FRAMES: u32 = 6;
/// Frames before the measurement begins.
const WARM_UP: u32 = 4;

/// Times a stream of synthetic frames on one backend at one frame size.
///
/// The time of a frame includes its upload and the readback of the flow. Kernels are timed in a second run: on the GPU by its
/// own clock, on the CPU around each step; kernels that only an option uses are timed in a third run.
///
/// # Errors
/// [`Error::Parameter`] for a number of frames outside 2 to 100 000, and for a size or an algorithm out of range; what the
/// device fails with.
pub fn stream(backend: &Backend, size: Size, algorithm: &Algorithm, frames: u32) -> Result<StreamFigures> {
    check_frames(frames)?;
    let config = Config { algorithm: algorithm.clone(), ..Config::default() };
    let (engine, engine_ms) = timed(|| Engine::new(backend.clone(), size, &config));
    let mut engine = engine?;
    let scene = Scene::new(size)?;
    let images: Vec<Image> = (0..FRAMES).map(|number| scene.frame(number)).collect();
    let mut run = |number: u32| {
        let frame = played(&images, number).frame()?;
        let (done, ms) = timed(|| engine.process(&frame).map(|_| ()));
        done.map(|()| ms)
    };
    let first_frame_ms = run(0)?;
    let first_pair_ms = run(1)?;
    let times = (2..2 + WARM_UP + frames).map(&mut run).collect::<Result<Vec<f64>>>()?;
    let frame_ms = Times::new(times[WARM_UP as usize..].to_vec());
    let (name, buffer_bytes) = (engine.adapter(), engine.buffer_bytes());
    drop(engine);

    let values = largest(&flow::plan(algorithm, size, config.format, config.options())?);
    let copy_gb_s = match backend {
        Backend::Gpu(gpu) => copy::gpu(gpu, values)?,
        Backend::Cpu => copy::cpu(values),
    };
    let stream = StreamConfig { timestamps: true, ..config.stream.clone() };
    let timed_config = Config { stream, ..config };
    let mut engine = Engine::new(backend.clone(), size, &timed_config)?;
    let (clock, mut kernels) = kernels_of(&mut engine, &images, frames, copy_gb_s)?;
    drop(engine);
    // Kernels that only an option uses: measured in a second run with every option on.
    let every_option = Config { initial_flow: true, certainty: true, confidence: true, ..timed_config };
    let mut engine = Engine::new(backend.clone(), size, &every_option)?;
    let (_, optional) = kernels_of(&mut engine, &images, frames, copy_gb_s)?;
    let known: Vec<&str> = kernels.iter().map(|figures| figures.kernel).collect();
    let optional = optional.into_iter().filter(|figures| !known.contains(&figures.kernel));
    kernels.extend(optional.map(|figures| KernelFigures { optional: true, ..figures }));
    Ok(StreamFigures {
        backend: name,
        width: size.width,
        height: size.height,
        frames,
        startup: Startup { engine_ms, first_frame_ms, first_pair_ms },
        frame_ms,
        buffer_bytes,
        copy_gb_s,
        clock,
        kernels,
    })
}

fn kernels_of(
    engine: &mut Engine,
    images: &[Image],
    frames: u32,
    copy_gb_s: f64,
) -> Result<(&'static str, Vec<KernelFigures>)> {
    // Kernels in the order of their first step, each with its summed time per frame.
    let mut sums: Vec<(&'static str, Vec<f64>)> = Vec::new();
    for number in 0..1 + WARM_UP + frames {
        engine.process(&played(images, number).frame()?)?;
        let mut frame: Vec<(&'static str, f64)> = Vec::new();
        for stage in engine.stage_times() {
            let ms = stage.time.as_secs_f64() * 1e3;
            match frame.iter_mut().find(|(kernel, _)| *kernel == stage.kernel) {
                Some((_, sum)) => *sum += ms,
                None => frame.push((stage.kernel, ms)),
            }
        }
        for (kernel, ms) in frame.into_iter().filter(|_| number > WARM_UP) {
            match sums.iter_mut().find(|(other, _)| *other == kernel) {
                Some((_, times)) => times.push(ms),
                None => sums.push((kernel, vec![ms])),
            }
        }
    }
    let clock = match engine.time_source() {
        TimeSource::None => "none",
        TimeSource::Gpu => "gpu",
        TimeSource::Host => "host",
    };
    let work = work(engine.plan())?;
    let figures = sums.into_iter().map(|(kernel, times)| {
        let Work { steps, bytes, flops } = work.get(kernel).copied().unwrap_or_default();
        let ms = Times::new(times);
        let gb_s = bytes as f64 / ms.median / 1e6;
        KernelFigures {
            kernel,
            optional: false,
            steps,
            ms,
            bytes,
            flops,
            gb_s,
            share_of_copy: gb_s / copy_gb_s,
        }
    });
    Ok((clock, figures.collect()))
}

/// The work of a kernel in a frame.
#[derive(Clone, Copy, Default)]
struct Work {
    /// The number of its steps.
    steps: usize,
    /// The bytes that they read and write.
    bytes: u64,
    flops: Option<u64>,
}

/// The work of each kernel in a frame.
///
/// Levels share buffers, so an input counts with the size last written to it, not with the size of its buffer.
fn work(plan: &Plan) -> Result<HashMap<&'static str, Work>> {
    let mut written: HashMap<BufId, usize> = HashMap::new();
    let mut counters = HashMap::new();
    let mut work = HashMap::new();
    for (parity, step) in [0, 1].into_iter().flat_map(|p| plan.steps(p).map(move |step| (p, step))) {
        let mut values = 0;
        for input in &step.inputs {
            values += written.get(input).copied().unwrap_or_else(|| plan.buf(*input).len);
        }
        for (output, shape) in &step.outputs {
            values += shape.len();
            written.insert(*output, shape.len());
        }
        if parity == 1 {
            let counter: &FlopCounter = match counters.entry(step.kernel.name) {
                Entry::Occupied(entry) => entry.into_mut(),
                Entry::Vacant(entry) => entry.insert(FlopCounter::new(step.kernel)?),
            };
            let of_kernel =
                work.entry(step.kernel.name).or_insert(Work { flops: Some(0), ..Work::default() });
            of_kernel.steps += 1;
            of_kernel.bytes += 4 * values as u64;
            of_kernel.flops = of_kernel.flops.zip(counter.of_step(step)).map(|(sum, own)| sum + own);
        }
    }
    Ok(work)
}

/// Checks the number of frames to time.
pub(super) fn check_frames(frames: u32) -> Result<()> {
    match (2..=100_000).contains(&frames) {
        true => Ok(()),
        false => Err(Error::parameter("frames", frames, "2 to 100000")),
    }
}

/// The length of the plan's largest buffer, in values.
fn largest(plan: &Plan) -> usize {
    plan.bufs.iter().map(|buf| buf.len).max().unwrap_or(1)
}

fn played(images: &[Image], number: u32) -> &Image {
    let turn = images.len() - 1;
    let at = number as usize % (2 * turn);
    &images[if at > turn { 2 * turn - at } else { at }]
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::flow::{Farneback, FlowOptions};
    use crate::frame::PixelFormat;

    #[test]
    fn frames_are_played_forth_and_back() {
        let image = |gray| Image { data: vec![gray], ..Image::default() };
        let images = [image(0), image(1), image(2)];
        let order: Vec<u8> = (0..6).map(|number| played(&images, number).data[0]).collect();
        assert_eq!(order, [0, 1, 2, 1, 0, 1]);
    }

    #[test]
    fn moved_bytes_are_those_of_each_level_not_of_the_shared_buffer() {
        let size = Size::new(64, 64);
        let algorithm = Algorithm::from(Farneback { levels: 1, ..Farneback::default() });
        let plan = flow::plan(&algorithm, size, PixelFormat::Gray8, FlowOptions::default()).unwrap();
        let work = work(&plan).unwrap();
        let moved = |kernel: &str| (work[kernel].steps, work[kernel].bytes);
        // One frame of u8 in, one plane of f32 out.
        assert_eq!(moved("luma"), (1, 64 * 64 * 5));
        // Two levels, each reading one plane and its weights and writing three planes.
        let step = plan.ingest[0].iter().find(|step| step.kernel.name == "expansion_y").unwrap();
        let weights = plan.buf(step.inputs[1]).len as u64;
        assert!(weights < 100, "{weights}");
        let planes = 4 * 4 * (64 * 64 + 32 * 32);
        assert_eq!(moved("expansion_y"), (2, planes + 2 * 4 * weights));
    }
}
