//! The gray images of both slots on every level of a pyramid, with the certainty of their pixels.

use super::pyramid::Pyramid;
use super::{Level, Wanted};
use crate::frame::Size;
use crate::kernels::{premultiply, unweight};
use crate::plan::{BufId, Bufs, Shape, Step};

/// The images of both slots on every level, finest first.
pub(super) struct Images {
    levels: Vec<Level>,
    pyramid: Pyramid,
    /// For each level that is computed the buffers of both slots.
    images: Vec<Option<[BufId; 2]>>,
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
    /// For each level that is computed the buffers of both slots.
    certainties: Vec<Option<[BufId; 2]>>,
}

/// One level of one image.
#[derive(Clone, Copy)]
pub(super) struct LevelImage {
    pub(super) gray: BufId,
    pub(super) certainty: BufId,
}

impl Images {
    /// Allocates the buffers for images of this size and these levels, finest first, of which those that `is_used` tells
    /// are computed: at least one.
    pub(super) fn new(
        bufs: &mut Bufs,
        size: Size,
        levels: &[Level],
        is_used: impl Fn(usize) -> bool,
        wanted: Wanted,
    ) -> Self {
        let plane = Shape::planar(size, 1);
        let finest = (0..levels.len()).find(|k| is_used(*k)).unwrap_or(0);
        let largest = Shape::planar(levels[finest].size, 1);
        let of_levels = |bufs: &mut Bufs, name: &str| -> Vec<Option<[BufId; 2]>> {
            let image = |bufs: &mut Bufs, k: usize, frames: &str| {
                let shape = Shape::planar(levels[k].size, 1);
                bufs.computed(format!("{name}, level {k}, {frames} frames"), shape)
            };
            let level = |k| is_used(k).then(|| ["even", "odd"].map(|frames| image(bufs, k, frames)));
            (0..levels.len()).map(level).collect()
        };
        Self {
            levels: levels.to_vec(),
            pyramid: Pyramid::new(bufs, size, levels, &is_used),
            images: of_levels(bufs, "image"),
            certainty: if wanted.certainty {
                Certainty::Given(Weighted {
                    full: [bufs.computed("weighted gray", plane), bufs.computed("clamped certainty", plane)],
                    level: bufs.computed("level's weighted image", largest),
                    certainties: of_levels(bufs, "certainty"),
                })
            } else {
                Certainty::Full(bufs.constant("full certainty", vec![1.0; largest.len()]))
            },
        }
    }

    /// The image of a slot on level `k`, which is computed.
    pub(super) fn level(&self, k: usize, slot: usize) -> LevelImage {
        let computed = |images: &[Option<[BufId; 2]>]| match images[k] {
            Some(slots) => slots[slot],
            None => unreachable!("level {k} is not computed"),
        };
        let certainty = match &self.certainty {
            Certainty::Full(full) => *full,
            Certainty::Given(weighted) => computed(&weighted.certainties),
        };
        LevelImage { gray: computed(&self.images), certainty }
    }

    /// The numbers of the levels that are computed.
    fn computed(&self) -> impl Iterator<Item = usize> {
        (0..self.images.len()).filter(|k| self.images[*k].is_some())
    }

    /// The steps that reduce an image to all levels of a slot. With a certainty only known pixels count.
    pub(super) fn steps(&self, gray: BufId, certainty: Option<BufId>, slot: usize) -> Vec<Step> {
        let mut steps = Vec::new();
        let (Certainty::Given(weighted), Some(certainty)) = (&self.certainty, certainty) else {
            for k in self.computed() {
                self.pyramid.reduce(&mut steps, k, gray, self.level(k, slot).gray);
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
        for k in self.computed() {
            let size = self.levels[k].size;
            let LevelImage { gray, certainty } = self.level(k, slot);
            self.pyramid.reduce(&mut steps, k, full, weighted.level);
            self.pyramid.reduce(&mut steps, k, share, certainty);
            steps.push(Step::new(
                &unweight::KERNEL,
                format!("level {k}"),
                unweight::Params { width: size.width, height: size.height },
                &[weighted.level, certainty],
                &[(gray, Shape::planar(size, 1))],
            ));
        }
        steps
    }
}
