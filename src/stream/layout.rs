//! The layout of a plan's ports in the memory of a frame in flight.

use std::ops::Range;

use crate::plan::{Fill, Given, Plan, Port};

/// The offsets of all inputs and outputs, one after the other, in `f32`.
pub(super) struct Layout {
    pub(super) inputs: Vec<Input>,
    pub(super) outputs: Vec<Range<usize>>,
}

/// An input of the plan.
pub(super) struct Input {
    pub(super) place: Range<usize>,
    /// Whether a run overwrites the values that the host has written to its buffer.
    pub(super) overwritten: bool,
    /// Whether its buffers are carried from frame to frame.
    pub(super) carried: bool,
}

impl Layout {
    pub(super) fn new(plan: &Plan) -> Self {
        let inputs = places(&plan.inputs).zip(&plan.inputs).map(|(place, port)| Input {
            place,
            overwritten: port.bufs.iter().any(|id| plan.writes(*id)),
            carried: plan.carried.contains(&port.bufs),
        });
        Self { inputs: inputs.collect(), outputs: places(&plan.outputs).collect() }
    }

    /// Number of values written per frame.
    pub(super) fn upload(&self) -> usize {
        self.inputs.last().map_or(0, |input| input.place.end)
    }

    /// Number of values read per pair.
    pub(super) fn readback(&self) -> usize {
        self.outputs.last().map_or(0, |place| place.end)
    }

    /// Whether the host replaces the values that the previous frame has left.
    pub(super) fn replaces_carried(&self, plan: &Plan, given: &[Given<'_>]) -> bool {
        plan.inputs.iter().zip(&self.inputs).any(|(port, input)| input.carried && port.among(given).is_some())
    }
}

fn places(ports: &[Port]) -> impl Iterator<Item = Range<usize>> {
    ports.iter().scan(0, |end, port| {
        let start = *end;
        *end += port.kind.len();
        Some(start..*end)
    })
}

/// The contents of an input's buffers, by parity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Held {
    /// Unknown.
    #[default]
    Other,
    /// The values of [`Port::if_absent`].
    Fill,
}

/// The contents of every input's buffers, so that values that are there already are not written again.
pub(super) struct Holdings(Vec<[Held; 2]>);

impl Holdings {
    pub(super) fn new(plan: &Plan) -> Self {
        Self(vec![[Held::Other; 2]; plan.inputs.len()])
    }

    /// The values to write to an input for a frame; from then on they count as written.
    pub(super) fn write(
        &mut self,
        index: usize,
        port: &Port,
        input: &Input,
        parity: usize,
        given: bool,
    ) -> Write {
        let shared = port.bufs[0] == port.bufs[1];
        let both: &mut [Held] = if shared { &mut self.0[index] } else { &mut self.0[index][parity..=parity] };
        let there = !input.overwritten && both.iter().all(|held| *held == Held::Fill);
        both.fill(if given { Held::Other } else { Held::Fill });
        match port.if_absent {
            _ if given => Write::Given,
            Fill::Keep => Write::Nothing,
            _ if there => Write::Nothing,
            Fill::Value(value) if value.to_bits() == 0 => Write::Zeros,
            _ => Write::Fill,
        }
    }
}

/// The values to write to an input's buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Write {
    Nothing,
    Zeros,
    Fill,
    Given,
}
