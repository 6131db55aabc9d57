//! The expansion of a frame whose pixels have a certainty, by normalised convolution.

use crate::frame::Size;
use crate::kernels::{normalized_expansion_x, normalized_expansion_y, premultiply};
use crate::plan::{BufId, Bufs, Shape, Step};

/// The buffers that are needed only with a certainty.
pub(super) struct Normalized {
    /// The gray image times its certainty, and the certainty clamped to its range.
    weighted: BufId,
    certainty: BufId,
    /// The certainty reduced to a level.
    level: BufId,
    moments: BufId,
    /// The weight of what the border is repeated with outside the image.
    outside: f32,
}

impl Normalized {
    /// Allocates the buffers for images of this size, whose largest level that is expanded has the size `own`.
    pub(super) fn new(bufs: &mut Bufs, size: Size, own: Size, outside: f32) -> Self {
        let plane = Shape::planar(size, 1);
        Self {
            weighted: bufs.computed("weighted gray", plane),
            certainty: bufs.computed("clamped certainty", plane),
            level: bufs.computed("level's certainty", Shape::planar(own, 1)),
            moments: bufs.computed("weighted moments", Shape::planar(own, 8)),
            outside,
        }
    }

    /// The image times its certainty, which is smoothed and reduced for each level.
    pub(super) fn weighted(&self) -> BufId {
        self.weighted
    }

    /// The certainty, which is smoothed and reduced for each level, too.
    pub(super) fn certainty(&self) -> BufId {
        self.certainty
    }

    /// The destination of a level's certainty.
    pub(super) fn level(&self) -> BufId {
        self.level
    }

    /// The step that multiplies a gray image by its certainty.
    pub(super) fn premultiply(&self, gray: BufId, certainty: BufId, size: Size) -> Step {
        let plane = Shape::planar(size, 1);
        Step::new(
            &premultiply::KERNEL,
            "frame",
            premultiply::Params { width: size.width, height: size.height },
            &[gray, certainty],
            &[(self.weighted, plane), (self.certainty, plane)],
        )
    }

    /// The steps that expand a level's image, which is already weighted.
    pub(super) fn expand(
        &self,
        k: usize,
        size: Size,
        radius: u32,
        [image, level, weights_y, weights_x]: [BufId; 4],
        [quad, cross_term, certainty]: [BufId; 3],
    ) -> [Step; 2] {
        let plane = Shape::planar(size, 1);
        [
            Step::new(
                &normalized_expansion_y::KERNEL,
                format!("level {k}"),
                normalized_expansion_y::Params {
                    width: size.width,
                    height: size.height,
                    radius,
                    outside: self.outside,
                },
                &[image, level, weights_y],
                &[(self.moments, Shape::planar(size, 8))],
            ),
            Step::new(
                &normalized_expansion_x::KERNEL,
                format!("level {k}"),
                normalized_expansion_x::Params::new(size, radius, self.outside),
                &[self.moments, weights_x],
                &[(quad, Shape::quads(size)), (cross_term, plane), (certainty, plane)],
            ),
        ]
    }
}
