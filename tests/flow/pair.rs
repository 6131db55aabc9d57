//! The flow of one pair of pictures, on either executor.

use viewsphere::cpu::CpuExecutor;
use viewsphere::flow::Farneback;
use viewsphere::frame::{FlowField, Image, Size};
use viewsphere::gpu::{Gpu, GpuExecutor};
use viewsphere::kernels::compare::POISON;
use viewsphere::kernels::luma;
use viewsphere::plan::{BufId, Content, Plan, Shape};

/// What runs a plan.
#[derive(Clone, Copy)]
pub(crate) enum On<'a> {
    Cpu,
    Gpu(&'a Gpu),
}

impl On<'_> {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Cpu => "CPU",
            Self::Gpu(_) => "GPU",
        }
    }
}

/// The flow from the first picture to the second.
///
/// Everything that the plan computes is poisoned first, so that a step that reads what none has written shows.
pub(crate) fn flow(
    on: On<'_>,
    config: &Farneback,
    images: [&Image; 2],
    init: Option<&FlowField>,
) -> FlowField {
    let size = images[0].size;
    let plan = config.plan(size, images[0].format).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(plan.initial_flow, init.is_some(), "an initial flow is given where the plan takes one");
    let frames = images.map(words);
    let init = init.map(|init| (plan.flow[0], planar(init)));
    let values = match on {
        On::Cpu => on_cpu(&plan, frames, init),
        On::Gpu(gpu) => on_gpu(gpu, &plan, frames, init),
    };
    interleaved(size, &values)
}

/// The first picture comes with parity 0, the second with parity 1; the initial flow stands where the pair before left it.
fn on_cpu(plan: &Plan, frames: [Vec<f32>; 2], init: Option<(BufId, Vec<f32>)>) -> Vec<f32> {
    let mut executor = CpuExecutor::new(plan);
    for (id, len) in computed(plan) {
        executor.buf_mut(id)[..len].fill(POISON);
    }
    if let Some((id, values)) = init {
        executor.buf_mut(id).copy_from_slice(&values);
    }
    let pair = [&[][..], &plan.pair[1]];
    for (parity, frame) in frames.iter().enumerate() {
        executor.buf_mut(plan.frame).copy_from_slice(frame);
        for step in plan.ingest[parity].iter().chain(pair[parity]) {
            executor.run(step);
        }
    }
    executor.buf(plan.flow[1]).to_vec()
}

fn on_gpu(gpu: &Gpu, plan: &Plan, frames: [Vec<f32>; 2], init: Option<(BufId, Vec<f32>)>) -> Vec<f32> {
    let executor = GpuExecutor::new(gpu, plan).unwrap_or_else(|error| panic!("{error}"));
    for (id, len) in computed(plan) {
        executor.write(id, &vec![POISON; len]);
    }
    if let Some((id, values)) = init {
        executor.write(id, &values);
    }
    for (parity, frame) in frames.iter().enumerate() {
        executor.write(plan.frame, frame);
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        executor.record_ingest(&mut pass, parity);
        if parity == 1 {
            executor.record_pair(&mut pass, parity);
        }
        drop(pass);
        gpu.queue().submit([encoder.finish()]);
    }
    let len = Shape::planar(plan.size, 2).len();
    executor.read(plan.flow[1], len).unwrap_or_else(|error| panic!("{error}"))
}

fn computed(plan: &Plan) -> impl Iterator<Item = (BufId, usize)> {
    // Every buffer that is computed is some step's output.
    let steps = [0, 1].into_iter().flat_map(|parity| plan.steps(parity));
    let outputs = steps.flat_map(|step| step.outputs.iter().map(|(id, _)| *id));
    outputs.filter(|id| plan.buf(*id).content == Content::Computed).map(|id| (id, plan.buf(id).len))
}

/// A picture's bytes as the `frame` buffer holds them: rows begin at whole words.
fn words(image: &Image) -> Vec<f32> {
    let row_bytes = image.size.width as usize * image.format.bytes();
    let mut bytes = Vec::new();
    for row in image.data.chunks_exact(row_bytes) {
        bytes.extend(row);
        bytes.resize(bytes.len().next_multiple_of(4), 0);
    }
    assert_eq!(bytes.len(), 4 * luma::row_words(image.size, image.format) * image.size.height as usize);
    bytemuck::pod_collect_to_vec(&bytes)
}

fn planar(field: &FlowField) -> Vec<f32> {
    let size = field.size;
    let mut values = Vec::with_capacity(Shape::planar(size, 2).len());
    for row in field.data.chunks_exact(size.width as usize) {
        let channel = |i: usize| (0..size.stride()).map(move |x| row[x.min(row.len() - 1)][i]);
        values.extend(channel(0).chain(channel(1)));
    }
    values
}

fn interleaved(size: Size, values: &[f32]) -> FlowField {
    let rows = values.chunks_exact(2 * size.stride());
    let pixels = |row: &[f32]| {
        let (u, v) = row.split_at(size.stride());
        (0..size.width as usize).map(|x| [u[x], v[x]]).collect::<Vec<_>>()
    };
    FlowField { size, data: rows.flat_map(pixels).collect() }
}
