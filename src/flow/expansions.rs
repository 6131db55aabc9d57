//! The steps of one frame alone: its pyramid, and the polynomial expansion of each level.

use super::Level;
use super::normalized::Normalized;
use super::pyramid::Pyramid;
use crate::frame::Size;
use crate::kernels::tables::{self, Applicability};
use crate::kernels::{expansion_x, expansion_y};
use crate::plan::{BufId, Bufs, Shape, Step};

/// The buffers of a level's expansion `f(x) ≈ xᵀA x + bᵀx + c`.
#[derive(Clone, Copy)]
pub(super) struct Expansion {
    /// b_x, b_y, A_xx, A_yy of each pixel.
    pub(super) quad: BufId,
    /// 2 A_xy of each pixel.
    pub(super) cross_term: BufId,
    /// Its certainty, if frames have a certainty.
    pub(super) certainty: Option<BufId>,
}

/// What of an image is expanded, and how.
#[derive(Clone, Copy)]
pub(super) struct Expanded {
    /// Radius of the neighbourhood in pixels.
    pub(super) poly_n: u32,
    /// Standard deviation of its Gaussian in pixels.
    pub(super) poly_sigma: f64,
    /// Whether the finest level is the image as it is; otherwise it is smoothed, as OpenCV does.
    pub(super) unsmoothed: bool,
    /// The finest levels that are left out.
    pub(super) skip: usize,
    /// The number of finest levels, from `skip` on, whose images are kept beside their expansions.
    pub(super) kept_images: usize,
    /// The weight of the border's repetition outside, with a certainty: 1, or 0 to count only pixels of the image.
    pub(super) outside: f32,
}

impl Default for Expanded {
    fn default() -> Self {
        Self { poly_n: 5, poly_sigma: 1.2, unsmoothed: false, skip: 0, kept_images: 0, outside: 1.0 }
    }
}

/// The buffers of this part of the plan.
pub(super) struct Expansions {
    /// For each level, finest first, the kept images of both slots.
    pub(super) images: Vec<Option<[BufId; 2]>>,
    expanded: Expanded,
    /// For each level that is expanded, finest first, the expansions in both slots.
    levels: Vec<Option<[Expansion; 2]>>,
    /// The further buffers that a certainty needs.
    pub(super) normalized: Option<Normalized>,
    size: Size,
    radius: u32,
    applicability: Applicability,
    weights_y: BufId,
    weights_x: BufId,
    /// The image of a level that is not kept; `None` if all are.
    image: Option<BufId>,
    /// The tables of the expansion without certainty.
    moments: Option<BufId>,
    pyramid: Pyramid,
    sizes: Vec<Size>,
}

impl Expansions {
    pub(super) fn new(
        bufs: &mut Bufs,
        expanded: Expanded,
        size: Size,
        levels: &[Level],
        certainty: bool,
    ) -> Self {
        let Expanded { poly_n, poly_sigma, skip, kept_images, .. } = expanded;
        let applicability = tables::applicability(poly_n, poly_sigma);
        // The largest level that is expanded.
        let own = levels[skip].size;
        let is_reduced = |k: usize| k > 0 || !expanded.unsmoothed;
        let unkept = (skip + kept_images..levels.len()).find(|k| is_reduced(*k));
        let normalized = certainty.then(|| Normalized::new(bufs, size, own, expanded.outside));
        let expansion = |bufs: &mut Bufs, k: usize, level: &Level, slot: usize| {
            let frames = ["even frames", "odd frames"][slot];
            Expansion {
                quad: bufs.computed(format!("quad, level {k}, {frames}"), Shape::quads(level.size)),
                cross_term: bufs
                    .computed(format!("cross term, level {k}, {frames}"), Shape::planar(level.size, 1)),
                certainty: certainty.then(|| {
                    bufs.computed(format!("certainty, level {k}, {frames}"), Shape::planar(level.size, 1))
                }),
            }
        };
        let images = levels.iter().enumerate().map(|(k, level)| {
            let image = |bufs: &mut Bufs, slot: &str| {
                bufs.computed(format!("image, level {k}, {slot} frames"), Shape::planar(level.size, 1))
            };
            (skip..skip + kept_images).contains(&k).then(|| ["even", "odd"].map(|slot| image(bufs, slot)))
        });
        Self {
            images: images.collect(),
            expanded,
            levels: levels
                .iter()
                .enumerate()
                .map(|(k, level)| (k >= skip).then(|| [0, 1].map(|slot| expansion(bufs, k, level, slot))))
                .collect(),
            size,
            radius: poly_n,
            weights_y: bufs.constant(
                "applicability, columns",
                tables::applicability_from(&applicability.weights, poly_n as usize),
            ),
            weights_x: bufs.constant(
                "applicability, rows",
                tables::applicability_from(&applicability.weights, (poly_n as usize).next_multiple_of(4)),
            ),
            applicability,
            image: unkept.map(|k| bufs.computed("level's image", Shape::planar(levels[k].size, 1))),
            moments: normalized.is_none().then(|| bufs.computed("moments", Shape::planar(own, 3))),
            normalized,
            pyramid: Pyramid::new(bufs, size, levels, |k| k >= skip),
            sizes: levels.iter().map(|level| level.size).collect(),
        }
    }

    /// The expansion of level `k`, which is not left out, in a slot.
    pub(super) fn level(&self, k: usize, slot: usize) -> Expansion {
        match self.levels[k] {
            Some(slots) => slots[slot],
            None => unreachable!("level {k} is left out"),
        }
    }

    /// The steps that expand a gray image into this slot. Its certainty is required if the estimator takes one.
    pub(super) fn steps(&self, gray: BufId, certainty: Option<BufId>, slot: usize) -> Vec<Step> {
        let mut steps = Vec::new();
        let pictures = match (&self.normalized, certainty) {
            (Some(normalized), Some(certainty)) => {
                steps.push(normalized.premultiply(gray, certainty, self.size));
                vec![(normalized.weighted(), self.image), (normalized.certainty(), Some(normalized.level()))]
            }
            _ => vec![(gray, self.image)],
        };
        for (k, size) in self.sizes.iter().enumerate().skip(self.expanded.skip) {
            let mut images = Vec::new();
            for (i, &(full, image)) in pictures.iter().enumerate() {
                let kept = self.images[k].map(|images| images[slot]).filter(|_| i == 0);
                let is_full = k == 0 && self.expanded.unsmoothed;
                let reduced = if is_full { kept } else { kept.or(image) };
                if let Some(reduced) = reduced {
                    self.pyramid.reduce(&mut steps, k, full, reduced);
                }
                images.extend(if is_full { Some(full) } else { reduced });
            }
            self.expand(&mut steps, k, *size, slot, &images);
        }
        steps
    }

    /// The polynomial expansion of a level's image, the first of `images`; the second is its certainty, if frames have one.
    fn expand(&self, steps: &mut Vec<Step>, k: usize, size: Size, slot: usize, images: &[BufId]) {
        let Expansion { quad, cross_term, certainty } = self.level(k, slot);
        if let (Some(normalized), Some(certainty)) = (&self.normalized, certainty) {
            let inputs = [images[0], images[1], self.weights_y, self.weights_x];
            steps.extend(normalized.expand(k, size, self.radius, inputs, [quad, cross_term, certainty]));
        }
        let Some(moments) = self.moments else { return };
        steps.push(Step::new(
            &expansion_y::KERNEL,
            format!("level {k}"),
            expansion_y::Params { width: size.width, height: size.height, radius: self.radius },
            &[images[0], self.weights_y],
            &[(moments, Shape::planar(size, 3))],
        ));
        steps.push(Step::new(
            &expansion_x::KERNEL,
            format!("level {k}"),
            expansion_x::Params::new(size, self.radius, &self.applicability),
            &[moments, self.weights_x],
            &[(quad, Shape::quads(size)), (cross_term, Shape::planar(size, 1))],
        ));
    }
}
