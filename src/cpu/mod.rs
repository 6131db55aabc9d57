//! The CPU executor: a plan's steps, replayed on the kernels' references.

use crate::plan::{BufId, Content, Plan, Step};

/// Kernels have at most this many input buffers: eight storage buffers a stage, one of them an output.
const MAX_INPUTS: usize = 7;
/// And at most this many outputs.
const MAX_OUTPUTS: usize = 3;

/// A plan's buffers in main memory.
pub struct CpuExecutor {
    bufs: Vec<Vec<f32>>,
}

impl CpuExecutor {
    /// Allocates the buffers and runs what is computed once. Nothing is allocated afterwards.
    pub fn new(plan: &Plan) -> Self {
        let values = |content: &Content, len| match content {
            Content::Constant(values) => values.clone(),
            Content::Input | Content::Computed => vec![0.0; len],
        };
        let mut executor = Self { bufs: plan.bufs.iter().map(|buf| values(&buf.content, buf.len)).collect() };
        plan.setup.iter().for_each(|step| executor.run(step));
        executor
    }

    /// A buffer's values.
    pub fn buf(&self, id: BufId) -> &[f32] {
        &self.bufs[id.index()]
    }

    /// A buffer's values, to be written.
    pub fn buf_mut(&mut self, id: BufId) -> &mut [f32] {
        &mut self.bufs[id.index()]
    }

    /// Runs one step of the plan that this executor was made for.
    pub fn run(&mut self, step: &Step) {
        // A plan's check rules out that an output is an input, so outputs can be taken out while inputs are borrowed.
        let mut taken = [const { Vec::new() }; MAX_OUTPUTS];
        for (taken, (output, _)) in taken.iter_mut().zip(&step.outputs) {
            *taken = std::mem::take(&mut self.bufs[output.index()]);
        }
        let mut inputs: [&[f32]; MAX_INPUTS] = [&[]; MAX_INPUTS];
        for (input, id) in inputs.iter_mut().zip(&step.inputs) {
            *input = &self.bufs[id.index()];
        }
        let mut outputs = taken.each_mut().map(|values| values.as_mut_slice());
        for (output, (_, shape)) in outputs.iter_mut().zip(&step.outputs) {
            *output = &mut std::mem::take(output)[..shape.len()];
        }
        (step.kernel.reference)(
            &step.params,
            &inputs[..step.inputs.len()],
            &mut outputs[..step.outputs.len()],
        );
        for (taken, (output, _)) in taken.into_iter().zip(&step.outputs) {
            self.bufs[output.index()] = taken;
        }
    }
}
