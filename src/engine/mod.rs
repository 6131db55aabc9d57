//! The engine: optical flow of a stream of frames, in real time.
//!
//! An engine is a [`Stream`] that runs the plan of a flow estimator. [`Stream`] describes how frames are submitted,
//! waited for, dropped and lost.

mod config;

use std::time::Duration;

pub use config::{Config, FrameInputs};

use crate::backend::Backend;
use crate::error::{Error, Result};
use crate::flow;
use crate::frame::{FlowField, Frame, Plane, Size};
use crate::gpu::Gpu;
use crate::plan::{Plan, Value};
use crate::stream::{Done, Latency, StageTime, Stats, Stream, Ticket, TimeSource};

/// Computes the flow of a stream of frames of one size and format.
///
/// [`Engine::new`] allocates all memory; a frame allocates none, apart from wgpu's and rayon's own allocations.
pub struct Engine {
    stream: Stream<()>,
}

/// The flow of a frame and the previous one.
#[derive(Clone, Copy, Debug)]
pub struct Output<'a> {
    /// The frame's number.
    pub frame: u64,
    /// The number of the frame from which the flow leads: the previous one, unless that one was dropped.
    pub previous: u64,
    /// Displacements in pixels from the previous frame to this one, one per pixel of the frame, if
    /// [`Config::read_flow`] asks for them.
    pub flow: Option<&'a FlowField>,
    /// The confidence of each pixel's flow, 0 to 1, if [`Config::confidence`] asks for it.
    pub confidence: Option<&'a Plane>,
    /// Time from the submit to the return of the wait.
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
    pub fn into_owned(self) -> OwnedOutput {
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
    /// Creates an engine for frames of this size.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a parameter or size that is out of range; [`Error::TooLarge`] and
    /// [`Error::OutOfMemory`] if the adapter has no room for such frames; [`Error::DeviceLost`] if its device is lost.
    pub fn new(backend: Backend, size: Size, config: &Config) -> Result<Self> {
        config.validate()?;
        let mut plan = flow::plan(&config.algorithm, size, config.format, config.options())?;
        plan.outputs.retain(|port| config.read_flow || port.name != "flow");
        Ok(Self { stream: Stream::new(&backend, plan, &config.stream)? })
    }

    /// Submits a frame. Its pixels are copied; the call does not wait.
    ///
    /// # Errors
    /// [`Error::SizeMismatch`] and [`Error::PixelFormat`] for a frame of another kind than the stream's; otherwise as
    /// [`Stream::submit`].
    pub fn submit(&mut self, frame: &Frame<'_>) -> Result<Ticket> {
        self.submit_with(frame, &FrameInputs::default())
    }

    /// Submits a frame with further inputs. See [`Engine::submit`].
    ///
    /// # Errors
    /// As [`Engine::submit`]; also [`Error::Parameter`] for an input that the configuration does not allow, and
    /// [`Error::Length`] or [`Error::SizeMismatch`] for one that does not fit the frame.
    pub fn submit_with(&mut self, frame: &Frame<'_>, frame_inputs: &FrameInputs<'_>) -> Result<Ticket> {
        self.check(frame_inputs)?;
        self.stream.submit(&given(frame, frame_inputs), ())
    }

    /// Whether a frame is done. See [`Stream::poll`].
    ///
    /// # Errors
    /// As [`Stream::poll`].
    pub fn poll(&mut self, ticket: &Ticket) -> Result<bool> {
        self.stream.poll(ticket)
    }

    /// Waits for a frame. `None` if it has no previous frame: it is the first one, or the first one after a reset or a
    /// loss.
    ///
    /// # Errors
    /// As [`Stream::wait`].
    pub fn wait(&mut self, ticket: Ticket) -> Result<Option<Output<'_>>> {
        Ok(Output::of(self.stream.wait(ticket)?))
    }

    /// Submits a frame and waits for it.
    ///
    /// # Errors
    /// As [`Engine::submit`] and [`Engine::wait`]. A frame that misses its deadline is given up and counted as dropped.
    pub fn process(&mut self, frame: &Frame<'_>) -> Result<Option<Output<'_>>> {
        self.process_with(frame, &FrameInputs::default())
    }

    /// Submits a frame with further inputs and waits for it.
    ///
    /// # Errors
    /// As [`Engine::submit_with`] and [`Engine::wait`]. A frame that misses its deadline is given up and counted as
    /// dropped.
    pub fn process_with(
        &mut self,
        frame: &Frame<'_>,
        frame_inputs: &FrameInputs<'_>,
    ) -> Result<Option<Output<'_>>> {
        self.check(frame_inputs)?;
        Ok(Output::of(self.stream.process(&given(frame, frame_inputs), ())?))
    }

    /// Restarts the stream: the next frame is a first frame, and a warm start forgets the previous flow. Frames in
    /// flight stay valid.
    pub fn reset(&mut self) {
        self.stream.reset();
    }

    fn check(&self, frame_inputs: &FrameInputs<'_>) -> Result<()> {
        let plan = self.stream.plan();
        if frame_inputs.certainty.is_some() && plan.input("certainty").is_none() {
            return Err(Error::parameter("certainty", "given", "none, as Config::certainty is off"));
        }
        if frame_inputs.initial_flow.is_some() && plan.input("initial_flow").is_none() {
            let expected = "none, as Config::initial_flow and Config::warm_start are off";
            return Err(Error::parameter("initial_flow", "given", expected));
        }
        Ok(())
    }

    /// The executor: the adapter's name, or the CPU and its number of threads.
    pub fn adapter(&self) -> String {
        self.stream.adapter()
    }

    /// The device in use, if it is a GPU. After a loss it is a new device.
    pub fn gpu(&self) -> Option<&Gpu> {
        self.stream.gpu()
    }

    /// The latencies of the last frames with a result.
    pub fn latency(&self) -> Latency {
        self.stream.latency()
    }

    /// The stream's counts.
    pub fn stats(&self) -> Stats {
        self.stream.stats()
    }

    /// The time of each step of the last frame. See [`Stream::stage_times`].
    pub fn stage_times(&self) -> &[StageTime] {
        self.stream.stage_times()
    }

    /// The clock of [`Engine::stage_times`].
    pub fn time_source(&self) -> TimeSource {
        self.stream.time_source()
    }

    /// Total size of the plan's buffers and of the buffers for frames in flight, in bytes.
    pub fn buffer_bytes(&self) -> u64 {
        self.stream.buffer_bytes()
    }

    /// The computation of a frame.
    pub fn plan(&self) -> &Plan {
        self.stream.plan()
    }
}

fn given<'a>(frame: &'a Frame<'a>, frame_inputs: &FrameInputs<'a>) -> [crate::plan::Given<'a>; 3] {
    [
        ("frame", Some(Value::Frame(frame))),
        ("certainty", frame_inputs.certainty.map(Value::Plane)),
        ("initial_flow", frame_inputs.initial_flow.map(Value::Flow)),
    ]
}
