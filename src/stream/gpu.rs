//! The stream on the GPU: rings of mapped buffers and one submission per frame.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;

use wgpu::{BufferUsages, CommandEncoderDescriptor, MapMode, PollType};

use super::StreamConfig;
use super::clock::Clock;
use super::job::Job;
use super::layout::{Holdings, Layout, Write};
use super::ring::Slot;
use crate::error::Result;
use crate::gpu::{Gpu, GpuExecutor};
use crate::plan::{Given, Outputs, Plan};

/// A plan on the GPU, and its frames in flight.
pub(super) struct GpuWorker {
    pub(super) gpu: Gpu,
    exec: GpuExecutor,
    layout: Layout,
    holdings: Holdings,
    slots: Vec<Slot>,
    outputs: Outputs,
    pub(super) clock: Option<Clock>,
}

impl GpuWorker {
    pub(super) fn new(gpu: &Gpu, plan: &Plan, config: &StreamConfig) -> Result<Self> {
        let layout = Layout::new(plan);
        gpu.guarded(plan, || {
            let exec = GpuExecutor::new(gpu, plan)?;
            let clock = if config.timestamps { Clock::new(gpu, plan) } else { None };
            let ticks = clock.as_ref().map_or(0, Clock::bytes);
            let slots =
                (0..config.in_flight).map(|_| Slot::new(gpu, plan, &layout, ticks)).collect::<Result<_>>()?;
            let (holdings, outputs) = (Holdings::new(plan), Outputs::new(&plan.outputs));
            Ok(Self { gpu: gpu.clone(), exec, layout, holdings, slots, outputs, clock })
        })
    }

    /// Size of the rings in bytes, without the plan's buffers.
    pub(super) fn bytes(&self) -> u64 {
        self.slots.iter().map(Slot::bytes).sum::<u64>() + self.clock.as_ref().map_or(0, Clock::bytes)
    }

    pub(super) fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Copies a frame's inputs into its slot.
    ///
    /// # Errors
    /// [`Error::DeviceLost`](crate::Error::DeviceLost).
    pub(super) fn fill(&mut self, plan: &Plan, slot: usize, given: &[Given<'_>]) -> Result<()> {
        self.slots[slot].fill(&self.gpu, plan, &self.layout, given)
    }

    /// Submits a copied frame.
    ///
    /// # Errors
    /// [`Error::DeviceLost`](crate::Error::DeviceLost).
    pub(super) fn start(&mut self, plan: &Plan, slot: usize, job: Job) -> Result<()> {
        // wgpu panics if it is out of memory and no error handler is installed.
        let started = catch_unwind(AssertUnwindSafe(|| self.submit(plan, slot, job)));
        started.map_err(|_| self.gpu.lost_error("the driver failed while a frame was submitted"))
    }

    fn submit(&mut self, plan: &Plan, slot: usize, job: Job) {
        let Self { gpu, exec, layout, holdings, slots, clock, .. } = self;
        let Slot { upload, readback, submission, given, mapped, .. } = &mut slots[slot];
        let mut encoder = gpu.device.create_command_encoder(&CommandEncoderDescriptor::default());
        upload.unmap();
        let bytes = |values: usize| 4 * values as u64;
        if job.clears() {
            plan.carried.iter().for_each(|bufs| encoder.clear_buffer(exec.buf(bufs[job.parity]), 0, None));
        }
        for (i, (port, input)) in plan.inputs.iter().zip(&layout.inputs).enumerate() {
            let (to, at) = (exec.buf(port.bufs[job.parity]), bytes(input.place.start));
            let len = match holdings.write(i, port, input, job.parity, given[i].is_some()) {
                Write::Nothing => continue,
                Write::Zeros => {
                    encoder.clear_buffer(to, 0, None);
                    continue;
                }
                Write::Fill => input.place.len(),
                Write::Given => given[i].unwrap_or_default(),
            };
            encoder.copy_buffer_to_buffer(upload, at, to, 0, bytes(len));
        }
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            let queries = clock.as_ref().map(|clock| &clock.queries);
            exec.record_frame(&mut pass, job.parity, job.pair, queries);
        }
        // A first frame has no outputs: only the clock is read.
        *mapped = clock.is_some() || (job.pair && layout.readback() > 0);
        if let Some(readback) = readback.as_ref().filter(|_| *mapped) {
            for (port, place) in plan.outputs.iter().zip(&layout.outputs).filter(|_| job.pair) {
                let from = exec.buf(port.bufs[job.parity]);
                encoder.copy_buffer_to_buffer(from, 0, readback, bytes(place.start), bytes(place.len()));
            }
            if let Some(clock) = clock {
                clock.copy(&mut encoder, job.steps(plan), readback, layout);
            }
        }
        *submission = Some(gpu.submit(encoder));
        // Whether the mapping succeeded shows when the range is requested. Closures without captures are not allocated.
        upload.map_async(MapMode::Write, .., |_| {});
        if let Some(readback) = readback.as_ref().filter(|_| *mapped) {
            readback.map_async(MapMode::Read, .., |_| {});
        }
    }

    /// Waits for a submitted frame, at most this long. Returns true if it is done.
    ///
    /// # Errors
    /// [`Error::DeviceLost`](crate::Error::DeviceLost).
    pub(super) fn done(&mut self, slot: usize, timeout: Duration) -> Result<bool> {
        let submission_index = self.slots[slot].submission.clone();
        self.gpu.poll(PollType::Wait { submission_index, timeout: Some(timeout) })
    }

    /// Reads the outputs of a finished frame.
    ///
    /// # Errors
    /// [`Error::DeviceLost`](crate::Error::DeviceLost).
    pub(super) fn take(&mut self, plan: &Plan, slot: usize, job: Job) -> Result<()> {
        let Self { gpu, layout, slots, outputs, clock, .. } = self;
        let slot = &mut slots[slot];
        if let Some(readback) = slot.readback.as_ref().filter(|_| slot.mapped) {
            let view = readback.get_mapped_range(..).map_err(|error| gpu.lost_error(error.to_string()))?;
            if job.pair {
                let values: &[f32] = bytemuck::cast_slice(&view[..4 * layout.readback()]);
                for (i, place) in layout.outputs.iter().enumerate() {
                    outputs.unpack(i, &values[place.clone()]);
                }
            }
            if let Some(clock) = clock {
                clock.read(&view, job.parity, job.steps(plan), layout);
            }
        }
        slot.release();
        Ok(())
    }

    /// Frees the slot of a finished frame without reading it.
    pub(super) fn release(&mut self, slot: usize) {
        self.slots[slot].release();
    }

    pub(super) fn outputs(&self) -> &Outputs {
        &self.outputs
    }
}

/// The usage of an upload buffer.
pub(super) const UPLOAD: BufferUsages = BufferUsages::MAP_WRITE.union(BufferUsages::COPY_SRC);
/// The usage of a readback buffer.
pub(super) const READBACK: BufferUsages = BufferUsages::MAP_READ.union(BufferUsages::COPY_DST);
