//! The GPU's clock, read between the steps of a frame.

use std::time::Duration;

use wgpu::{Buffer, BufferDescriptor, BufferUsages, CommandEncoder, Features, QuerySet};

use super::layout::Layout;
use super::stats::Stages;
use crate::gpu::Gpu;
use crate::plan::Plan;

/// The device features for timestamps inside a pass.
const NEEDED: Features = Features::TIMESTAMP_QUERY.union(Features::TIMESTAMP_QUERY_INSIDE_PASSES);

/// Queries of the device's clock: one before the first step, one after each.
pub(super) struct Clock {
    pub(super) queries: QuerySet,
    ticks: Buffer,
    /// Nanoseconds per tick.
    period: f64,
    pub(super) stages: Stages,
}

impl Clock {
    /// `None` if the device cannot measure the time of every step.
    pub(super) fn new(gpu: &Gpu, plan: &Plan) -> Option<Self> {
        let steps = plan.steps(0).count().max(plan.steps(1).count());
        let count = u32::try_from(steps + 1).ok().filter(|count| *count <= wgpu::QUERY_SET_MAX_QUERIES)?;
        let period = f64::from(gpu.queue.get_timestamp_period());
        if !gpu.features().contains(NEEDED) || period <= 0.0 {
            return None;
        }
        Some(Self {
            queries: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("steps"),
                ty: wgpu::QueryType::Timestamp,
                count,
            }),
            ticks: gpu.device.create_buffer(&BufferDescriptor {
                label: Some("ticks"),
                size: 8 * u64::from(count),
                usage: BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
            period,
            stages: Stages::new(plan),
        })
    }

    pub(super) fn bytes(&self) -> u64 {
        self.ticks.size()
    }

    /// Records the copy of a frame's ticks to the readback buffer, after its results.
    pub(super) fn copy(&self, encoder: &mut CommandEncoder, steps: usize, to: &Buffer, layout: &Layout) {
        encoder.resolve_query_set(&self.queries, 0..steps as u32 + 1, &self.ticks, 0);
        encoder.copy_buffer_to_buffer(&self.ticks, 0, to, place(layout) as u64, 8 * (steps as u64 + 1));
    }

    /// Reads a frame's ticks. If they are inconsistent, the whole frame has no times.
    pub(super) fn read(&mut self, view: &[u8], parity: usize, steps: usize, layout: &Layout) {
        let ticks: &[u64] = bytemuck::cast_slice(&view[place(layout)..][..8 * (steps + 1)]);
        let sane = plausible(ticks);
        self.stages.show(parity, if sane { steps } else { 0 });
        for (stage, pair) in self.stages.times[parity].iter_mut().zip(ticks.windows(2)) {
            let nanos = pair[1].saturating_sub(pair[0]) as f64 * self.period;
            stage.time = Duration::from_nanos(nanos as u64);
        }
    }
}

/// Some drivers omit ticks or return them in the wrong order.
fn plausible(ticks: &[u64]) -> bool {
    ticks.iter().all(|&tick| tick > 0) && ticks.is_sorted()
}

/// The offset of the ticks in a readback buffer, in bytes.
fn place(layout: &Layout) -> usize {
    (4 * layout.readback()).next_multiple_of(8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_that_are_missing_or_go_back_are_not_believed() {
        assert!(plausible(&[5, 5, 9]));
        assert!(!plausible(&[5, 0, 9]));
        assert!(!plausible(&[5, 9, 8]));
    }
}
