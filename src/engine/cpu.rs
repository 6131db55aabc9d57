//! The stream on the CPU: frames are copied when submitted and computed when waited for.

use std::time::Instant;

use super::figures::Stages;
use super::layout::{self, Layout};
use super::slots::{Begin, Job, Results};
use super::{Config, Extras};
use crate::cpu::CpuExecutor;
use crate::frame::Frame;
use crate::kernels::rows::SMALLEST_SHARE;
use crate::plan::Plan;
use crate::sphere::Motion;

/// A plan on the CPU, and its frames in flight.
pub(super) struct CpuStream {
    exec: CpuExecutor,
    layout: Layout,
    slots: Vec<Slot>,
    pub(super) stages: Stages,
    timed: bool,
}

/// Room for a frame in flight.
struct Slot {
    frame: Vec<f32>,
    certainty: Vec<f32>,
    initial: Vec<f32>,
    motion: Vec<f32>,
    /// Steps done.
    progress: usize,
    results: Results,
}

impl CpuStream {
    pub(super) fn new(plan: &Plan, config: &Config) -> Self {
        let layout = Layout::new(plan, config);
        let slot = || Slot {
            frame: vec![0.0; layout.frame],
            certainty: vec![0.0; layout.certainty],
            initial: vec![0.0; layout.initial],
            progress: 0,
            motion: vec![0.0; layout.motion],
            results: Results::new(&layout, plan),
        };
        Self {
            exec: CpuExecutor::new(plan),
            layout,
            slots: (0..config.in_flight).map(|_| slot()).collect(),
            stages: Stages::new(plan),
            timed: config.timestamps,
        }
    }

    /// Bytes beside the plan's.
    pub(super) fn bytes(&self) -> u64 {
        4 * (self.slots.len() * (self.layout.upload() + self.layout.readback())) as u64
    }

    pub(super) fn fill(&mut self, slot: usize, frame: &Frame<'_>, extras: &Extras<'_>) {
        let slot = &mut self.slots[slot];
        let bytes: &mut [u8] = bytemuck::cast_slice_mut(&mut slot.frame);
        for (y, row) in (0..).zip(bytes.chunks_exact_mut(4 * self.layout.row)) {
            let from = frame.row(y);
            row[..from.len()].copy_from_slice(from);
        }
        match extras.certainty {
            Some(plane) => fill(&mut slot.certainty, layout::certainty(&plane.data, plane.size)),
            None => slot.certainty.fill(1.0),
        }
        if let Some(field) = extras.initial_flow {
            fill(&mut slot.initial, layout::flow(field));
        }
        fill(&mut slot.motion, extras.motion.unwrap_or(&Motion::UNKNOWN).values().into_iter());
    }

    pub(super) fn start(&mut self, plan: &Plan, slot: usize, job: Job) {
        let slot = &mut self.slots[slot];
        slot.progress = 0;
        self.exec.buf_mut(plan.frame).copy_from_slice(&slot.frame);
        if let Some(certainty) = plan.certainty {
            self.exec.buf_mut(certainty)[..slot.certainty.len()].copy_from_slice(&slot.certainty);
        }
        if let Some(motion) = plan.motion {
            self.exec.buf_mut(motion)[..slot.motion.len()].copy_from_slice(&slot.motion);
        }
        let initial = plan.flow[1 - job.parity];
        match job.begin {
            Begin::Kept => {}
            Begin::Zero => self.exec.buf_mut(initial).fill(0.0),
            Begin::Given => self.exec.buf_mut(initial)[..slot.initial.len()].copy_from_slice(&slot.initial),
        }
    }

    /// Computes a started frame, until it is done or the time has come; at least one step. True if it is done.
    pub(super) fn work(&mut self, plan: &Plan, slot: usize, job: Job, until: Option<Instant>) -> bool {
        // One call into the pool for all steps: each of them would wake its threads anew. Frames too small to be shared
        // out stay on this thread.
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

    /// Copies what was computed into the slot, before the next frame overwrites it.
    fn keep(&mut self, plan: &Plan, slot: usize, job: Job) {
        if self.timed {
            self.stages.show(job.parity, job.steps(plan));
        }
        if !job.pair {
            return;
        }
        let size = self.layout.flow_size;
        let results = &mut self.slots[slot].results;
        if self.layout.flow > 0 {
            layout::unpack_flow(self.exec.buf(plan.flow[job.parity]), size, &mut results.flow.data);
        }
        if let Some(confidence) = plan.confidence.filter(|_| self.layout.confidence > 0) {
            layout::unpack_plane(self.exec.buf(confidence), size, &mut results.confidence.data);
        }
        for (kept, (field, _)) in results.fields.iter_mut().zip(&plan.fields) {
            let len = kept.len();
            kept.copy_from_slice(&self.exec.buf(*field)[..len]);
        }
    }

    pub(super) fn results(&self, slot: usize) -> &Results {
        &self.slots[slot].results
    }

    /// What stands in place of an adapter's name.
    pub(super) fn threads() -> String {
        let threads = rayon::current_num_threads();
        format!("CPU, {threads} thread{}", if threads == 1 { "" } else { "s" })
    }
}

fn fill(out: &mut [f32], values: impl Iterator<Item = f32>) {
    for (out, value) in out.iter_mut().zip(values) {
        *out = value;
    }
}
