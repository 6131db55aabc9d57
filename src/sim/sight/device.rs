//! What a look is computed on.

use std::panic::{AssertUnwindSafe, catch_unwind};

use wgpu::{
    Buffer, BufferDescriptor, BufferUsages, CommandEncoderDescriptor, ComputePassDescriptor, MapMode,
};

use super::plan::Ports;
use crate::cpu::CpuExecutor;
use crate::engine::{Backend, guarded};
use crate::error::Result;
use crate::gpu::{Gpu, GpuExecutor};
use crate::plan::{BufId, Plan};

/// A plan on the CPU or a GPU.
pub(super) enum Device {
    Cpu(CpuExecutor),
    Gpu(Box<OnGpu>),
}

pub(super) struct OnGpu {
    gpu: Gpu,
    exec: GpuExecutor,
    /// Picture and nearness.
    readback: Buffer,
}

impl Device {
    pub(super) fn new(backend: Backend, plan: &Plan) -> Result<Self> {
        let gpu = match backend {
            Backend::Cpu => return Ok(Self::Cpu(CpuExecutor::new(plan))),
            Backend::Gpu(gpu) => gpu,
        };
        guarded(&gpu, plan, || {
            let exec = GpuExecutor::new(&gpu, plan)?;
            let plane = plan.size.stride() * plan.size.height as usize;
            let readback = gpu.device.create_buffer(&BufferDescriptor {
                label: Some("sight"),
                size: 8 * plane as u64,
                usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            Ok(Self::Gpu(Box::new(OnGpu { gpu: gpu.clone(), exec, readback })))
        })
    }

    /// Writes the beginnings of buffers, runs the steps of `ingest[which]`, and hands picture and nearness to `read`.
    pub(super) fn run(
        &mut self,
        plan: &Plan,
        ports: &Ports,
        which: usize,
        inputs: &[(BufId, &[f32])],
        read: impl FnOnce(&[f32], &[f32]),
    ) -> Result<()> {
        match self {
            Self::Cpu(exec) => {
                for (id, values) in inputs {
                    exec.buf_mut(*id)[..values.len()].copy_from_slice(values);
                }
                plan.ingest[which].iter().for_each(|step| exec.run(step));
                read(exec.buf(ports.picture), exec.buf(ports.nearness));
                Ok(())
            }
            Self::Gpu(on) => on.run(ports, which, inputs, read),
        }
    }
}

impl OnGpu {
    fn run(
        &self,
        ports: &Ports,
        which: usize,
        inputs: &[(BufId, &[f32])],
        read: impl FnOnce(&[f32], &[f32]),
    ) -> Result<()> {
        // wgpu panics where it is out of memory and nobody handles its errors.
        let submitted = catch_unwind(AssertUnwindSafe(|| self.submit(ports, which, inputs)));
        submitted.map_err(|_| self.gpu.lost_error("the driver failed while a picture was submitted"))?;
        self.gpu.finish()?;
        let view =
            self.readback.get_mapped_range(..).map_err(|error| self.gpu.lost_error(error.to_string()))?;
        let values: &[f32] = bytemuck::cast_slice(&view);
        let (picture, nearness) = values.split_at(values.len() / 2);
        read(picture, nearness);
        drop(view);
        self.readback.unmap();
        Ok(())
    }

    fn submit(&self, ports: &Ports, which: usize, inputs: &[(BufId, &[f32])]) {
        for (id, values) in inputs {
            self.exec.write(*id, values);
        }
        let mut encoder = self.gpu.device.create_command_encoder(&CommandEncoderDescriptor::default());
        self.exec.record_ingest(&mut encoder.begin_compute_pass(&ComputePassDescriptor::default()), which);
        let half = self.readback.size() / 2;
        encoder.copy_buffer_to_buffer(self.exec.buf(ports.picture), 0, &self.readback, 0, half);
        encoder.copy_buffer_to_buffer(self.exec.buf(ports.nearness), 0, &self.readback, half, half);
        self.gpu.submit(encoder);
        // Whether mapping worked shows when the range is asked for.
        self.readback.map_async(MapMode::Read, .., |_| {});
    }
}
