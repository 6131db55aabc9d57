//! A frame's buffers between host and GPU, mapped and mapped again, never made anew.

use wgpu::{Buffer, BufferDescriptor, BufferUsages, BufferViewMut, ErrorFilter, SubmissionIndex};

use super::Extras;
use super::layout::{self, Layout};
use crate::error::{Error, Result};
use crate::frame::Frame;
use crate::gpu::{self, Gpu};
use crate::plan::Plan;
use crate::sphere::Motion;

/// The buffers of a frame in flight.
pub(super) struct Slot {
    /// The frame, its certainty, its initial flow, its motion. Mapped whenever no submission holds it.
    pub(super) upload: Buffer,
    /// The flow, the confidence, the plan's fields, the clock's ticks; none if nothing of it is read.
    pub(super) readback: Option<Buffer>,
    /// The submission that holds the buffers.
    pub(super) submission: Option<SubmissionIndex>,
    /// Whether the frame came with a certainty.
    pub(super) has_certainty: bool,
    /// Whether the readback buffer is mapped, or will be.
    pub(super) mapped: bool,
    /// Whether the upload buffer's certainty is one everywhere.
    trusted: bool,
}

impl Slot {
    pub(super) fn new(gpu: &Gpu, layout: &Layout, ticks: u64) -> Result<Self> {
        let read = (4 * layout.readback() as u64).next_multiple_of(8) + ticks;
        let readback = match read {
            0 => None,
            _ => Some(buffer(gpu, layout, "readback", read, super::gpu::READBACK)?),
        };
        let upload = buffer(gpu, layout, "upload", 4 * layout.upload() as u64, super::gpu::UPLOAD)?;
        Ok(Self { upload, readback, submission: None, has_certainty: false, mapped: false, trusted: false })
    }

    pub(super) fn bytes(&self) -> u64 {
        self.upload.size() + self.readback.as_ref().map_or(0, Buffer::size)
    }

    /// Copies a frame and what comes with it into the upload buffer.
    pub(super) fn fill(
        &mut self,
        gpu: &Gpu,
        layout: &Layout,
        frame: &Frame<'_>,
        extras: &Extras<'_>,
    ) -> Result<()> {
        let mut view =
            self.upload.get_mapped_range_mut(..).map_err(|error| gpu.lost_error(error.to_string()))?;
        for y in 0..layout.size.height {
            let row = frame.row(y);
            let at = 4 * layout.row * y as usize;
            view.slice(at..at + row.len()).copy_from_slice(row);
        }
        self.has_certainty = extras.certainty.is_some();
        if let Some(plane) = extras.certainty {
            let values = layout::certainty(&plane.data, plane.size);
            write(&mut view, layout.frame, layout.certainty, values);
            self.trusted = false;
        } else if !self.trusted {
            write(&mut view, layout.frame, layout.certainty, std::iter::repeat_n(1.0, layout.certainty));
            self.trusted = true;
        }
        if let Some(field) = extras.initial_flow {
            write(&mut view, layout.frame + layout.certainty, layout.initial, layout::flow(field));
        }
        if layout.motion > 0 {
            let values = extras.motion.unwrap_or(&Motion::UNKNOWN).values();
            write(&mut view, layout.upload() - layout.motion, layout.motion, values.into_iter());
        }
        Ok(())
    }

    /// Lets the next frame in.
    pub(super) fn release(&mut self) {
        self.submission = None;
        if let Some(readback) = self.readback.as_ref().filter(|_| self.mapped) {
            readback.unmap();
        }
        self.mapped = false;
    }
}

fn write(view: &mut BufferViewMut, at: usize, len: usize, values: impl Iterator<Item = f32>) {
    let (words, _) = view.slice(4 * at..4 * (at + len)).into_chunks::<4>();
    words.write_iter(values.map(f32::to_ne_bytes));
}

/// A buffer for a frame, mapped from the beginning if the host writes it.
pub(super) fn buffer(
    gpu: &Gpu,
    layout: &Layout,
    name: &str,
    size: u64,
    usage: BufferUsages,
) -> Result<Buffer> {
    let limit = gpu.limits().max_buffer_size;
    if size > limit {
        let (what, adapter) = (name.to_owned(), gpu.adapter().to_string());
        return Err(Error::TooLarge { what, size: layout.size, needed: size, limit, adapter });
    }
    Ok(gpu.device.create_buffer(&BufferDescriptor {
        label: Some(name),
        size,
        usage,
        mapped_at_creation: usage.contains(BufferUsages::MAP_WRITE),
    }))
}

/// Makes a stream, and turns what wgpu would panic about into errors.
pub(crate) fn guarded<T>(gpu: &Gpu, plan: &Plan, make: impl FnOnce() -> Result<T>) -> Result<T> {
    let memory = gpu.device.push_error_scope(ErrorFilter::OutOfMemory);
    let validation = gpu.device.push_error_scope(ErrorFilter::Validation);
    let made = make();
    let invalid = gpu::block_on(validation.pop());
    let full = gpu::block_on(memory.pop());
    let made = made?;
    if full.is_some() {
        let adapter = gpu.adapter().to_string();
        return Err(Error::OutOfMemory { adapter, size: plan.size, needed: plan.bytes() });
    }
    match invalid {
        Some(_) if gpu.lost().is_some() => Err(gpu.lost_error("")),
        Some(error) => {
            // The message runs over several lines; an error is one.
            let problem = error.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
            Err(Error::Kernel { kernel: "plan".to_owned(), problem })
        }
        None => Ok(made),
    }
}
