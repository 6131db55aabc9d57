//! The face of an estimator of optical flow: what every method gives to a plan.

use crate::error::Result;
use crate::frame::Size;
use crate::plan::{BufId, Bufs, Step};

use super::parameter::Parameters;

/// A method that estimates optical flow, with its parameters.
///
/// It allocates its buffers and builds its steps; it runs nothing. To add one, see `ARCHITECTURE.md`.
pub trait Estimator: Parameters {
    /// Checks every parameter's range.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter), naming the first one that is out of range.
    fn validate(&self) -> Result<()>;

    /// Allocates the buffers for pictures of this size, and returns what builds the steps. Parameters and size are valid.
    fn stages(&self, bufs: &mut Bufs, size: Size, wanted: Wanted) -> Box<dyn Stages>;
}

/// What a plan asks of an estimator beside the flow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wanted {
    /// Whether a pair begins with a given flow in place of no motion.
    pub initial_flow: bool,
    /// Whether each picture comes with a certainty of its pixels, a plane of values from 0 to 1.
    pub certainty: bool,
    /// Whether the confidence of each pixel's flow is computed.
    pub confidence: bool,
    /// Whether the confidence of each cell of the view sphere will be computed from [`Stages::evidence`].
    pub evidence: bool,
}

/// Builds an estimator's steps.
///
/// Pictures go into one of two slots, and the flow leads from the picture in one to that in the other.
pub trait Stages {
    /// What is computed of a gray picture alone, into a slot. `certainty` is a plane, there if it was
    /// [`Wanted`](Wanted::certainty).
    fn ingest(&self, gray: BufId, certainty: Option<BufId>, slot: usize) -> Vec<Step>;

    /// What is computed of the pictures in two slots: `flow`, two channels in pixels, from the first to the second. The
    /// search begins with `initial` if it was [`Wanted`](Wanted::initial_flow); it may be the buffer of `flow` if not.
    fn pair(&self, slots: [usize; 2], initial: BufId, flow: BufId) -> Vec<Step>;

    /// The plane that [`Stages::pair`] fills with the confidence of each pixel's flow, from 0 to 1, if it was
    /// [`Wanted`](Wanted::confidence).
    fn confidence(&self) -> Option<BufId>;

    /// What the confidence of a cell's flow is computed from, if it was [`Wanted`](Wanted::evidence).
    fn evidence(&self, slots: [usize; 2]) -> Evidence;

    /// What one pair leaves for the next, as in [`Plan::carried`](crate::plan::Plan::carried).
    fn carried(&self) -> Vec<[BufId; 2]> {
        Vec::new()
    }
}

/// What the confidence of a cell's flow is computed from.
#[derive(Clone, Copy, Debug)]
pub enum Evidence {
    /// The polynomial expansions of both pictures: the quad and the cross term of the first, then of the second. The
    /// equations are set up anew at a cell's samples, with the flow that was found.
    Expansions([BufId; 4]),
    /// The confidence of each pixel, which is averaged over a cell's samples.
    Confidence(BufId),
}
