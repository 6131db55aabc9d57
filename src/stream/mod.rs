//! The real-time face of any plan: frames go in, its outputs come out, and nothing waits for ever or grows without bound.
//!
//! A stream of frames is computed pair by pair, each frame with the previous one. What was computed of a frame alone is
//! kept for the next pair, and the result is the same, bit for bit, as that of a stream that was given only the two.
//!
//! On the GPU a frame begins to be computed when it is submitted, while the host goes on. On the CPU `submit` copies the
//! frame, and it is computed in [`Stream::poll`] and [`Stream::wait`], on the threads of rayon's pool.

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
use in_flight::{Flights, Last};
use stats::Window;
use worker::Worker;

/// Runs a plan on a stream of frames.
///
/// All memory is taken when it is made; a frame takes none, apart from what wgpu and rayon take by themselves. With every
/// frame the caller hands over a payload of type `P`, which comes back with the frame's outputs.
pub struct Stream<P = ()> {
    id: u64,
    plan: Plan,
    config: StreamConfig,
    worker: Worker,
    flights: Flights<P>,
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
    stream: u64,
    frame: u64,
}

impl Ticket {
    /// The frame's number, counted from 0 over the stream's life.
    pub fn frame(&self) -> u64 {
        self.frame
    }
}

/// A frame that is done.
#[derive(Clone, Copy, Debug)]
pub struct Done<'a, P> {
    /// The frame's number.
    pub frame: u64,
    /// What came with it.
    pub payload: P,
    /// The number of the frame that it was paired with: the previous one, unless that one was dropped. None for a first
    /// frame.
    pub previous: Option<u64>,
    /// What was computed of the pair. None for a first frame.
    pub outputs: Option<&'a Outputs>,
    /// Time from submit until now.
    pub latency: Duration,
}

impl<P> Stream<P> {
    /// Makes a stream of frames for a plan.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a configuration that is out of range, [`Error::Kernel`] for a plan that contradicts
    /// itself; [`Error::TooLarge`] and [`Error::OutOfMemory`] if the adapter has no room for it; [`Error::DeviceLost`] if
    /// the adapter is gone.
    pub fn new(backend: &Backend, plan: Plan, config: &StreamConfig) -> Result<Self> {
        static STREAMS: AtomicU64 = AtomicU64::new(0);
        config.validate()?;
        plan.validate()?;
        let worker = Worker::new(backend, &plan, config)?;
        Ok(Self {
            id: STREAMS.fetch_add(1, Ordering::Relaxed),
            flights: Flights::new(config.in_flight),
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

    /// Takes what comes with a frame, by the names of the plan's inputs. It is copied, and the call does not wait for
    /// anything.
    ///
    /// # Errors
    /// As [`Plan::check`]; [`Error::Busy`] if as many frames as [`StreamConfig::in_flight`] are submitted and not taken,
    /// unless [`StreamConfig::drop_oldest`] makes room; [`Error::DeviceLost`], see [`Stream::wait`]. The stream goes on
    /// after all of them as if the frame had not been there.
    pub fn submit(&mut self, given: &[Given<'_>], payload: P) -> Result<Ticket> {
        self.plan.check(given)?;
        let ticket = self.enqueue(given, payload);
        self.recovered(ticket)
    }

    /// Whether a frame is done, so that [`Stream::wait`] would not wait. On the CPU it computes the frame, and those
    /// before it; on the GPU it waits for nothing.
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
    /// [`Error::Timeout`] if [`StreamConfig::deadline`] has passed since submit and the frame is not done; it may be asked
    /// for again, and then has the same time again from that call on. [`Error::Ticket`] if the frame was taken already,
    /// dropped, or is another stream's. [`Error::DeviceLost`] for every frame that is not done when the GPU is lost; the
    /// next frame is a first frame on the device, which is reopened once, or on the CPU, as [`StreamConfig::on_loss`] says.
    pub fn wait(&mut self, ticket: Ticket) -> Result<Done<'_, P>> {
        let taken = self.take(ticket)?;
        Ok(self.handed(taken))
    }

    /// Submits a frame and waits for it.
    ///
    /// # Errors
    /// As [`Stream::submit`] and [`Stream::wait`]. A frame that is late is given up and counted as dropped.
    pub fn process(&mut self, given: &[Given<'_>], payload: P) -> Result<Done<'_, P>> {
        let ticket = self.submit(given, payload)?;
        let taken = self.take(ticket);
        if let Err(Error::Timeout { .. }) = taken {
            self.give_up(ticket.frame);
        }
        let taken = taken?;
        Ok(self.handed(taken))
    }

    /// Begins the stream anew: the next frame is a first frame, and nothing is carried over to it. Frames in flight stay
    /// valid.
    pub fn reset(&mut self) {
        self.epoch += 1;
    }

    /// What computes: the adapter's name, or the CPU and its threads.
    pub fn adapter(&self) -> String {
        self.worker.adapter()
    }

    /// The device in use, if it is a GPU; after a loss it is another one than before.
    pub fn gpu(&self) -> Option<&Gpu> {
        match &self.worker {
            Worker::Gpu(gpu) => Some(&gpu.gpu),
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
    /// Empty without [`StreamConfig::timestamps`], if the device cannot tell, or if what it told of that frame made no
    /// sense.
    pub fn stage_times(&self) -> &[StageTime] {
        self.worker.stage_times()
    }

    /// Where [`Stream::stage_times`] come from.
    pub fn time_source(&self) -> TimeSource {
        self.worker.time_source(self.config.timestamps)
    }

    /// Bytes of the plan's buffers and of those for the frames in flight.
    pub fn buffer_bytes(&self) -> u64 {
        self.plan.bytes() + self.worker.bytes()
    }

    /// What is computed of a frame.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }
}
