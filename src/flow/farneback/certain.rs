//! A frame's expansion where its pixels come with a certainty: by normalised convolution.

use crate::flow::Level;
use crate::frame::Size;
use crate::kernels::{certain_expansion_x, certain_expansion_y, weigh};
use crate::plan::{BufId, Bufs, Shape, Step};

/// The buffers that only a certainty needs.
pub(super) struct Certain {
    /// The gray picture times its certainty, and the certainty within its range.
    weighted: BufId,
    certainty: BufId,
    /// The certainty as a level sees it.
    level: BufId,
    moments: BufId,
    /// Of each level's expansion, finest first, for both slots.
    expansions: Vec<[BufId; 2]>,
}

impl Certain {
    pub(super) fn new(bufs: &mut Bufs, size: Size, levels: &[Level]) -> Self {
        let plane = Shape::planar(size, 1);
        let expansion = |bufs: &mut Bufs, k: usize, level: &Level, slot: &str| {
            bufs.computed(format!("certainty, level {k}, {slot} frames"), Shape::planar(level.size, 1))
        };
        Self {
            weighted: bufs.computed("gray times certainty", plane),
            certainty: bufs.computed("certainty in its range", plane),
            level: bufs.computed("level's certainty", plane),
            moments: bufs.computed("moments with certainty", Shape::planar(size, 8)),
            expansions: (levels.iter().enumerate())
                .map(|(k, level)| ["even", "odd"].map(|slot| expansion(bufs, k, level, slot)))
                .collect(),
        }
    }

    /// What is smoothed and reduced for each level, and where to, if the level's image is to be in `image`.
    pub(super) fn pictures(&self, image: BufId) -> Vec<[BufId; 2]> {
        vec![[self.weighted, image], [self.certainty, self.level]]
    }

    /// Where the certainty of a level's expansion lies.
    pub(super) fn expansion(&self, k: usize, slot: usize) -> BufId {
        self.expansions[k][slot]
    }

    /// A gray picture times its certainty.
    pub(super) fn weigh(&self, gray: BufId, certainty: BufId, size: Size) -> Step {
        let plane = Shape::planar(size, 1);
        Step::new(
            &weigh::KERNEL,
            "frame",
            weigh::Params { width: size.width, height: size.height },
            &[gray, certainty],
            &[(self.weighted, plane), (self.certainty, plane)],
        )
    }

    /// The expansion of a level's image, which is weighted already.
    pub(super) fn expand(
        &self,
        k: usize,
        size: Size,
        radius: u32,
        [image, weights_y, weights_x]: [BufId; 3],
        [quad, cross_term, certainty]: [BufId; 3],
    ) -> [Step; 2] {
        let plane = Shape::planar(size, 1);
        [
            Step::new(
                &certain_expansion_y::KERNEL,
                format!("level {k}"),
                certain_expansion_y::Params { width: size.width, height: size.height, radius },
                &[image, self.level, weights_y],
                &[(self.moments, Shape::planar(size, 8))],
            ),
            Step::new(
                &certain_expansion_x::KERNEL,
                format!("level {k}"),
                certain_expansion_x::Params::new(size, radius),
                &[self.moments, weights_x],
                &[(quad, Shape::quads(size)), (cross_term, plane), (certainty, plane)],
            ),
        ]
    }
}
