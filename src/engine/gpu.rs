//! The stream on the GPU: rings of mapped buffers, one submission a frame.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;

use wgpu::{BufferUsages, CommandEncoderDescriptor, MapMode, PollType};

use super::clock::Clock;
use super::layout::{self, Layout};
use super::ring::{Slot, guarded};
use super::slots::{Begin, Job, Results};
use super::{Config, Extras};
use crate::error::Result;
use crate::frame::Frame;
use crate::gpu::{Gpu, GpuExecutor};
use crate::plan::Plan;

/// A plan on the GPU, and its frames in flight.
pub(super) struct GpuStream {
    pub(super) gpu: Gpu,
    exec: GpuExecutor,
    layout: Layout,
    slots: Vec<Slot>,
    results: Results,
    pub(super) clock: Option<Clock>,
    /// Whether the device's certainty is one everywhere already.
    trusted: bool,
}

impl GpuStream {
    pub(super) fn new(gpu: &Gpu, plan: &Plan, config: &Config) -> Result<Self> {
        let layout = Layout::new(plan, config);
        guarded(gpu, plan, || {
            let exec = GpuExecutor::new(gpu, plan)?;
            let clock = if config.timestamps { Clock::new(gpu, plan) } else { None };
            let ticks = clock.as_ref().map_or(0, Clock::bytes);
            let slots =
                (0..config.in_flight).map(|_| Slot::new(gpu, &layout, ticks)).collect::<Result<_>>()?;
            let results = Results::new(&layout, plan);
            Ok(Self { gpu: gpu.clone(), exec, layout, slots, results, clock, trusted: false })
        })
    }

    /// Bytes beside the plan's.
    pub(super) fn bytes(&self) -> u64 {
        self.slots.iter().map(Slot::bytes).sum::<u64>() + self.clock.as_ref().map_or(0, Clock::bytes)
    }

    /// Copies a frame into its slot.
    ///
    /// # Errors
    /// [`Error::DeviceLost`](crate::Error::DeviceLost).
    pub(super) fn fill(&mut self, slot: usize, frame: &Frame<'_>, extras: &Extras<'_>) -> Result<()> {
        self.slots[slot].fill(&self.gpu, &self.layout, frame, extras)
    }

    /// Submits a frame that was copied.
    ///
    /// # Errors
    /// [`Error::DeviceLost`](crate::Error::DeviceLost).
    pub(super) fn start(&mut self, plan: &Plan, slot: usize, job: Job) -> Result<()> {
        // wgpu panics where it is out of memory and nobody handles its errors.
        let started = catch_unwind(AssertUnwindSafe(|| self.submit(plan, slot, job)));
        started.map_err(|_| self.gpu.lost_error("the driver failed while a frame was submitted"))
    }

    fn submit(&mut self, plan: &Plan, slot: usize, job: Job) {
        let Self { gpu, exec, layout, slots, clock, trusted, .. } = self;
        let Slot { upload, readback, submission, has_certainty, mapped, .. } = &mut slots[slot];
        let mut encoder = gpu.device.create_command_encoder(&CommandEncoderDescriptor::default());
        upload.unmap();
        let bytes = |values: usize| 4 * values as u64;
        encoder.copy_buffer_to_buffer(upload, 0, exec.buf(plan.frame), 0, bytes(layout.frame));
        if let Some(certainty) = plan.certainty
            && (*has_certainty || !*trusted)
        {
            let (to, len) = (exec.buf(certainty), bytes(layout.certainty));
            encoder.copy_buffer_to_buffer(upload, bytes(layout.frame), to, 0, len);
            *trusted = !*has_certainty;
        }
        let initial = exec.buf(plan.flow[1 - job.parity]);
        match job.begin {
            Begin::Kept => {}
            Begin::Zero => encoder.clear_buffer(initial, 0, None),
            Begin::Given => {
                let at = bytes(layout.frame + layout.certainty);
                encoder.copy_buffer_to_buffer(upload, at, initial, 0, bytes(layout.initial));
            }
        }
        if let Some(motion) = plan.motion {
            let at = bytes(layout.upload() - layout.motion);
            encoder.copy_buffer_to_buffer(upload, at, exec.buf(motion), 0, bytes(layout.motion));
        }
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            let queries = clock.as_ref().map(|clock| &clock.queries);
            exec.record_frame(&mut pass, job.parity, job.pair, queries);
        }
        // Of a first frame only the clock is read.
        *mapped = clock.is_some() || (job.pair && layout.readback() > 0);
        if let Some(readback) = readback.as_ref().filter(|_| *mapped) {
            if job.pair && layout.flow > 0 {
                let flow = exec.buf(plan.flow[job.parity]);
                encoder.copy_buffer_to_buffer(flow, 0, readback, 0, bytes(layout.flow));
            }
            if let Some(confidence) = plan.confidence.filter(|_| job.pair && layout.confidence > 0) {
                let (from, len) = (exec.buf(confidence), bytes(layout.confidence));
                encoder.copy_buffer_to_buffer(from, 0, readback, bytes(layout.flow), len);
            }
            let mut at = layout.flow + layout.confidence;
            for (field, shape) in plan.fields.iter().filter(|_| job.pair) {
                encoder.copy_buffer_to_buffer(exec.buf(*field), 0, readback, bytes(at), bytes(shape.len()));
                at += shape.len();
            }
            if let Some(clock) = clock {
                clock.copy(&mut encoder, job.steps(plan), readback, layout);
            }
        }
        *submission = Some(gpu.submit(encoder));
        // That mapping worked shows when the range is asked for. Closures that hold nothing are not allocated.
        upload.map_async(MapMode::Write, .., |_| {});
        if let Some(readback) = readback.as_ref().filter(|_| *mapped) {
            readback.map_async(MapMode::Read, .., |_| {});
        }
    }

    /// Waits for a submitted frame at most this long. True if it is done.
    ///
    /// # Errors
    /// [`Error::DeviceLost`](crate::Error::DeviceLost).
    pub(super) fn done(&mut self, slot: usize, timeout: Duration) -> Result<bool> {
        let submission_index = self.slots[slot].submission.clone();
        self.gpu.poll(PollType::Wait { submission_index, timeout: Some(timeout) })
    }

    /// Brings what was read of a frame that is done to the host.
    ///
    /// # Errors
    /// [`Error::DeviceLost`](crate::Error::DeviceLost).
    pub(super) fn take(&mut self, plan: &Plan, slot: usize, job: Job) -> Result<()> {
        let Self { gpu, layout, slots, results, clock, .. } = self;
        let slot = &mut slots[slot];
        if let Some(readback) = slot.readback.as_ref().filter(|_| slot.mapped) {
            let view = readback.get_mapped_range(..).map_err(|error| gpu.lost_error(error.to_string()))?;
            if job.pair {
                let values: &[f32] = bytemuck::cast_slice(&view[..4 * layout.readback()]);
                let (flow, rest) = values.split_at(layout.flow);
                let (confidence, mut fields) = rest.split_at(layout.confidence);
                layout::unpack_flow(flow, layout.flow_size, &mut results.flow.data);
                layout::unpack_plane(confidence, layout.flow_size, &mut results.confidence.data);
                for field in &mut results.fields {
                    let values;
                    (values, fields) = fields.split_at(field.len());
                    field.copy_from_slice(values);
                }
            }
            if let Some(clock) = clock {
                clock.read(&view, job.parity, job.steps(plan), layout);
            }
        }
        slot.release();
        Ok(())
    }

    /// Frees the slot of a frame that is done, without reading it.
    pub(super) fn release(&mut self, slot: usize) {
        self.slots[slot].release();
    }

    pub(super) fn results(&self) -> &Results {
        &self.results
    }
}

/// What an upload slot is for.
pub(super) const UPLOAD: BufferUsages = BufferUsages::MAP_WRITE.union(BufferUsages::COPY_SRC);
/// What a readback slot is for.
pub(super) const READBACK: BufferUsages = BufferUsages::MAP_READ.union(BufferUsages::COPY_DST);
