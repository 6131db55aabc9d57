//! What is to be done of a frame, and room for what comes of it.

use super::layout::Layout;
use crate::frame::{FlowField, Plane};
use crate::plan::Plan;

/// What a pair begins with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Begin {
    /// What stands in the buffer: the flow of the pair before, or nothing that is read.
    Kept,
    /// No motion.
    Zero,
    /// The flow that came with the frame.
    Given,
}

/// What is to be done of a frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Job {
    /// The buffers that the frame goes to.
    pub(super) parity: usize,
    /// Whether there is a frame before it.
    pub(super) pair: bool,
    pub(super) begin: Begin,
}

impl Job {
    /// Steps from the beginning of [`Plan::steps`].
    pub(super) fn steps(self, plan: &Plan) -> usize {
        plan.ingest[self.parity].len() + if self.pair { plan.pair[self.parity].len() } else { 0 }
    }
}

/// What comes of a pair, on the host. What is not read is empty.
pub(super) struct Results {
    pub(super) flow: FlowField,
    pub(super) confidence: Plane,
    /// The plan's fields.
    pub(super) fields: Vec<Vec<f32>>,
}

impl Results {
    pub(super) fn new(layout: &Layout, plan: &Plan) -> Self {
        let size = layout.flow_size;
        let pixels = |wanted: usize| if wanted > 0 { size.pixels() } else { 0 };
        Self {
            flow: FlowField { size, data: vec![[0.0; 2]; pixels(layout.flow)] },
            confidence: Plane { size, data: vec![0.0; pixels(layout.confidence)] },
            fields: plan.fields.iter().map(|(_, shape)| vec![0.0; shape.len()]).collect(),
        }
    }
}
