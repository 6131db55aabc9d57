//! A frame's computation as data: buffers, and the steps that fill them. No GPU and no loop over pixels.

use crate::error::{Error, Result};
use crate::frame::Size;
use crate::kernel::Kernel;

/// A buffer of a [`Plan`], by its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BufId(pub(crate) usize);

impl BufId {
    /// The buffer's place in [`Plan::bufs`].
    pub fn index(self) -> usize {
        self.0
    }
}

/// A buffer of `f32`.
#[derive(Clone, Debug)]
pub struct Buf {
    /// What it holds, for messages.
    pub name: String,
    /// Its length in `f32`.
    pub len: usize,
    /// Where its values come from.
    pub content: Content,
}

/// Where a buffer's values come from.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    /// The caller writes them, frame by frame.
    Input,
    /// They never change.
    Constant(Vec<f32>),
    /// Steps compute them. They begin as zeros.
    Computed,
}

/// How the values of a picture lie in a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Width and height of the picture.
    pub size: Size,
    /// Channels, row by row in turn.
    pub channels: usize,
    /// Values of one channel side by side: 1, or 4 where a pixel's four values are neighbours.
    pub values: usize,
}

impl Shape {
    /// Rows of single values.
    pub const fn planar(size: Size, channels: usize) -> Self {
        Self { size, channels, values: 1 }
    }

    /// Rows of pixels of four values.
    pub const fn quads(size: Size) -> Self {
        Self { size, channels: 1, values: 4 }
    }

    /// Length in `f32`.
    pub const fn len(self) -> usize {
        self.size.stride() * self.values * self.channels * self.size.height as usize
    }

    /// Whether nothing is in it, which a valid size rules out.
    pub const fn is_empty(self) -> bool {
        self.len() == 0
    }

    /// Column, row and channel of a value.
    pub fn place(self, index: usize) -> [usize; 3] {
        let row = self.size.stride() * self.values;
        let (line, within) = (index / row, index % row);
        [
            within / self.values,
            line / self.channels,
            line % self.channels * self.values + within % self.values,
        ]
    }
}

/// One run of a kernel.
#[derive(Clone)]
pub struct Step {
    /// The kernel.
    pub kernel: &'static Kernel,
    /// What it is done for, for example `level 2, iteration 1`.
    pub label: String,
    /// Bytes of the uniform struct.
    pub params: Vec<u8>,
    /// Buffers read, in the kernel's order.
    pub inputs: Vec<BufId>,
    /// Buffers written, in the kernel's order, and how the result lies in them.
    pub outputs: Vec<(BufId, Shape)>,
    /// Width and height of what is computed.
    pub extent: Size,
}

/// What happens when a frame arrives, for a stream of frames of one size.
///
/// Frames go alternately to parity 0 and 1, so that what was computed of the frame before is still there.
#[derive(Clone)]
pub struct Plan {
    /// The frames' size.
    pub size: Size,
    /// Size of the flow and the confidence.
    pub flow_size: Size,
    /// The buffers.
    pub bufs: Vec<Buf>,
    /// What is computed once, before the first frame.
    pub setup: Vec<Step>,
    /// What is computed of a frame alone, into the buffers of its parity.
    pub ingest: [Vec<Step>; 2],
    /// What is computed of a frame and the one before, by the parity of the later one.
    pub pair: [Vec<Step>; 2],
    /// Where a frame's bytes go.
    pub frame: BufId,
    /// Where a frame's certainty goes, if the plan takes one: a plane.
    pub certainty: Option<BufId>,
    /// Where what is known of the camera's motion goes, if the plan takes it: see
    /// [`Motion`](crate::sphere::Motion).
    pub motion: Option<BufId>,
    /// The flow, two channels, by the parity of the later frame.
    pub flow: [BufId; 2],
    /// Whether a pair begins with what stands in the flow buffer of the other parity.
    pub initial_flow: bool,
    /// The confidence, a plane, if the plan computes it.
    pub confidence: Option<BufId>,
    /// What else is read of a pair, in this order.
    pub fields: Vec<(BufId, Shape)>,
}

impl Plan {
    /// Bytes of all buffers.
    pub fn bytes(&self) -> u64 {
        self.bufs.iter().map(|buf| 4 * buf.len as u64).sum()
    }

    /// A buffer.
    pub fn buf(&self, id: BufId) -> &Buf {
        &self.bufs[id.0]
    }

    /// The steps from the arrival of a frame of the given parity to its flow.
    pub fn steps(&self, parity: usize) -> impl Iterator<Item = &Step> {
        self.ingest[parity].iter().chain(&self.pair[parity])
    }

    /// Checks that the plan does not contradict itself.
    ///
    /// # Errors
    /// [`Error::Kernel`] if a step has another number of buffers than its kernel, writes what it reads, writes an input
    /// or a constant, reads what nothing has filled, or has results that do not fit their buffers.
    pub fn validate(&self) -> Result<()> {
        let mut filled: Vec<bool> = self.bufs.iter().map(|buf| buf.content != Content::Computed).collect();
        for flow in self.flow.iter().filter(|_| self.initial_flow) {
            filled[flow.0] = true;
        }
        let [even, odd] = &self.ingest;
        let order = [&self.setup, even, odd, &self.pair[1], even, &self.pair[0]];
        for step in order.into_iter().flatten() {
            step.validate(&self.bufs, &mut filled)?;
        }
        Ok(())
    }
}

impl Step {
    /// A step. What is computed is as large as the first output.
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

    fn validate(&self, bufs: &[Buf], filled: &mut [bool]) -> Result<()> {
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
                return wrong(format!("{} is an output and something else at once", buf.name));
            }
            if buf.content != Content::Computed {
                return wrong(format!("writes {}, which is not for steps to write", buf.name));
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

/// Collects the buffers of a plan.
#[derive(Debug, Default)]
pub struct Bufs(Vec<Buf>);

impl Bufs {
    /// A buffer that the caller writes.
    pub fn input(&mut self, name: impl Into<String>, len: usize) -> BufId {
        self.add(name, len, Content::Input)
    }

    /// A buffer that never changes.
    pub fn constant(&mut self, name: impl Into<String>, values: Vec<f32>) -> BufId {
        self.add(name, values.len(), Content::Constant(values))
    }

    /// A buffer that steps write.
    pub fn computed(&mut self, name: impl Into<String>, shape: Shape) -> BufId {
        self.add(name, shape.len(), Content::Computed)
    }

    /// All of them.
    pub fn finish(self) -> Vec<Buf> {
        self.0
    }

    fn add(&mut self, name: impl Into<String>, len: usize, content: Content) -> BufId {
        self.0.push(Buf { name: name.into(), len, content });
        BufId(self.0.len() - 1)
    }
}
