//! The expansion of a frame whose pixels have a certainty, by normalised convolution.

use super::Level;
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
    /// The certainty of each level's expansion, finest first, in both slots.
    expansions: Vec<[BufId; 2]>,
    /// The weight of what the border is repeated with outside the image.
    outside: f32,
}

impl Normalized {
    pub(super) fn new(bufs: &mut Bufs, size: Size, levels: &[Level], outside: f32) -> Self {
        let plane = Shape::planar(size, 1);
        let expansion = |bufs: &mut Bufs, k: usize, level: &Level, slot: &str| {
            bufs.computed(format!("certainty, level {k}, {slot} frames"), Shape::planar(level.size, 1))
        };
        Self {
            weighted: bufs.computed("weighted gray", plane),
            certainty: bufs.computed("clamped certainty", plane),
            level: bufs.computed("level's certainty", plane),
            moments: bufs.computed("weighted moments", Shape::planar(size, 8)),
            expansions: (levels.iter().enumerate())
                .map(|(k, level)| ["even", "odd"].map(|slot| expansion(bufs, k, level, slot)))
                .collect(),
            outside,
        }
    }

    /// The images that are smoothed and reduced for each level, and their destinations, with the level's image in
    /// `image`.
    pub(super) fn pictures(&self, image: BufId) -> Vec<[BufId; 2]> {
        vec![[self.weighted, image], [self.certainty, self.level]]
    }

    /// The buffer of the certainty of a level's expansion.
    pub(super) fn expansion(&self, k: usize, slot: usize) -> BufId {
        self.expansions[k][slot]
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
