//! The gray images of both slots on every level of a pyramid, with the certainty of their pixels.

use super::pyramid::Pyramid;
use super::{Level, Wanted};
use crate::frame::Size;
use crate::kernels::{premultiply, unweight};
use crate::plan::{BufId, Bufs, Shape, Step};

/// The images of both slots on every level, finest first.
pub(super) struct Images {
    levels: Vec<Level>,
    /// The number of the finest level that is computed.
    finest: usize,
    pyramid: Pyramid,
    /// For each level the buffers of both slots.
    images: Vec<[BufId; 2]>,
    certainty: Certainty,
}

enum Certainty {
    /// A certainty of 1 everywhere, for images without one.
    Full(BufId),
    Given(Weighted),
}

/// The buffers that are needed only with a certainty.
struct Weighted {
    /// The image times its certainty, and the certainty clamped to its range.
    full: [BufId; 2],
    level: BufId,
    /// For each level the buffers of both slots.
    certainties: Vec<[BufId; 2]>,
}

/// One level of one image.
#[derive(Clone, Copy)]
pub(super) struct LevelImage {
    pub(super) gray: BufId,
    pub(super) certainty: BufId,
}

impl Images {
    /// Allocates the buffers for images of this size and these levels, finest first, of which the first `finest` are left
    /// out.
    pub(super) fn new(bufs: &mut Bufs, size: Size, levels: &[Level], finest: usize, wanted: Wanted) -> Self {
        let plane = Shape::planar(size, 1);
        let of_levels = |bufs: &mut Bufs, name: &str| -> Vec<[BufId; 2]> {
            let image = |bufs: &mut Bufs, k: usize, level: &Level, frames: &str| {
                bufs.computed(format!("{name}, level {k}, {frames} frames"), Shape::planar(level.size, 1))
            };
            let level = |(k, level)| ["even", "odd"].map(|frames| image(bufs, k, level, frames));
            levels.iter().enumerate().map(level).collect()
        };
        Self {
            levels: levels.to_vec(),
            finest,
            pyramid: Pyramid::new(bufs, size, levels),
            images: of_levels(bufs, "image"),
            certainty: if wanted.certainty {
                Certainty::Given(Weighted {
                    full: [bufs.computed("weighted gray", plane), bufs.computed("clamped certainty", plane)],
                    level: bufs.computed("level's weighted image", plane),
                    certainties: of_levels(bufs, "certainty"),
                })
            } else {
                Certainty::Full(bufs.constant("full certainty", vec![1.0; plane.len()]))
            },
        }
    }

    /// The image of a slot on level `k`.
    pub(super) fn level(&self, k: usize, slot: usize) -> LevelImage {
        let certainty = match &self.certainty {
            Certainty::Full(full) => *full,
            Certainty::Given(weighted) => weighted.certainties[k][slot],
        };
        LevelImage { gray: self.images[k][slot], certainty }
    }

    /// The steps that reduce an image to all levels of a slot. With a certainty only known pixels count.
    pub(super) fn steps(&self, gray: BufId, certainty: Option<BufId>, slot: usize) -> Vec<Step> {
        let mut steps = Vec::new();
        let (Certainty::Given(weighted), Some(certainty)) = (&self.certainty, certainty) else {
            for (k, images) in self.images.iter().enumerate().skip(self.finest) {
                self.pyramid.reduce(&mut steps, k, gray, images[slot]);
            }
            return steps;
        };
        let size = self.levels[0].size;
        let [full, share] = weighted.full;
        steps.push(Step::new(
            &premultiply::KERNEL,
            "frame",
            premultiply::Params { width: size.width, height: size.height },
            &[gray, certainty],
            &[(full, Shape::planar(size, 1)), (share, Shape::planar(size, 1))],
        ));
        for (k, images) in self.images.iter().enumerate().skip(self.finest) {
            let size = self.levels[k].size;
            let of_level = weighted.certainties[k][slot];
            self.pyramid.reduce(&mut steps, k, full, weighted.level);
            self.pyramid.reduce(&mut steps, k, share, of_level);
            steps.push(Step::new(
                &unweight::KERNEL,
                format!("level {k}"),
                unweight::Params { width: size.width, height: size.height },
                &[weighted.level, of_level],
                &[(images[slot], Shape::planar(size, 1))],
            ));
        }
        steps
    }
}
