//! A frame's buffers between host and GPU: allocated once and mapped again for each frame.

use wgpu::{Buffer, BufferDescriptor, BufferUsages, BufferViewMut, SubmissionIndex};

use super::layout::Layout;
use crate::error::{Error, Result};
use crate::gpu::Gpu;
use crate::plan::pack::{Sink, pack};
use crate::plan::{Fill, Given, Plan};

/// The buffers of a frame in flight.
pub(super) struct Slot {
    /// The inputs, one after the other. Mapped whenever no submission holds it.
    pub(super) upload: Buffer,
    /// The outputs, then the clock's ticks; `None` if nothing is read.
    pub(super) readback: Option<Buffer>,
    /// The submission that holds the buffers.
    pub(super) submission: Option<SubmissionIndex>,
    /// For each input, the number of values that were given for the frame.
    pub(super) given: Vec<Option<usize>>,
    /// Whether the readback buffer is mapped, or will be.
    pub(super) mapped: bool,
    /// For each input, whether its place in the upload buffer holds the default for an absent value.
    filled: Vec<bool>,
}

impl Slot {
    pub(super) fn new(gpu: &Gpu, plan: &Plan, layout: &Layout, ticks: u64) -> Result<Self> {
        let read = (4 * layout.readback() as u64).next_multiple_of(8) + ticks;
        let readback = match read {
            0 => None,
            _ => Some(buffer(gpu, plan, "readback", read, super::gpu::READBACK)?),
        };
        let upload = buffer(gpu, plan, "upload", 4 * layout.upload() as u64, super::gpu::UPLOAD)?;
        let inputs = plan.inputs.len();
        let (given, filled) = (vec![None; inputs], vec![false; inputs]);
        Ok(Self { upload, readback, submission: None, given, mapped: false, filled })
    }

    pub(super) fn bytes(&self) -> u64 {
        self.upload.size() + self.readback.as_ref().map_or(0, Buffer::size)
    }

    /// Copies a frame's inputs into the upload buffer.
    pub(super) fn fill(
        &mut self,
        gpu: &Gpu,
        plan: &Plan,
        layout: &Layout,
        given: &[Given<'_>],
    ) -> Result<()> {
        let mut view =
            self.upload.get_mapped_range_mut(..).map_err(|error| gpu.lost_error(error.to_string()))?;
        for (i, (port, input)) in plan.inputs.iter().zip(&layout.inputs).enumerate() {
            let mut region =
                Region { view: &mut view, start: 4 * input.place.start, end: 4 * input.place.end };
            let value = port.among(given);
            self.given[i] = value.as_ref().map(|value| pack(port.kind, value, &mut region));
            match &port.if_absent {
                _ if value.is_some() => self.filled[i] = false,
                _ if self.filled[i] => {}
                Fill::Required | Fill::Keep => {}
                Fill::Value(value) => {
                    region.values(std::iter::repeat_n(*value, input.place.len()));
                    self.filled[i] = true;
                }
                Fill::Values(values) => {
                    region.values(values.iter().copied());
                    self.filled[i] = true;
                }
            }
        }
        Ok(())
    }

    /// Makes the slot ready for the next frame.
    pub(super) fn release(&mut self) {
        self.submission = None;
        if let Some(readback) = self.readback.as_ref().filter(|_| self.mapped) {
            readback.unmap();
        }
        self.mapped = false;
    }
}

/// An input's place in a mapped buffer, in bytes.
struct Region<'a> {
    view: &'a mut BufferViewMut,
    start: usize,
    end: usize,
}

impl Sink for Region<'_> {
    fn bytes(&mut self, at: usize, bytes: &[u8]) {
        let at = self.start + at;
        self.view.slice(at..at + bytes.len()).copy_from_slice(bytes);
    }

    fn values(&mut self, values: impl Iterator<Item = f32>) {
        let (words, _) = self.view.slice(self.start..self.end).into_chunks::<4>();
        words.write_iter(values.map(f32::to_ne_bytes));
    }
}

/// A buffer for a frame, created mapped if the host writes it.
fn buffer(gpu: &Gpu, plan: &Plan, name: &str, size: u64, usage: BufferUsages) -> Result<Buffer> {
    let limit = gpu.limits().max_buffer_size;
    if size > limit {
        let (what, adapter) = (name.to_owned(), gpu.adapter().to_string());
        return Err(Error::TooLarge { what, size: plan.size, needed: size, limit, adapter });
    }
    Ok(gpu.device.create_buffer(&BufferDescriptor {
        label: Some(name),
        size,
        usage,
        mapped_at_creation: usage.contains(BufferUsages::MAP_WRITE),
    }))
}
