//! The computation of a frame: which parity, which steps, which buffers to clear.

use crate::plan::Plan;

/// The computation of a frame: which parity, which steps, which buffers to clear.
#[derive(Clone, Copy, Debug)]
pub(super) struct Job {
    /// The parity of the buffers that the frame uses.
    pub(super) parity: usize,
    /// Whether there is a previous frame.
    pub(super) pair: bool,
    /// Whether the previous pair has left values for it.
    pub(super) carried: bool,
    /// Whether the host has replaced the values that the previous pair has left.
    pub(super) replaced: bool,
}

impl Job {
    /// The number of steps, from the beginning of [`Plan::steps`].
    pub(super) fn steps(self, plan: &Plan) -> usize {
        plan.ingest[self.parity].len() + if self.pair { plan.pair[self.parity].len() } else { 0 }
    }

    /// Whether the carried buffers must be cleared for it.
    pub(super) fn clears(self) -> bool {
        self.pair && !self.carried
    }
}
