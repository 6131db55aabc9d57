//! A plan's buffers, pipelines and bind groups on a device, created once and replayed frame by frame.

use std::collections::HashMap;

use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{BindGroup, Buffer, BufferDescriptor, BufferUsages, ComputePass, ComputePipeline, QuerySet};

use super::pipelines::Pipeline;
use super::{Gpu, blocking, reflect};
use crate::error::{Error, Result};
use crate::kernel::Kernel;
use crate::plan::{BufId, Content, Plan, Step};

/// A plan on a device.
pub struct GpuExecutor {
    gpu: Gpu,
    bufs: Vec<Buffer>,
    ingest: [Vec<Dispatch>; 2],
    pair: [Vec<Dispatch>; 2],
}

/// A step, ready to be replayed.
struct Dispatch {
    pipeline: ComputePipeline,
    bind_group: BindGroup,
    workgroups: [u32; 3],
}

impl Dispatch {
    fn record(&self, pass: &mut ComputePass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bind_group, &[]);
        let [x, y, z] = self.workgroups;
        pass.dispatch_workgroups(x, y, z);
    }
}

impl Pipeline {
    fn dispatch(
        &self,
        gpu: &Gpu,
        label: &str,
        params: wgpu::BindingResource<'_>,
        buffers: &[&Buffer],
        [columns, rows]: [u32; 2],
    ) -> Dispatch {
        let entries: Vec<wgpu::BindGroupEntry<'_>> = std::iter::once(params)
            .chain(buffers.iter().map(|buffer| buffer.as_entire_binding()))
            .enumerate()
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding: binding as u32, resource })
            .collect();
        let bind_group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(label),
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        // The surplus of a row is computed too: it repeats the row's last pixel.
        let workgroups = self.shape.workgroups(columns.next_multiple_of(4), rows);
        Dispatch { pipeline: self.pipeline.clone(), bind_group, workgroups }
    }
}

impl GpuExecutor {
    /// Creates the plan's buffers, pipelines and bind groups, and runs the setup steps. Native only: it blocks.
    /// [`GpuExecutor::open`] is the asynchronous form.
    ///
    /// # Errors
    /// As [`GpuExecutor::open`].
    pub fn new(gpu: &Gpu, plan: &Plan) -> Result<Self> {
        blocking::block_on(Self::open(gpu, plan))
    }

    /// Creates the plan's buffers, pipelines and bind groups, and runs the setup steps.
    ///
    /// # Errors
    /// [`Error::TooLarge`] if a buffer is over the device's limits, [`Error::Kernel`] if a shader does not fit its
    /// kernel or does not compile, [`Error::DeviceLost`] if the device was lost.
    pub async fn open(gpu: &Gpu, plan: &Plan) -> Result<Self> {
        check_limits(gpu, plan)?;
        let bufs: Vec<Buffer> = plan
            .bufs
            .iter()
            .map(|buf| match &buf.content {
                Content::Constant(values) => constant(gpu, &buf.name, values),
                Content::Input | Content::Computed => gpu.device.create_buffer(&BufferDescriptor {
                    label: Some(&buf.name),
                    size: 4 * buf.len as u64,
                    usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
                    mapped_at_creation: false,
                }),
            })
            .collect();
        let pipelines = Compiled::of(gpu, plan).await?;
        let dispatches = |steps: &[Step]| dispatches(gpu, steps, &bufs, &pipelines);
        let ingest = [dispatches(&plan.ingest[0]), dispatches(&plan.ingest[1])];
        let pair = [dispatches(&plan.pair[0]), dispatches(&plan.pair[1])];
        if !plan.setup.is_empty() {
            let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            dispatches(&plan.setup).iter().for_each(|dispatch| dispatch.record(&mut pass));
            drop(pass);
            gpu.submit(encoder);
        }
        Ok(Self { gpu: gpu.clone(), bufs, ingest, pair })
    }

    /// A buffer of the plan on the device.
    pub fn buf(&self, id: BufId) -> &Buffer {
        &self.bufs[id.index()]
    }

    /// Records the steps of a frame alone.
    pub fn record_ingest(&self, pass: &mut ComputePass<'_>, parity: usize) {
        self.ingest[parity].iter().for_each(|dispatch| dispatch.record(pass));
    }

    /// Records the steps of a frame and the previous one.
    pub fn record_pair(&self, pass: &mut ComputePass<'_>, parity: usize) {
        self.pair[parity].iter().for_each(|dispatch| dispatch.record(pass));
    }

    /// Records a frame's steps. If queries are given, the clock is read before the first step and after each step.
    pub(crate) fn record_frame(
        &self,
        pass: &mut ComputePass<'_>,
        parity: usize,
        pair: bool,
        queries: Option<&QuerySet>,
    ) {
        let Some(queries) = queries else {
            self.record_ingest(pass, parity);
            if pair {
                self.record_pair(pass, parity);
            }
            return;
        };
        let pair: &[Dispatch] = if pair { &self.pair[parity] } else { &[] };
        pass.write_timestamp(queries, 0);
        for (i, dispatch) in (1..).zip(self.ingest[parity].iter().chain(pair)) {
            dispatch.record(pass);
            pass.write_timestamp(queries, i);
        }
    }

    /// Writes `values` to the beginning of a buffer. For tests and comparisons: a stream uses mapped buffers.
    pub fn write(&self, id: BufId, values: &[f32]) {
        self.gpu.queue.write_buffer(self.buf(id), 0, bytemuck::cast_slice(values));
    }

    /// Reads the first `len` values of a buffer, and waits for them. For tests and comparisons. Native only: it blocks.
    ///
    /// # Errors
    /// [`Error::DeviceLost`] if the device was lost.
    pub fn read(&self, id: BufId, len: usize) -> Result<Vec<f32>> {
        self.gpu.wait_for(self.fetch(id, len))
    }

    /// Reads the first `len` values of a buffer. As with [`Gpu::finished`], something must poll the device.
    ///
    /// # Errors
    /// [`Error::DeviceLost`] if the device was lost.
    pub async fn fetch(&self, id: BufId, len: usize) -> Result<Vec<f32>> {
        read(&self.gpu, self.buf(id), len).await
    }

    /// Runs one step of [`Plan::steps`] and waits for it. For comparisons. Native only: it blocks.
    ///
    /// # Errors
    /// [`Error::DeviceLost`] if the device was lost.
    pub fn run(&self, parity: usize, index: usize) -> Result<()> {
        let dispatch = self.ingest[parity].iter().chain(&self.pair[parity]).nth(index);
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        if let Some(dispatch) = dispatch {
            dispatch.record(&mut encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default()));
        }
        self.gpu.submit(encoder);
        self.gpu.finish()
    }
}

/// The pipelines of a plan's kernels.
struct Compiled(HashMap<*const Kernel, Pipeline>);

impl Compiled {
    async fn of(gpu: &Gpu, plan: &Plan) -> Result<Self> {
        let steps = [&plan.setup].into_iter().chain(&plan.ingest).chain(&plan.pair).flatten();
        let mut kernels: Vec<&'static Kernel> = steps.map(|step| step.kernel).collect();
        kernels.sort_by_key(|kernel| std::ptr::from_ref(*kernel));
        kernels.dedup_by_key(|kernel| std::ptr::from_ref(*kernel));
        let pipelines = gpu.pipelines.get(gpu, &kernels).await?;
        Ok(Self(kernels.into_iter().map(std::ptr::from_ref).zip(pipelines).collect()))
    }

    fn of_step(&self, step: &Step) -> &Pipeline {
        &self.0[&std::ptr::from_ref(step.kernel)]
    }
}

fn dispatches(gpu: &Gpu, steps: &[Step], bufs: &[Buffer], pipelines: &Compiled) -> Vec<Dispatch> {
    let align = gpu.limits().min_uniform_buffer_offset_alignment as usize;
    let mut bytes = Vec::new();
    let mut offsets = Vec::new();
    for step in steps {
        bytes.resize(bytes.len().next_multiple_of(align), 0);
        offsets.push(bytes.len() as u64);
        bytes.extend(&step.params);
    }
    let params = gpu.device.create_buffer_init(&BufferInitDescriptor {
        label: Some("params"),
        contents: &bytes,
        usage: BufferUsages::UNIFORM,
    });
    steps
        .iter()
        .zip(offsets)
        .map(|(step, offset)| {
            let buffers: Vec<&Buffer> = (step.inputs.iter())
                .chain(step.outputs.iter().map(|(id, _)| id))
                .map(|id| &bufs[id.index()])
                .collect();
            let params = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: &params,
                offset,
                size: std::num::NonZero::new(step.params.len() as u64),
            });
            let label = format!("{}, {}", step.kernel.name, step.label);
            let extent = [step.extent.width, step.extent.height];
            pipelines.of_step(step).dispatch(gpu, &label, params, &buffers, extent)
        })
        .collect()
}

fn check_limits(gpu: &Gpu, plan: &Plan) -> Result<()> {
    let limits = gpu.limits();
    let limit = limits.max_buffer_size.min(limits.max_storage_buffer_binding_size);
    match plan.bufs.iter().find(|buf| 4 * buf.len as u64 > limit) {
        None => Ok(()),
        Some(buf) => Err(Error::TooLarge {
            what: buf.name.clone(),
            size: plan.size,
            needed: 4 * buf.len as u64,
            limit,
            adapter: gpu.adapter().to_string(),
        }),
    }
}

/// A buffer that shaders may bind as storage or as a table; as a table it ends with zeros.
fn constant(gpu: &Gpu, label: &str, values: &[f32]) -> Buffer {
    let mut padded = values.to_vec();
    padded.resize(values.len().max(reflect::TABLE), 0.0);
    gpu.device.create_buffer_init(&BufferInitDescriptor {
        label: Some(label),
        contents: bytemuck::cast_slice(&padded),
        usage: BufferUsages::STORAGE | BufferUsages::UNIFORM | BufferUsages::COPY_SRC,
    })
}

fn storage(gpu: &Gpu, label: &str, values: &[f32]) -> Buffer {
    gpu.device.create_buffer_init(&BufferInitDescriptor {
        label: Some(label),
        contents: bytemuck::cast_slice(values),
        usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC,
    })
}

async fn read(gpu: &Gpu, buffer: &Buffer, len: usize) -> Result<Vec<f32>> {
    let size = 4 * len as u64;
    let target = gpu.device.create_buffer(&BufferDescriptor {
        label: Some("read"),
        size,
        usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(buffer, 0, &target, 0, size);
    gpu.submit(encoder);
    // Whether the mapping succeeded shows when the range is requested.
    target.map_async(wgpu::MapMode::Read, .., |_| {});
    gpu.finished().await?;
    let range = target.get_mapped_range(..).map_err(|error| gpu.lost_error(error.to_string()))?;
    Ok(bytemuck::pod_collect_to_vec(&range))
}

pub(super) async fn run_alone(
    gpu: &Gpu,
    kernel: &Kernel,
    params: &[u8],
    inputs: &[&[f32]],
    outputs: Vec<Vec<f32>>,
    extent: [u32; 2],
) -> Result<Vec<Vec<f32>>> {
    let [pipeline] = &gpu.pipelines.get(gpu, &[kernel]).await?[..] else {
        unreachable!("one kernel has one pipeline");
    };
    let params = gpu.device.create_buffer_init(&BufferInitDescriptor {
        label: Some("params"),
        contents: params,
        usage: BufferUsages::UNIFORM,
    });
    let input = |(i, values): (usize, &&[f32])| match pipeline.shape.tables >> i & 1 {
        1 => constant(gpu, "table", values),
        _ => storage(gpu, "input", values),
    };
    let inputs: Vec<Buffer> = inputs.iter().enumerate().map(input).collect();
    let outputs: Vec<(Buffer, usize)> =
        outputs.iter().map(|values| (storage(gpu, "output", values), values.len())).collect();
    let buffers: Vec<&Buffer> = inputs.iter().chain(outputs.iter().map(|(buffer, _)| buffer)).collect();
    let dispatch = pipeline.dispatch(gpu, kernel.name, params.as_entire_binding(), &buffers, extent);
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    dispatch.record(&mut encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default()));
    gpu.submit(encoder);
    let mut results = Vec::with_capacity(outputs.len());
    for (buffer, len) in outputs {
        results.push(read(gpu, &buffer, len).await?);
    }
    Ok(results)
}
