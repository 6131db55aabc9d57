//! What is to be computed of a frame.

use crate::plan::Plan;

/// What is to be computed of a frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Job {
    /// The buffers that the frame goes to.
    pub(super) parity: usize,
    /// Whether there is a previous frame.
    pub(super) pair: bool,
    /// Whether the previous pair has left something for it.
    pub(super) carried: bool,
    /// Whether the host has replaced what the previous pair has left.
    pub(super) replaced: bool,
}

impl Job {
    /// Steps from the beginning of [`Plan::steps`].
    pub(super) fn steps(self, plan: &Plan) -> usize {
        plan.ingest[self.parity].len() + if self.pair { plan.pair[self.parity].len() } else { 0 }
    }

    /// Whether the buffers that carry from frame to frame have to be cleared for it.
    pub(super) fn clears(self) -> bool {
        self.pair && !self.carried
    }
}
