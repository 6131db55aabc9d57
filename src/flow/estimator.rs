//! The interface of an estimator of optical flow.

use crate::error::Result;
use crate::frame::Size;
use crate::plan::{BufId, Bufs, Step};

use super::parameter::Parameters;

/// A method that estimates optical flow, with its parameters.
///
/// It allocates its buffers and builds its steps; it runs nothing. To add one, see [`flow`](crate::flow).
pub trait Estimator: Parameters {
    /// Whether the flow of a pair depends on the earlier pairs of its stream, by buffers that are
    /// [carried](Stages::carried).
    fn has_memory(&self) -> bool {
        false
    }

    /// The number of frames from which a pair's flow is computed: 2, or more where images of earlier frames are carried. The
    /// first pairs of a stream have fewer.
    fn frames(&self) -> u32 {
        2
    }

    /// Checks every parameter's range.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter), naming the first one that is out of range.
    fn validate(&self) -> Result<()>;

    /// Allocates the buffers for images of this size, and returns the builder of the steps. Parameters and size must be
    /// valid.
    fn stages(&self, bufs: &mut Bufs, size: Size, wanted: Wanted) -> Box<dyn Stages>;
}

/// What a plan requires of an estimator beside the flow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wanted {
    /// Whether the search of a pair begins with a given flow in place of zero motion.
    pub initial_flow: bool,
    /// Whether each image has a certainty of its pixels, a plane of values from 0 to 1.
    pub certainty: bool,
    /// Whether the confidence of each pixel's flow is computed.
    pub confidence: bool,
    /// Whether the flow leads from the later image back to the earlier one.
    pub backward: bool,
    /// Whether the confidence of each cell of the view sphere will be computed from [`Stages::evidence`].
    pub evidence: bool,
}

/// The builder of an estimator's steps.
///
/// Images go into one of two slots, 0 and 1; the flow leads from the image in one slot to the image in the other.
pub trait Stages {
    /// The steps of a gray image alone, into a slot. `gray` is a plane of gray levels; `certainty`, a plane of values
    /// from 0 to 1, is given if it was [`Wanted`](Wanted::certainty).
    fn ingest(&self, gray: BufId, certainty: Option<BufId>, slot: usize) -> Vec<Step>;

    /// The steps of the images in two slots: they compute `flow`, two channels in pixels, from the first to the second.
    /// The search begins with `initial` if it was [`Wanted`](Wanted::initial_flow); otherwise `initial` may be the
    /// buffer of `flow`. `parity` is that of the later image's frame, which chooses among the buffers that are
    /// [carried](Stages::carried).
    fn pair(&self, parity: usize, slots: [usize; 2], initial: BufId, flow: BufId) -> Vec<Step>;

    /// The plane that [`Stages::pair`] fills with the confidence of each pixel's flow, 0 to 1, if it was
    /// [`Wanted`](Wanted::confidence).
    fn confidence(&self) -> Option<BufId>;

    /// The buffers from which the confidence of a cell's flow is computed, if they were [`Wanted`](Wanted::evidence).
    fn evidence(&self, slots: [usize; 2]) -> Evidence;

    /// The buffers that one pair leaves for the next, as in [`Plan::carried`](crate::plan::Plan::carried).
    fn carried(&self) -> Vec<[BufId; 2]> {
        Vec::new()
    }
}

/// The buffers from which the confidence of a cell's flow is computed.
#[derive(Clone, Copy, Debug)]
pub enum Evidence {
    /// The polynomial expansions of both images: the quad and the cross term of the first, then of the second. The
    /// equations are set up again at a cell's samples, with the estimated flow.
    Expansions([BufId; 4]),
    /// The confidence of each pixel, 0 to 1, which is averaged over a cell's samples.
    Confidence(BufId),
}
