//! Runs a plan on single images or pairs, one call at a time, on either executor.
//!
//! Undistortion, the simulator's renderer and comparisons of the two executors use it. For streams of frames in real
//! time see [`Stream`](crate::stream::Stream).

use std::panic::{AssertUnwindSafe, catch_unwind};

use wgpu::{
    Buffer, BufferDescriptor, BufferUsages, CommandEncoderDescriptor, ComputePassDescriptor, MapMode,
};

use crate::backend::Backend;
use crate::cpu::CpuExecutor;
use crate::error::Result;
use crate::gpu::{Gpu, GpuExecutor};
use crate::plan::pack::pack;
use crate::plan::{BufId, Fill, Given, Outputs, Plan, Port, Step, Value};

/// A plan on an executor, with its ports.
pub struct Runner {
    plan: Plan,
    side: Side,
    outputs: Outputs,
}

enum Side {
    Cpu(CpuExecutor),
    Gpu(Box<OnGpu>),
}

struct OnGpu {
    gpu: Gpu,
    exec: GpuExecutor,
    /// All outputs, one after the other.
    readback: Option<Buffer>,
    /// Room to pack an input in.
    room: Vec<f32>,
}

impl Runner {
    /// Allocates the plan's buffers and runs its setup steps.
    ///
    /// # Errors
    /// [`Error::Kernel`](crate::Error::Kernel) for a plan that contradicts itself; on a GPU also
    /// [`Error::TooLarge`](crate::Error::TooLarge), [`Error::OutOfMemory`](crate::Error::OutOfMemory) and
    /// [`Error::DeviceLost`](crate::Error::DeviceLost).
    pub fn new(backend: &Backend, plan: Plan) -> Result<Self> {
        plan.validate()?;
        let side = match backend {
            Backend::Cpu => Side::Cpu(CpuExecutor::new(&plan)),
            Backend::Gpu(gpu) => gpu.guarded(&plan, || {
                let exec = GpuExecutor::new(gpu, &plan)?;
                let len: usize = plan.outputs.iter().map(|port| port.kind.len()).sum();
                let readback = (len > 0).then(|| {
                    gpu.device.create_buffer(&BufferDescriptor {
                        label: Some("readback"),
                        size: 4 * len as u64,
                        usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
                        mapped_at_creation: false,
                    })
                });
                let longest = plan.inputs.iter().map(|port| port.kind.len()).max();
                let room = vec![0.0; longest.unwrap_or_default()];
                Ok(Side::Gpu(Box::new(OnGpu { gpu: gpu.clone(), exec, readback, room })))
            })?,
        };
        Ok(Self { side, outputs: Outputs::new(&plan.outputs), plan })
    }

    /// The plan.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Runs a plan for single images.
    ///
    /// # Errors
    /// As [`Plan::check`]; [`Error::DeviceLost`](crate::Error::DeviceLost) if the device was lost.
    pub fn run(&mut self, given: &[Given<'_>]) -> Result<&Outputs> {
        self.frame(0, true, given)
    }

    /// Runs the ingest steps of a frame with this parity and, if it is the later frame of a pair, the steps of the
    /// pair. The outputs are read after a pair only; otherwise they keep their previous values.
    ///
    /// # Errors
    /// As [`Runner::run`].
    pub fn frame(&mut self, parity: usize, pair: bool, given: &[Given<'_>]) -> Result<&Outputs> {
        let Self { plan, side, outputs } = self;
        plan.check(given)?;
        match side {
            Side::Cpu(exec) => {
                for port in &plan.inputs {
                    write_on_cpu(exec, port, parity, port.among(given));
                }
                plan.ingest[parity].iter().for_each(|step| exec.run(step));
                if pair {
                    plan.pair[parity].iter().for_each(|step| exec.run(step));
                    for (i, port) in plan.outputs.iter().enumerate() {
                        outputs.unpack(i, exec.buf(port.bufs[parity]));
                    }
                }
            }
            Side::Gpu(on) => on.frame(plan, parity, pair, given, outputs)?,
        }
        Ok(outputs)
    }

    /// Writes the inputs of a frame with this parity, without running anything.
    ///
    /// # Errors
    /// As [`Plan::check`].
    pub fn set(&mut self, parity: usize, given: &[Given<'_>]) -> Result<()> {
        self.plan.check(given)?;
        for port in &self.plan.inputs {
            let value = port.among(given);
            match &mut self.side {
                Side::Cpu(exec) => write_on_cpu(exec, port, parity, value),
                Side::Gpu(on) => on.write(port, parity, value),
            }
        }
        Ok(())
    }

    /// Runs one of the plan's [`steps`](Plan::steps) of a parity, and waits for it.
    ///
    /// # Errors
    /// [`Error::DeviceLost`](crate::Error::DeviceLost) if the device was lost.
    pub fn step(&mut self, parity: usize, index: usize) -> Result<()> {
        match &mut self.side {
            Side::Cpu(exec) => {
                self.plan.steps(parity).nth(index).into_iter().for_each(|step: &Step| exec.run(step));
                Ok(())
            }
            Side::Gpu(on) => on.exec.run(parity, index),
        }
    }

    /// Writes `values` to the beginning of a buffer.
    pub fn write(&mut self, id: BufId, values: &[f32]) {
        match &mut self.side {
            Side::Cpu(exec) => exec.buf_mut(id)[..values.len()].copy_from_slice(values),
            Side::Gpu(on) => on.exec.write(id, values),
        }
    }

    /// Reads the first `len` values of a buffer.
    ///
    /// # Errors
    /// [`Error::DeviceLost`](crate::Error::DeviceLost) if the device was lost.
    pub fn read(&self, id: BufId, len: usize) -> Result<Vec<f32>> {
        match &self.side {
            Side::Cpu(exec) => Ok(exec.buf(id)[..len].to_vec()),
            Side::Gpu(on) => on.exec.read(id, len),
        }
    }
}

fn write_on_cpu(exec: &mut CpuExecutor, port: &Port, parity: usize, value: Option<Value<'_>>) {
    let buf = &mut exec.buf_mut(port.bufs[parity])[..port.kind.len()];
    match (value, &port.if_absent) {
        (Some(value), _) => {
            pack(port.kind, &value, buf);
        }
        (None, Fill::Value(value)) => buf.fill(*value),
        (None, Fill::Values(values)) => buf[..values.len()].copy_from_slice(values),
        (None, Fill::Required | Fill::Keep) => {}
    }
}

impl OnGpu {
    fn frame(
        &mut self,
        plan: &Plan,
        parity: usize,
        pair: bool,
        given: &[Given<'_>],
        outputs: &mut Outputs,
    ) -> Result<()> {
        // wgpu panics where it is out of memory and nobody handles its errors.
        let submitted = catch_unwind(AssertUnwindSafe(|| self.submit(plan, parity, pair, given)));
        submitted.map_err(|_| self.gpu.lost_error("the driver failed while an image was submitted"))?;
        self.gpu.finish()?;
        let Some(readback) = self.readback.as_ref().filter(|_| pair) else { return Ok(()) };
        let view = readback.get_mapped_range(..).map_err(|error| self.gpu.lost_error(error.to_string()))?;
        let mut values: &[f32] = bytemuck::cast_slice(&view);
        for (i, port) in plan.outputs.iter().enumerate() {
            let (own, rest) = values.split_at(port.kind.len());
            outputs.unpack(i, own);
            values = rest;
        }
        drop(view);
        readback.unmap();
        Ok(())
    }

    fn submit(&mut self, plan: &Plan, parity: usize, pair: bool, given: &[Given<'_>]) {
        plan.inputs.iter().for_each(|port| self.write(port, parity, port.among(given)));
        let mut encoder = self.gpu.device.create_command_encoder(&CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor::default());
            self.exec.record_ingest(&mut pass, parity);
            if pair {
                self.exec.record_pair(&mut pass, parity);
            }
        }
        let readback = self.readback.as_ref().filter(|_| pair);
        if let Some(readback) = readback {
            let mut at = 0;
            for port in &plan.outputs {
                let (from, len) = (self.exec.buf(port.bufs[parity]), 4 * port.kind.len() as u64);
                encoder.copy_buffer_to_buffer(from, 0, readback, at, len);
                at += len;
            }
        }
        self.gpu.submit(encoder);
        if let Some(readback) = readback {
            // Whether mapping worked shows when the range is asked for.
            readback.map_async(MapMode::Read, .., |_| {});
        }
    }

    fn write(&mut self, port: &Port, parity: usize, value: Option<Value<'_>>) {
        let (id, room) = (port.bufs[parity], &mut self.room[..port.kind.len()]);
        match (value, &port.if_absent) {
            (Some(Value::Raw(values)), _) => self.exec.write(id, values),
            (Some(value), _) => {
                let len = pack(port.kind, &value, room);
                self.exec.write(id, &room[..len]);
            }
            (None, Fill::Value(value)) => {
                room.fill(*value);
                self.exec.write(id, room);
            }
            (None, Fill::Values(values)) => self.exec.write(id, values),
            (None, Fill::Required | Fill::Keep) => {}
        }
    }
}
