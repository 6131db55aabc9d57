//! Recovery from the loss of a GPU: the stream restarts on a new device, once; after that on the CPU or not at all.

use super::gpu::GpuWorker;
use super::worker::Worker;
use super::{OnLoss, Stream, StreamConfig};
use crate::backend::Backend;
use crate::error::{Error, Result};

impl<P> Stream<P> {
    /// Passes a result on. If it is a loss, the stream is recovered first.
    pub(super) fn recovered<T>(&mut self, result: Result<T>) -> Result<T> {
        if let (Err(Error::DeviceLost { adapter, reason }), true) = (&result, self.worker.is_gpu()) {
            self.recover(adapter.clone(), reason.clone());
        }
        result
    }

    fn recover(&mut self, adapter: String, reason: String) {
        self.stats.losses += 1;
        for entry in self.flights.list.iter().filter(|entry| !entry.given_up) {
            // Only the newest frames are remembered: the list must not grow.
            if self.lost.len() == StreamConfig::MAX_IN_FLIGHT {
                self.lost.pop_front();
            }
            self.lost.push_back(entry.frame);
        }
        self.flights.clear();
        self.last = None;
        self.why = reason.clone();
        let rebuilt = match &self.worker {
            Worker::Gpu(old) if self.stats.rebuilt == 0 => {
                old.gpu.reopen().and_then(|gpu| GpuWorker::new(&gpu, &self.plan, &self.config)).ok()
            }
            _ => None,
        };
        self.worker = match (rebuilt, self.config.on_loss) {
            (Some(gpu), _) => {
                self.stats.rebuilt += 1;
                Worker::Gpu(Box::new(gpu))
            }
            (None, OnLoss::Cpu) => {
                self.stats.on_cpu = true;
                match Worker::new(&Backend::Cpu, &self.plan, &self.config) {
                    Ok(cpu) => cpu,
                    Err(_) => Worker::Gone { adapter: adapter.clone(), reason },
                }
            }
            (None, OnLoss::Fail) => Worker::Gone { adapter: adapter.clone(), reason },
        };
        self.where_lost = adapter;
    }

    /// The error of a frame that was in flight when the GPU was lost.
    pub(super) fn lost_frame(&self, frame: u64) -> Option<Error> {
        let (adapter, reason) = (self.where_lost.clone(), self.why.clone());
        self.lost.contains(&frame).then_some(Error::DeviceLost { adapter, reason })
    }
}
