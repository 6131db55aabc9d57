//! Requests and answers, one JSON object per line, for programs that compare viewsphere with other implementations.
//!
//! The process keeps its devices and engines from one request to the next.

use std::io::BufRead;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::backend::Backend;
use crate::benchmark::timed;
use crate::cli::backend::{BackendArg, BackendArgs};
use crate::cli::print;
use crate::engine::{Config, Engine};
use crate::error::{Error, Result};
use crate::flow::{Algorithm, Farneback, Window};
use crate::frame::{Frame, PixelFormat, Size};
use crate::gpu::Gpu;
use crate::io::{flo, picture};

/// The number of engines kept; more could fill the device's memory.
const MAX_ENGINES: usize = 4;

/// A request to compute the flow between two images, `repeat` times.
#[derive(Deserialize)]
struct Request {
    a: PathBuf,
    b: PathBuf,
    backend: String,
    params: Params,
    repeat: u32,
    /// Whether the first image counts as already processed, as in a stream.
    stream: bool,
    /// The file to write the flow to.
    flow: Option<PathBuf>,
}

#[derive(Deserialize)]
struct Params {
    pyr_scale: f64,
    levels: u32,
    winsize: u32,
    iterations: u32,
    poly_n: u32,
    poly_sigma: f64,
    window: String,
}

#[derive(Serialize, Default)]
struct Answer {
    wall_ms: Vec<f64>,
    adapter: Option<String>,
    error: Option<String>,
    /// The error's [`Error::code`].
    code: Option<&'static str>,
}

struct Server<'a> {
    args: &'a BackendArgs,
    gpu: Option<Gpu>,
    engines: Vec<(Key, Engine)>,
}

type Key = (BackendArg, Size, PixelFormat, Algorithm);

/// Answers requests until standard input ends. A faulty request is answered with its error.
pub(super) fn serve(args: &BackendArgs) -> Result<()> {
    let mut server = Server { args, gpu: None, engines: Vec::new() };
    for line in std::io::stdin().lock().lines() {
        let line = line.map_err(|source| Error::io("standard input", source))?;
        if line.trim().is_empty() {
            continue;
        }
        let answer = match server.answer(&line) {
            Ok(answer) => answer,
            Err(error) => {
                Answer { error: Some(error.to_string()), code: Some(error.code()), ..Answer::default() }
            }
        };
        print::json_line(&answer)?;
    }
    Ok(())
}

impl Server<'_> {
    fn answer(&mut self, line: &str) -> Result<Answer> {
        let request: Request = serde_json::from_str(line)
            .map_err(|error| Error::parameter("request", error, "an object as in benches/opencv.py"))?;
        let [a, b] = picture::read_pair(&request.a, &request.b)?;
        let frames = [a.frame()?, b.frame()?];
        let backend = match request.backend.as_str() {
            "gpu" => BackendArg::Gpu,
            "cpu" => BackendArg::Cpu,
            other => return Err(Error::parameter("backend", other, "gpu or cpu")),
        };
        let engine = self.engine((backend, a.size, a.format, request.params.farneback()?))?;
        let mut answer = Answer { adapter: Some(engine.adapter()), ..Answer::default() };
        for _ in 0..request.repeat {
            answer.wall_ms.push(run(engine, &frames, request.stream)?);
        }
        if let Some(path) = &request.flow {
            engine.reset();
            engine.process(&frames[0])?;
            if let Some(flow) = engine.process(&frames[1])?.and_then(|output| output.flow) {
                flo::write(path, flow)?;
            }
        }
        Ok(answer)
    }

    fn engine(&mut self, key: Key) -> Result<&mut Engine> {
        if let Some(i) = self.engines.iter().position(|(other, _)| *other == key) {
            // The most recently used engine comes last; the first one is dropped.
            let engine = self.engines.remove(i);
            self.engines.push(engine);
        } else {
            let backend = match key.0 {
                BackendArg::Cpu => Backend::Cpu,
                BackendArg::Gpu => {
                    let gpu = match self.gpu.take() {
                        Some(gpu) => gpu,
                        None => self.args.gpu()?,
                    };
                    self.gpu = Some(gpu.clone());
                    Backend::Gpu(gpu)
                }
            };
            let config = Config { algorithm: key.3.clone(), format: key.2, ..Config::default() };
            if self.engines.len() == MAX_ENGINES {
                self.engines.remove(0);
            }
            let engine = Engine::new(backend, key.1, &config)?;
            self.engines.push((key, engine));
        }
        let missing = || Error::parameter("engine", "missing", "one that was just made");
        self.engines.last_mut().map(|(_, engine)| engine).ok_or_else(missing)
    }
}

/// The time from pixels to flow on the host, in milliseconds: of both frames, or with `stream` of the second alone.
fn run(engine: &mut Engine, [a, b]: &[Frame<'_>; 2], stream: bool) -> Result<f64> {
    engine.reset();
    if stream {
        engine.process(a)?;
        let (done, ms) = timed(|| engine.process(b).map(|_| ()));
        return done.map(|()| ms);
    }
    // Submit both before waiting for the first, whose output nobody needs.
    let (done, ms) = timed(|| {
        let first = engine.submit(a)?;
        let second = engine.submit(b)?;
        engine.wait(first)?;
        engine.wait(second).map(|_| ())
    });
    done.map(|()| ms)
}

impl Params {
    fn farneback(&self) -> Result<Algorithm> {
        let window = match self.window.as_str() {
            "box" => Window::Box,
            "gaussian" => Window::Gaussian,
            other => return Err(Error::parameter("window", other, "box or gaussian")),
        };
        let flow = Algorithm::from(Farneback {
            pyr_scale: self.pyr_scale,
            levels: self.levels,
            winsize: self.winsize,
            iterations: self.iterations,
            poly_n: self.poly_n,
            poly_sigma: self.poly_sigma,
            window,
            ..Farneback::default()
        });
        flow.validate()?;
        Ok(flow)
    }
}
