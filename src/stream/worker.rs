//! The executor of a stream: GPU, CPU, or none after a loss.

use std::time::{Duration, Instant};

use super::cpu::CpuWorker;
use super::gpu::GpuWorker;
use super::job::Job;
use super::{StageTime, StreamConfig, TimeSource};
use crate::backend::Backend;
use crate::error::{Error, Result};
use crate::plan::{Given, Outputs, Plan};

/// The longest uninterrupted wait for the GPU, so that a loss is noticed.
const SLICE: Duration = Duration::from_millis(100);

/// The executor that computes the frames.
pub(super) enum Worker {
    Gpu(Box<GpuWorker>),
    Cpu(Box<CpuWorker>),
    /// The GPU is lost and will not be reopened.
    Gone {
        adapter: String,
        reason: String,
    },
}

impl Worker {
    pub(super) fn new(backend: &Backend, plan: &Plan, config: &StreamConfig) -> Result<Self> {
        Ok(match backend {
            Backend::Gpu(gpu) => Self::Gpu(Box::new(GpuWorker::new(gpu, plan, config)?)),
            Backend::Cpu => Self::Cpu(Box::new(CpuWorker::new(plan, config))),
        })
    }

    pub(super) fn is_gpu(&self) -> bool {
        matches!(self, Self::Gpu(_))
    }

    fn gone<T>(adapter: &str, reason: &str) -> Result<T> {
        Err(Error::DeviceLost { adapter: adapter.to_owned(), reason: reason.to_owned() })
    }

    /// Fails if there is no executor any more.
    pub(super) fn check(&self) -> Result<()> {
        match self {
            Self::Gone { adapter, reason } => Self::gone(adapter, reason),
            _ => Ok(()),
        }
    }

    /// Copies a frame's inputs. Returns whether they replace the values that the previous frame has left.
    pub(super) fn fill(&mut self, plan: &Plan, slot: usize, given: &[Given<'_>]) -> Result<bool> {
        let layout = match self {
            Self::Gpu(gpu) => {
                gpu.fill(plan, slot, given)?;
                gpu.layout()
            }
            Self::Cpu(cpu) => {
                cpu.fill(plan, slot, given);
                cpu.layout()
            }
            Self::Gone { adapter, reason } => return Self::gone(adapter, reason),
        };
        Ok(layout.replaces_carried(plan, given))
    }

    pub(super) fn start(&mut self, plan: &Plan, slot: usize, job: Job) -> Result<()> {
        match self {
            Self::Gpu(gpu) => gpu.start(plan, slot, job),
            Self::Cpu(cpu) => {
                cpu.start(plan, slot, job);
                Ok(())
            }
            Self::Gone { adapter, reason } => Self::gone(adapter, reason),
        }
    }

    /// Waits for a started frame, or computes it. Returns true if it is done; false if the deadline has passed, or on
    /// the GPU after a while.
    pub(super) fn advance(
        &mut self,
        plan: &Plan,
        slot: usize,
        job: Job,
        until: Option<Instant>,
    ) -> Result<bool> {
        match self {
            Self::Gpu(gpu) => {
                let left = until.map_or(SLICE, |until| until.saturating_duration_since(Instant::now()));
                gpu.done(slot, left.min(SLICE))
            }
            Self::Cpu(cpu) => Ok(cpu.work(plan, slot, job, until)),
            Self::Gone { adapter, reason } => Self::gone(adapter, reason),
        }
    }

    /// Reads the results of a finished frame, for [`Worker::outputs`] to return.
    pub(super) fn take(&mut self, plan: &Plan, slot: usize, job: Job) -> Result<()> {
        match self {
            Self::Gpu(gpu) => gpu.take(plan, slot, job),
            Self::Cpu(_) => Ok(()),
            Self::Gone { adapter, reason } => Self::gone(adapter, reason),
        }
    }

    /// Frees the slot of a finished frame without reading its results.
    pub(super) fn release(&mut self, slot: usize) {
        if let Self::Gpu(gpu) = self {
            gpu.release(slot);
        }
    }

    /// The outputs that were taken last from this slot.
    pub(super) fn outputs(&self, slot: usize) -> Option<&Outputs> {
        match self {
            Self::Gpu(gpu) => Some(gpu.outputs()),
            Self::Cpu(cpu) => Some(cpu.outputs(slot)),
            Self::Gone { .. } => None,
        }
    }

    pub(super) fn adapter(&self) -> String {
        match self {
            Self::Gpu(gpu) => gpu.gpu.adapter().to_string(),
            Self::Cpu(_) => CpuWorker::threads(),
            Self::Gone { adapter, .. } => adapter.clone(),
        }
    }

    pub(super) fn bytes(&self) -> u64 {
        match self {
            Self::Gpu(gpu) => gpu.bytes(),
            Self::Cpu(cpu) => cpu.bytes(),
            Self::Gone { .. } => 0,
        }
    }

    pub(super) fn stage_times(&self) -> &[StageTime] {
        match self {
            Self::Gpu(gpu) => gpu.clock.as_ref().map_or(&[], |clock| clock.stages.shown()),
            Self::Cpu(cpu) => cpu.stages.shown(),
            Self::Gone { .. } => &[],
        }
    }

    pub(super) fn time_source(&self, wanted: bool) -> TimeSource {
        match self {
            Self::Gpu(gpu) if gpu.clock.is_some() => TimeSource::Gpu,
            Self::Cpu(_) if wanted => TimeSource::Host,
            _ => TimeSource::None,
        }
    }
}
