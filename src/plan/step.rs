//! One run of a kernel.

use super::{Buf, BufId, Content, Shape};
use crate::error::{Error, Result};
use crate::frame::Size;
use crate::kernel::Kernel;

/// One run of a kernel.
#[derive(Clone)]
pub struct Step {
    /// The kernel.
    pub kernel: &'static Kernel,
    /// Its purpose, for example `level 2, iteration 1`.
    pub label: String,
    /// The bytes of the uniform struct.
    pub params: Vec<u8>,
    /// The input buffers, in the kernel's order.
    pub inputs: Vec<BufId>,
    /// The output buffers, in the kernel's order, and the layout of the result in each.
    pub outputs: Vec<(BufId, Shape)>,
    /// Width and height of the computed image.
    pub extent: Size,
}

impl Step {
    /// Creates a step. The computed image has the size of the first output.
    pub fn new<P: bytemuck::Pod>(
        kernel: &'static Kernel,
        label: impl Into<String>,
        params: P,
        inputs: &[BufId],
        outputs: &[(BufId, Shape)],
    ) -> Self {
        Self {
            kernel,
            label: label.into(),
            params: bytemuck::bytes_of(&params).to_vec(),
            inputs: inputs.to_vec(),
            outputs: outputs.to_vec(),
            extent: outputs[0].1.size,
        }
    }

    pub(super) fn validate(&self, bufs: &[Buf], filled: &mut [bool]) -> Result<()> {
        let wrong = |problem: String| {
            Err(Error::Kernel { kernel: format!("{} ({})", self.kernel.name, self.label), problem })
        };
        let Kernel { params, inputs, outputs, .. } = self.kernel;
        for (what, found, expected) in [
            ("parameter bytes", self.params.len(), params.size),
            ("inputs", self.inputs.len(), inputs.len()),
            ("outputs", self.outputs.len(), outputs.len()),
        ] {
            if found != expected {
                return wrong(format!("{found} {what}, expected {expected}"));
            }
        }
        if let Some(input) = self.inputs.iter().find(|input| !filled[input.0]) {
            return wrong(format!("reads {}, which nothing has filled", bufs[input.0].name));
        }
        for (i, &(output, shape)) in self.outputs.iter().enumerate() {
            let buf = &bufs[output.0];
            if self.inputs.contains(&output) || self.outputs[..i].iter().any(|other| other.0 == output) {
                return wrong(format!("{} is an output and also another buffer of the step", buf.name));
            }
            if buf.content != Content::Computed {
                return wrong(format!("writes {}, which is an input or a constant", buf.name));
            }
            if buf.len < shape.len() {
                return wrong(format!(
                    "{} holds {} values, the result has {}",
                    buf.name,
                    buf.len,
                    shape.len()
                ));
            }
            filled[output.0] = true;
        }
        Ok(())
    }
}
