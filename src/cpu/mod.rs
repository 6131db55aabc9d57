//! The CPU executor: runs a plan's steps with the kernels' references.

use crate::plan::{BufId, Content, Plan, Step};

/// The largest number of a kernel's input buffers: eight storage buffers per stage, one of them an output.
const MAX_INPUTS: usize = 7;
/// The largest number of a kernel's output buffers.
const MAX_OUTPUTS: usize = 3;

/// A plan's buffers in main memory.
pub struct CpuExecutor {
    bufs: Vec<Vec<f32>>,
}

impl CpuExecutor {
    /// Allocates the buffers and runs the setup steps. Nothing is allocated afterwards.
    pub fn new(plan: &Plan) -> Self {
        let values = |content: &Content, len| match content {
            Content::Constant(values) => values.clone(),
            Content::Input | Content::Computed => vec![0.0; len],
        };
        let mut executor = Self { bufs: plan.bufs.iter().map(|buf| values(&buf.content, buf.len)).collect() };
        plan.setup.iter().for_each(|step| executor.run(step));
        executor
    }

    /// A buffer's values, in the layout of its [`Shape`](crate::plan::Shape).
    pub fn buf(&self, id: BufId) -> &[f32] {
        &self.bufs[id.index()]
    }

    /// A buffer's values, for writing.
    pub fn buf_mut(&mut self, id: BufId) -> &mut [f32] {
        &mut self.bufs[id.index()]
    }

    /// Runs one step of the plan that this executor was made for.
    pub fn run(&mut self, step: &Step) {
        // The plan's check excludes that an output is also an input, so outputs can be moved out while inputs are
        // borrowed.
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
