//! The real-time face: frames go in, flow comes out, and nothing waits for ever or grows without bound.
//!
//! A stream of frames is computed pair by pair, each frame with the one before. What was computed of a frame alone is
//! kept for the next pair, and the result is the same, bit for bit, as that of an engine that was given only the two.
//!
//! On the GPU a frame begins to be computed when it is submitted, while the host goes on. On the CPU `submit` copies the
//! frame, and it is computed in [`Engine::poll`] and [`Engine::wait`], on the threads of rayon's pool.

mod clock;
mod config;
mod cpu;
mod figures;
mod flight;
mod gpu;
mod layout;
mod recovery;
mod ring;
mod schedule;
mod slots;
mod stream;

use std::collections::VecDeque;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

pub use config::{Backend, Config, Extras, OnLoss};
pub use figures::{Latency, StageTime, Stats, TimeSource};
#[cfg(feature = "sim")]
pub(crate) use ring::guarded;

use crate::error::{Error, Result};
use crate::frame::{FlowField, Frame, Plane, Size};
use crate::gpu::Gpu;
use crate::plan::Plan;
use cpu::CpuStream;
use figures::Window;
use flight::{Flights, Last};
use gpu::GpuStream;
use layout::Layout;
use stream::Stream;

/// Computes the flow of a stream of frames of one size and format.
///
/// All memory is taken when it is made; a frame takes none, apart from what wgpu and rayon take by themselves.
pub struct Engine {
    id: u64,
    plan: Plan,
    config: Config,
    layout: Layout,
    stream: Stream,
    flights: Flights,
    next: u64,
    /// Counts the beginnings of the stream.
    epoch: u64,
    last: Option<Last>,
    /// Frames whose results went with a device.
    lost: VecDeque<u64>,
    where_lost: String,
    why: String,
    stats: Stats,
    window: Window,
}

/// A frame that was submitted. Copies of it stand for the same frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Ticket {
    engine: u64,
    frame: u64,
}

impl Ticket {
    /// The frame's number, counted from 0 over the engine's life.
    pub fn frame(&self) -> u64 {
        self.frame
    }
}

/// What was computed of a frame and the one before.
#[derive(Clone, Copy, Debug)]
pub struct Output<'a> {
    /// The frame's number.
    pub frame: u64,
    /// The number of the frame that the flow leads from: the one before, unless that one was dropped.
    pub previous: u64,
    /// Displacements in pixels from the previous frame to this one, if [`Config::read_flow`] asks for them.
    pub flow: Option<&'a FlowField>,
    /// How far the flow is to be trusted, if it is computed and [`Config::read_confidence`] asks for it.
    pub confidence: Option<&'a Plane>,
    /// The plan's fields.
    pub(crate) fields: &'a [Vec<f32>],
    /// Time from submit until now.
    pub latency: Duration,
}

impl Engine {
    /// Makes an engine for frames of this size.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a parameter or size that is out of range; [`Error::TooLarge`] and
    /// [`Error::OutOfMemory`] if the adapter has no room for such frames; [`Error::DeviceLost`] if it is gone.
    pub fn new(backend: Backend, size: Size, config: &Config) -> Result<Self> {
        config.validate()?;
        let plan = config.estimator().plan(size, config.format)?;
        Self::with_plan(backend, plan, config)
    }

    /// Makes an engine for a plan of any estimator; the configuration's own is not looked at.
    pub(crate) fn with_plan(backend: Backend, plan: Plan, config: &Config) -> Result<Self> {
        static ENGINES: AtomicU64 = AtomicU64::new(0);
        let stream = match backend {
            Backend::Gpu(gpu) => Stream::Gpu(Box::new(GpuStream::new(&gpu, &plan, config)?)),
            Backend::Cpu => Stream::Cpu(Box::new(CpuStream::new(&plan, config))),
        };
        Ok(Self {
            id: ENGINES.fetch_add(1, Ordering::Relaxed),
            layout: Layout::new(&plan, config),
            flights: Flights::new(config.in_flight),
            next: 0,
            epoch: 0,
            last: None,
            lost: VecDeque::with_capacity(Config::MAX_IN_FLIGHT),
            where_lost: String::new(),
            why: String::new(),
            stats: Stats { on_cpu: !stream.is_gpu(), ..Stats::default() },
            window: Window::new(),
            config: config.clone(),
            stream,
            plan,
        })
    }

    /// Takes a frame. Its pixels are copied, and the call does not wait for anything.
    ///
    /// # Errors
    /// [`Error::SizeMismatch`] and [`Error::PixelFormat`] for a frame of another kind than the stream's;
    /// [`Error::Busy`] if as many frames as [`Config::in_flight`] are submitted and not taken, unless
    /// [`Config::drop_oldest`] makes room; [`Error::DeviceLost`], see [`Engine::wait`]. The stream goes on after all of
    /// them as if the frame had not been there.
    pub fn submit(&mut self, frame: &Frame<'_>) -> Result<Ticket> {
        self.submit_with(frame, &Extras::default())
    }

    /// Takes a frame and what comes with it. See [`Engine::submit`].
    ///
    /// # Errors
    /// As [`Engine::submit`]; also [`Error::Parameter`] for an extra that the configuration does not provide for, and
    /// [`Error::Length`] or [`Error::SizeMismatch`] for one that does not fit the frame.
    pub fn submit_with(&mut self, frame: &Frame<'_>, extras: &Extras<'_>) -> Result<Ticket> {
        self.layout.check(frame, extras)?;
        let taken = self.enqueue(frame, extras);
        self.recovered(taken)
    }

    /// Whether a frame is done, so that [`Engine::wait`] would not wait. On the CPU it computes the frame, and those
    /// before it; on the GPU it waits for nothing.
    ///
    /// # Errors
    /// [`Error::Ticket`] if the frame was taken already, dropped, or is another engine's; [`Error::DeviceLost`], see
    /// [`Engine::wait`].
    pub fn poll(&mut self, ticket: &Ticket) -> Result<bool> {
        self.find(*ticket)?;
        let done = self.bring(ticket.frame, false, None);
        self.recovered(done)
    }

    /// Waits for a frame. None if there is none before it: it is the first, or the first after a reset or a loss.
    ///
    /// # Errors
    /// [`Error::Timeout`] if [`Config::deadline`] has passed since submit and the frame is not done; it may be asked for
    /// again, and then has the same time again from that call on. [`Error::Ticket`] if the frame was taken already,
    /// dropped, or is another engine's. [`Error::DeviceLost`] for every frame that is not done when the GPU is lost; the
    /// next frame is a first frame on the device, which is brought back once, or on the CPU, as [`Config::on_loss`] says.
    pub fn wait(&mut self, ticket: Ticket) -> Result<Option<Output<'_>>> {
        let taken = self.take(ticket)?;
        Ok(self.output(&taken))
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
        let ticket = self.submit_with(frame, extras)?;
        let taken = self.take(ticket);
        if let Err(Error::Timeout { .. }) = taken {
            self.give_up(ticket.frame);
        }
        let taken = taken?;
        Ok(self.output(&taken))
    }

    /// Begins the stream anew: the next frame is a first frame, and a warm start forgets. Frames in flight stay valid.
    pub fn reset(&mut self) {
        self.epoch += 1;
    }

    /// What computes: the adapter's name, or the CPU and its threads.
    pub fn adapter(&self) -> String {
        self.stream.adapter()
    }

    /// The device in use, if it is a GPU; after a loss it is another one than before.
    pub fn gpu(&self) -> Option<&Gpu> {
        match &self.stream {
            Stream::Gpu(gpu) => Some(&gpu.gpu),
            _ => None,
        }
    }

    /// The latencies of the last frames that gave a result.
    pub fn latency(&self) -> Latency {
        self.window.latency()
    }

    /// What was counted.
    pub fn stats(&self) -> Stats {
        self.stats
    }

    /// The time of each step of the last frame: on the GPU of the last one taken, on the CPU of the last one computed.
    /// Empty without [`Config::timestamps`], if the device cannot tell, or if what it told of that frame made no sense.
    pub fn stage_times(&self) -> &[StageTime] {
        self.stream.stage_times()
    }

    /// Where [`Engine::stage_times`] come from.
    pub fn time_source(&self) -> TimeSource {
        self.stream.time_source(self.config.timestamps)
    }

    /// Bytes of the plan's buffers and of those for the frames in flight.
    pub fn buffer_bytes(&self) -> u64 {
        self.plan.bytes() + self.stream.bytes()
    }

    /// What is computed of a frame.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }
}
