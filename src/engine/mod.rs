//! Flow of a stream of frames, in real time.
//!
//! An engine is a [`Stream`] of the plan of an estimator: see there for how frames are submitted, waited for, dropped and
//! lost.

mod config;

use std::time::Duration;

pub use config::{Config, Extras};

use crate::backend::Backend;
use crate::error::{Error, Result};
use crate::flow;
use crate::frame::{FlowField, Frame, Plane, Size};
use crate::gpu::Gpu;
use crate::plan::{Plan, Value};
use crate::stream::{Done, Latency, StageTime, Stats, Stream, Ticket, TimeSource};

/// Computes the flow of a stream of frames of one size and format.
///
/// All memory is taken when it is made; a frame takes none, apart from what wgpu and rayon take by themselves.
pub struct Engine {
    stream: Stream<()>,
}

/// What was computed of a frame and the previous one.
#[derive(Clone, Copy, Debug)]
pub struct Output<'a> {
    /// The frame's number.
    pub frame: u64,
    /// The number of the frame that the flow leads from: the previous one, unless that one was dropped.
    pub previous: u64,
    /// Displacements in pixels from the previous frame to this one, if [`Config::read_flow`] asks for them.
    pub flow: Option<&'a FlowField>,
    /// How far the flow is to be trusted, 0 to 1, if [`Config::confidence`] asks for it.
    pub confidence: Option<&'a Plane>,
    /// Time from submit until now.
    pub latency: Duration,
}

/// An [`Output`] that owns its fields.
#[derive(Clone, Debug, PartialEq)]
pub struct OwnedOutput {
    /// As [`Output::frame`].
    pub frame: u64,
    /// As [`Output::previous`].
    pub previous: u64,
    /// As [`Output::flow`].
    pub flow: Option<FlowField>,
    /// As [`Output::confidence`].
    pub confidence: Option<Plane>,
    /// As [`Output::latency`].
    pub latency: Duration,
}

impl<'a> Output<'a> {
    fn of(done: Done<'a, ()>) -> Option<Self> {
        let outputs = done.outputs?;
        Some(Self {
            frame: done.frame,
            previous: done.previous?,
            flow: outputs.flow("flow"),
            confidence: outputs.plane("confidence"),
            latency: done.latency,
        })
    }

    /// A copy that owns its fields, and outlives the engine's next call.
    pub fn to_owned(&self) -> OwnedOutput {
        OwnedOutput {
            frame: self.frame,
            previous: self.previous,
            flow: self.flow.cloned(),
            confidence: self.confidence.cloned(),
            latency: self.latency,
        }
    }
}

impl Engine {
    /// Makes an engine for frames of this size.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a parameter or size that is out of range; [`Error::TooLarge`] and
    /// [`Error::OutOfMemory`] if the adapter has no room for such frames; [`Error::DeviceLost`] if it is gone.
    pub fn new(backend: Backend, size: Size, config: &Config) -> Result<Self> {
        config.validate()?;
        let mut plan = flow::plan(&config.algorithm, size, config.format, config.options())?;
        plan.outputs.retain(|port| config.read_flow || port.name != "flow");
        Ok(Self { stream: Stream::new(&backend, plan, &config.stream)? })
    }

    /// Takes a frame. Its pixels are copied, and the call does not wait for anything.
    ///
    /// # Errors
    /// [`Error::SizeMismatch`] and [`Error::PixelFormat`] for a frame of another kind than the stream's; otherwise as
    /// [`Stream::submit`].
    pub fn submit(&mut self, frame: &Frame<'_>) -> Result<Ticket> {
        self.submit_with(frame, &Extras::default())
    }

    /// Takes a frame and what comes with it. See [`Engine::submit`].
    ///
    /// # Errors
    /// As [`Engine::submit`]; also [`Error::Parameter`] for an extra that the configuration does not provide for, and
    /// [`Error::Length`] or [`Error::SizeMismatch`] for one that does not fit the frame.
    pub fn submit_with(&mut self, frame: &Frame<'_>, extras: &Extras<'_>) -> Result<Ticket> {
        self.check(extras)?;
        self.stream.submit(&given(frame, extras), ())
    }

    /// Whether a frame is done. See [`Stream::poll`].
    ///
    /// # Errors
    /// As [`Stream::poll`].
    pub fn poll(&mut self, ticket: &Ticket) -> Result<bool> {
        self.stream.poll(ticket)
    }

    /// Waits for a frame. None if it has no previous one: it is the first, or the first after a reset or a loss.
    ///
    /// # Errors
    /// As [`Stream::wait`].
    pub fn wait(&mut self, ticket: Ticket) -> Result<Option<Output<'_>>> {
        Ok(Output::of(self.stream.wait(ticket)?))
    }

    /// Submits a frame and waits for it.
    ///
    /// # Errors
    /// As [`Engine::submit`] and [`Engine::wait`]. A frame that is late is given up and counted as dropped.
    pub fn process(&mut self, frame: &Frame<'_>) -> Result<Option<Output<'_>>> {
        self.process_with(frame, &Extras::default())
    }

    /// Submits a frame and what comes with it, and waits for it.
    ///
    /// # Errors
    /// As [`Engine::submit_with`] and [`Engine::wait`]. A frame that is late is given up and counted as dropped.
    pub fn process_with(&mut self, frame: &Frame<'_>, extras: &Extras<'_>) -> Result<Option<Output<'_>>> {
        self.check(extras)?;
        Ok(Output::of(self.stream.process(&given(frame, extras), ())?))
    }

    /// Begins the stream anew: the next frame is a first frame, and a warm start forgets. Frames in flight stay valid.
    pub fn reset(&mut self) {
        self.stream.reset();
    }

    fn check(&self, extras: &Extras<'_>) -> Result<()> {
        let plan = self.stream.plan();
        if extras.certainty.is_some() && plan.input("certainty").is_none() {
            return Err(Error::parameter("certainty", "given", "none, as Config::certainty is off"));
        }
        if extras.initial_flow.is_some() && plan.input("initial_flow").is_none() {
            let expected = "none, as Config::initial_flow and Config::warm_start are off";
            return Err(Error::parameter("initial_flow", "given", expected));
        }
        Ok(())
    }

    /// What computes: the adapter's name, or the CPU and its threads.
    pub fn adapter(&self) -> String {
        self.stream.adapter()
    }

    /// The device in use, if it is a GPU; after a loss it is another one than before.
    pub fn gpu(&self) -> Option<&Gpu> {
        self.stream.gpu()
    }

    /// The latencies of the last frames that gave a result.
    pub fn latency(&self) -> Latency {
        self.stream.latency()
    }

    /// What was counted.
    pub fn stats(&self) -> Stats {
        self.stream.stats()
    }

    /// The time of each step of the last frame. See [`Stream::stage_times`].
    pub fn stage_times(&self) -> &[StageTime] {
        self.stream.stage_times()
    }

    /// Where [`Engine::stage_times`] come from.
    pub fn time_source(&self) -> TimeSource {
        self.stream.time_source()
    }

    /// Bytes of the plan's buffers and of those for the frames in flight.
    pub fn buffer_bytes(&self) -> u64 {
        self.stream.buffer_bytes()
    }

    /// What is computed of a frame.
    pub fn plan(&self) -> &Plan {
        self.stream.plan()
    }
}

fn given<'a>(frame: &'a Frame<'a>, extras: &Extras<'a>) -> [crate::plan::Given<'a>; 3] {
    [
        ("frame", Some(Value::Frame(frame))),
        ("certainty", extras.certainty.map(Value::Plane)),
        ("initial_flow", extras.initial_flow.map(Value::Flow)),
    ]
}
