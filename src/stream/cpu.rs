//! The stream on the CPU: frames are copied at the submit and computed during the wait.

use std::time::Instant;

use super::StreamConfig;
use super::job::Job;
use super::layout::{Holdings, Layout, Write};
use super::stats::Stages;
use crate::cpu::CpuExecutor;
use crate::kernels::parallel_rows::SMALLEST_SHARE;
use crate::plan::pack::pack;
use crate::plan::{Fill, Given, Outputs, Plan};

/// A plan on the CPU, and its frames in flight.
pub(super) struct CpuWorker {
    exec: CpuExecutor,
    layout: Layout,
    holdings: Holdings,
    slots: Vec<Slot>,
    pub(super) stages: Stages,
    timed: bool,
}

/// The memory of a frame in flight.
struct Slot {
    inputs: Vec<Vec<f32>>,
    /// For each input, the number of values that were given for the frame.
    given: Vec<Option<usize>>,
    /// Steps done.
    progress: usize,
    outputs: Outputs,
}

impl CpuWorker {
    pub(super) fn new(plan: &Plan, config: &StreamConfig) -> Self {
        let layout = Layout::new(plan);
        let slot = || Slot {
            inputs: layout.inputs.iter().map(|input| vec![0.0; input.place.len()]).collect(),
            given: vec![None; layout.inputs.len()],
            progress: 0,
            outputs: Outputs::new(&plan.outputs),
        };
        Self {
            exec: CpuExecutor::new(plan),
            slots: (0..config.in_flight).map(|_| slot()).collect(),
            layout,
            holdings: Holdings::new(plan),
            stages: Stages::new(plan),
            timed: config.timestamps,
        }
    }

    /// Size of the slots in bytes, without the plan's buffers.
    pub(super) fn bytes(&self) -> u64 {
        4 * (self.slots.len() * (self.layout.upload() + self.layout.readback())) as u64
    }

    pub(super) fn layout(&self) -> &Layout {
        &self.layout
    }

    pub(super) fn fill(&mut self, plan: &Plan, slot: usize, given: &[Given<'_>]) {
        let slot = &mut self.slots[slot];
        for (i, (port, room)) in plan.inputs.iter().zip(&mut slot.inputs).enumerate() {
            slot.given[i] = port.among(given).map(|value| pack(port.kind, &value, room.as_mut_slice()));
        }
    }

    pub(super) fn start(&mut self, plan: &Plan, slot: usize, job: Job) {
        let slot = &mut self.slots[slot];
        slot.progress = 0;
        if job.clears() {
            plan.carried.iter().for_each(|bufs| self.exec.buf_mut(bufs[job.parity]).fill(0.0));
        }
        for (i, (port, input)) in plan.inputs.iter().zip(&self.layout.inputs).enumerate() {
            let len = slot.given[i];
            let write = self.holdings.write(i, port, input, job.parity, len.is_some());
            let buf = &mut self.exec.buf_mut(port.bufs[job.parity])[..input.place.len()];
            match (write, len, &port.if_absent) {
                (Write::Given, Some(len), _) => buf[..len].copy_from_slice(&slot.inputs[i][..len]),
                (Write::Zeros, ..) => buf.fill(0.0),
                (Write::Fill, _, Fill::Value(value)) => buf.fill(*value),
                (Write::Fill, _, Fill::Values(values)) => buf[..values.len()].copy_from_slice(values),
                _ => {}
            }
        }
    }

    /// Computes a started frame until it is done or the deadline has passed; at least one step. Returns true if it is
    /// done.
    pub(super) fn work(&mut self, plan: &Plan, slot: usize, job: Job, until: Option<Instant>) -> bool {
        // One call into the pool for all steps: one call per step would wake its threads each time. Frames too small to
        // be divided stay on this thread.
        let done = match plan.size.pixels() >= SMALLEST_SHARE {
            true => rayon::join(|| self.steps(plan, slot, job, until), || ()).0,
            false => self.steps(plan, slot, job, until),
        };
        if done {
            self.keep(plan, slot, job);
        }
        done
    }

    fn steps(&mut self, plan: &Plan, slot: usize, job: Job, until: Option<Instant>) -> bool {
        let count = job.steps(plan);
        let progress = self.slots[slot].progress;
        for (i, step) in plan.steps(job.parity).enumerate().take(count).skip(progress) {
            let begin = self.timed.then(Instant::now);
            self.exec.run(step);
            if let Some(begin) = begin {
                self.stages.times[job.parity][i].time = begin.elapsed();
            }
            self.slots[slot].progress = i + 1;
            if i + 1 < count && until.is_some_and(|until| Instant::now() >= until) {
                return false;
            }
        }
        true
    }

    /// Copies the results into the slot, before the next frame overwrites them.
    fn keep(&mut self, plan: &Plan, slot: usize, job: Job) {
        if self.timed {
            self.stages.show(job.parity, job.steps(plan));
        }
        for (i, port) in plan.outputs.iter().enumerate().filter(|_| job.pair) {
            self.slots[slot].outputs.unpack(i, self.exec.buf(port.bufs[job.parity]));
        }
    }

    pub(super) fn outputs(&self, slot: usize) -> &Outputs {
        &self.slots[slot].outputs
    }

    /// The name in place of an adapter's.
    pub(super) fn threads() -> String {
        let threads = rayon::current_num_threads();
        format!("CPU, {threads} thread{}", if threads == 1 { "" } else { "s" })
    }
}
