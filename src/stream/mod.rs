//! Runs any plan on a stream of frames in real time, with bounded waiting and bounded memory.
//!
//! A stream of frames is computed pair by pair, each frame with the previous one. The results of a frame alone are kept
//! for the next pair. If the plan carries nothing from pair to pair, the result of a pair equals, bit for bit, that of a
//! stream of these two frames only.
//!
//! On the GPU the computation of a frame starts at its submission, while the host goes on. On the CPU `submit` copies
//! the frame, and [`Stream::poll`] and [`Stream::wait`] compute it on the threads of rayon's pool.

mod clock;
mod config;
mod cpu;
mod gpu;
mod in_flight;
mod job;
mod layout;
mod recovery;
mod ring;
mod schedule;
mod stats;
mod worker;

use std::collections::VecDeque;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

pub use config::{OnLoss, StreamConfig};
pub use stats::{Latency, StageTime, Stats, TimeSource};

use crate::backend::Backend;
use crate::error::{Error, Result};
use crate::gpu::Gpu;
use crate::plan::{Given, Outputs, Plan};
use in_flight::{InFlightList, Last};
use stats::Window;
use worker::Worker;

/// Runs a plan on a stream of frames.
///
/// [`Stream::new`] allocates all memory; a frame allocates none, apart from wgpu's and rayon's own allocations. The
/// caller hands over a payload of type `P` with every frame, and gets it back with the frame's outputs.
pub struct Stream<P = ()> {
    id: u64,
    plan: Plan,
    config: StreamConfig,
    worker: Worker,
    flights: InFlightList<P>,
    next: u64,
    /// The number of restarts of the stream.
    epoch: u64,
    last: Option<Last>,
    /// Frames whose results were lost with a device.
    lost: VecDeque<u64>,
    where_lost: String,
    why: String,
    stats: Stats,
    window: Window,
}

/// A handle of a submitted frame. Copies refer to the same frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Ticket {
    stream: u64,
    frame: u64,
}

impl Ticket {
    /// The frame's number, counted from 0 over the stream's life.
    pub fn frame(&self) -> u64 {
        self.frame
    }
}

/// The result of a frame.
#[derive(Clone, Copy, Debug)]
pub struct Done<'a, P> {
    /// The frame's number.
    pub frame: u64,
    /// The payload that was submitted with it.
    pub payload: P,
    /// The number of the frame that it is paired with: the previous one, unless that one was dropped. `None` for a
    /// first frame.
    pub previous: Option<u64>,
    /// The outputs of the pair. `None` for a first frame.
    pub outputs: Option<&'a Outputs>,
    /// Time from the submit to the return of the wait.
    pub latency: Duration,
}

impl<P> Stream<P> {
    /// Creates a stream that runs a plan.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a configuration that is out of range, [`Error::Kernel`] for a plan that contradicts
    /// itself; [`Error::TooLarge`] and [`Error::OutOfMemory`] if the adapter has no room for it; [`Error::DeviceLost`]
    /// if the adapter's device is lost.
    pub fn new(backend: &Backend, plan: Plan, config: &StreamConfig) -> Result<Self> {
        static STREAMS: AtomicU64 = AtomicU64::new(0);
        config.validate()?;
        plan.validate()?;
        let worker = Worker::new(backend, &plan, config)?;
        Ok(Self {
            id: STREAMS.fetch_add(1, Ordering::Relaxed),
            flights: InFlightList::new(config.in_flight),
            next: 0,
            epoch: 0,
            last: None,
            lost: VecDeque::with_capacity(StreamConfig::MAX_IN_FLIGHT),
            where_lost: String::new(),
            why: String::new(),
            stats: Stats { on_cpu: !worker.is_gpu(), ..Stats::default() },
            window: Window::new(),
            config: config.clone(),
            worker,
            plan,
        })
    }

    /// Submits a frame's inputs, by the names of the plan's input ports. They are copied; the call does not wait.
    ///
    /// # Errors
    /// As [`Plan::check`]; [`Error::Busy`] if [`StreamConfig::in_flight`] frames are submitted and not taken, unless
    /// [`StreamConfig::drop_oldest`] makes room; [`Error::DeviceLost`], see [`Stream::wait`]. After any of them the
    /// stream goes on as if the frame had not been submitted.
    pub fn submit(&mut self, given: &[Given<'_>], payload: P) -> Result<Ticket> {
        self.plan.check(given)?;
        let ticket = self.enqueue(given, payload);
        self.recovered(ticket)
    }

    /// Whether a frame is done, so that [`Stream::wait`] would return at once. On the CPU this call computes the frame
    /// and those before it; on the GPU it does not wait.
    ///
    /// # Errors
    /// [`Error::Ticket`] if the frame was taken already, dropped, or is another stream's; [`Error::DeviceLost`], see
    /// [`Stream::wait`].
    pub fn poll(&mut self, ticket: &Ticket) -> Result<bool> {
        self.find(*ticket)?;
        let done = self.bring(ticket.frame, false, None);
        self.recovered(done)
    }

    /// Waits for a frame.
    ///
    /// # Errors
    /// [`Error::Timeout`] if [`StreamConfig::deadline`] has passed since submit and the frame is not done; it can be
    /// waited for again, with a new deadline from that call on. [`Error::Ticket`] if the frame was taken already,
    /// dropped, or belongs to another stream. [`Error::DeviceLost`] for every frame that is not done when the GPU is
    /// lost; the next frame is a first frame on the device, which is reopened once, or on the CPU, as
    /// [`StreamConfig::on_loss`] says.
    pub fn wait(&mut self, ticket: Ticket) -> Result<Done<'_, P>> {
        let taken = self.take(ticket)?;
        Ok(self.handed(taken))
    }

    /// Submits a frame and waits for it.
    ///
    /// # Errors
    /// As [`Stream::submit`] and [`Stream::wait`]. A frame that misses its deadline is given up and counted as dropped.
    pub fn process(&mut self, given: &[Given<'_>], payload: P) -> Result<Done<'_, P>> {
        let ticket = self.submit(given, payload)?;
        let taken = self.take(ticket);
        if let Err(Error::Timeout { .. }) = taken {
            self.give_up(ticket.frame);
        }
        let taken = taken?;
        Ok(self.handed(taken))
    }

    /// Restarts the stream: the next frame is a first frame, and nothing is carried over to it. Frames in flight stay
    /// valid.
    pub fn reset(&mut self) {
        self.epoch += 1;
    }

    /// The executor: the adapter's name, or the CPU and its number of threads.
    pub fn adapter(&self) -> String {
        self.worker.adapter()
    }

    /// The device in use, if it is a GPU. After a loss it is a new device.
    pub fn gpu(&self) -> Option<&Gpu> {
        match &self.worker {
            Worker::Gpu(gpu) => Some(&gpu.gpu),
            _ => None,
        }
    }

    /// The latencies of the last frames with a result.
    pub fn latency(&self) -> Latency {
        self.window.latency()
    }

    /// The stream's counts.
    pub fn stats(&self) -> Stats {
        self.stats
    }

    /// The time of each step of the last frame: on the GPU of the last one taken, on the CPU of the last one computed.
    /// One entry per step, in the order of the plan. Empty without [`StreamConfig::timestamps`], if the device has no
    /// such clock, or if its times of that frame were inconsistent.
    pub fn stage_times(&self) -> &[StageTime] {
        self.worker.stage_times()
    }

    /// The clock of [`Stream::stage_times`].
    pub fn time_source(&self) -> TimeSource {
        self.worker.time_source(self.config.timestamps)
    }

    /// Total size of the plan's buffers and of the buffers for frames in flight, in bytes.
    pub fn buffer_bytes(&self) -> u64 {
        self.plan.bytes() + self.worker.bytes()
    }

    /// The computation of a frame.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }
}
