//! A frame's computation as data: buffers, the steps that fill them, and the ports by which the host writes and reads
//! them. No GPU and no loop over pixels.

mod buf;
mod outputs;
pub(crate) mod pack;
mod port;
mod step;

pub use buf::{Buf, BufId, Bufs, Content, Shape};
pub use outputs::Outputs;
pub use port::{Fill, Given, Port, PortKind, Value};
pub use step::Step;

use crate::error::{Error, Result};
use crate::frame::Size;

/// The computation of each frame of a stream: buffers, steps and ports, for frames of one size.
///
/// Frames go alternately to parity 0 and 1, so that the results of the previous frame are still there.
#[derive(Clone)]
pub struct Plan {
    /// The size of the frames, for messages.
    pub size: Size,
    /// The buffers.
    pub bufs: Vec<Buf>,
    /// The setup: steps that run once, before the first frame.
    pub setup: Vec<Step>,
    /// The steps of a frame alone, into the buffers of its parity: index 0 for parity 0, index 1 for parity 1.
    pub ingest: [Vec<Step>; 2],
    /// The steps of a frame and the previous one, by the parity of the later one.
    pub pair: [Vec<Step>; 2],
    /// The ports that the host may write before a run. Parities that share a buffer share its values.
    pub inputs: Vec<Port>,
    /// The ports that the host reads after a run of the pair, or of a plan without pairs.
    pub outputs: Vec<Port>,
    /// Buffers in which a pair finds the values that the previous pair has left for it, by the parity of the pair that
    /// reads them. They are zero at the start of a stream, after a reset and after a loss. A pair must not write the
    /// buffer that it reads.
    pub carried: Vec<[BufId; 2]>,
}

impl Plan {
    /// A plan for single images: its steps are those of parity 0, and there are no pairs.
    pub fn single(
        size: Size,
        bufs: Vec<Buf>,
        steps: Vec<Step>,
        inputs: Vec<Port>,
        outputs: Vec<Port>,
    ) -> Self {
        let (setup, pair, carried) = (Vec::new(), [Vec::new(), Vec::new()], Vec::new());
        Self { size, bufs, setup, ingest: [steps, Vec::new()], pair, inputs, outputs, carried }
    }

    /// Total size of all buffers in bytes.
    pub fn bytes(&self) -> u64 {
        self.bufs.iter().map(|buf| 4 * buf.len as u64).sum()
    }

    /// The buffer with this number.
    pub fn buf(&self, id: BufId) -> &Buf {
        &self.bufs[id.0]
    }

    /// All steps for a frame of this parity: those of the frame alone, then those of the pair.
    pub fn steps(&self, parity: usize) -> impl Iterator<Item = &Step> {
        self.ingest[parity].iter().chain(&self.pair[parity])
    }

    /// The index of the input of this name in [`Plan::inputs`].
    pub fn input(&self, name: &str) -> Option<usize> {
        self.inputs.iter().position(|port| port.name == name)
    }

    /// The output port of this name.
    pub fn output(&self, name: &str) -> Option<&Port> {
        self.outputs.iter().find(|port| port.name == name)
    }

    /// Checks the host's values against the inputs, and calls `f` with each input's index and its value.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a value without an input of its name, and for a required input without a value; as
    /// [`Port::check`] for one that does not fit.
    pub fn check(&self, given: &[Given<'_>]) -> Result<()> {
        for (name, value) in given.iter().filter_map(|(name, value)| Some((*name, value.as_ref()?))) {
            let input = self.input(name).map(|index| &self.inputs[index]);
            input
                .ok_or_else(|| Error::parameter(name, "given", "nothing, as the plan has no such input"))?
                .check(value)?;
        }
        let missing =
            self.inputs.iter().find(|port| port.if_absent == Fill::Required && port.among(given).is_none());
        match missing {
            Some(port) => Err(Error::parameter(port.name, "missing", "a value for every frame")),
            None => Ok(()),
        }
    }

    /// Whether a step writes the buffer, so that the host's values do not stay.
    pub(crate) fn writes(&self, id: BufId) -> bool {
        let all = [&self.setup, &self.ingest[0], &self.ingest[1], &self.pair[0], &self.pair[1]];
        all.into_iter().flatten().any(|step| step.outputs.iter().any(|(output, _)| *output == id))
    }

    /// Checks that the plan is consistent.
    ///
    /// # Errors
    /// [`Error::Kernel`] if a step has another number of buffers than its kernel, writes what it reads, writes an input
    /// or a constant, reads a buffer that nothing has filled, or has results that do not fit their buffers; or if a
    /// port is larger than its buffer, or two ports have the same name.
    pub fn validate(&self) -> Result<()> {
        let mut filled: Vec<bool> = self.bufs.iter().map(|buf| buf.content != Content::Computed).collect();
        let by_host = self.inputs.iter().map(|port| port.bufs).chain(self.carried.iter().copied());
        by_host.flatten().for_each(|id| filled[id.0] = true);
        let [even, odd] = &self.ingest;
        let order = [&self.setup, even, odd, &self.pair[1], even, &self.pair[0]];
        for step in order.into_iter().flatten() {
            step.validate(&self.bufs, &mut filled)?;
        }
        let wrong = |port: &Port, problem: String| {
            Err(Error::Kernel { kernel: format!("port {}", port.name), problem })
        };
        for ports in [&self.inputs, &self.outputs] {
            for (i, port) in ports.iter().enumerate() {
                if ports[..i].iter().any(|other| other.name == port.name) {
                    return wrong(port, "two ports have this name".to_owned());
                }
                let len = match &port.if_absent {
                    Fill::Values(values) => values.len().max(port.kind.len()),
                    _ => port.kind.len(),
                };
                if let Some(id) = port.bufs.into_iter().find(|id| self.buf(*id).len < len) {
                    let Buf { name, len: room, .. } = self.buf(id);
                    return wrong(port, format!("{name} holds {room} values, the port has {len}"));
                }
            }
        }
        if let Some(port) = self.outputs.iter().find(|port| port.bufs.iter().any(|id| !filled[id.0])) {
            return wrong(port, "it is read, but nothing has filled it".to_owned());
        }
        Ok(())
    }
}
