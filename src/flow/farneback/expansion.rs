//! The steps of one frame alone: its pyramid, and the polynomial expansion of each level.

use super::Farneback;
use super::normalized::Normalized;
use crate::flow::Level;
use crate::flow::pyramid::Pyramid;
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

/// The buffers of this part of the plan.
pub(super) struct Expansions {
    /// For each level, finest first, the expansions in both slots.
    pub(super) levels: Vec<[Expansion; 2]>,
    /// The further buffers that a certainty needs.
    pub(super) normalized: Option<Normalized>,
    size: Size,
    radius: u32,
    applicability: Applicability,
    weights_y: BufId,
    weights_x: BufId,
    image: BufId,
    /// The tables of the expansion without certainty.
    moments: Option<BufId>,
    pyramid: Pyramid,
    sizes: Vec<Size>,
}

impl Expansions {
    pub(super) fn new(bufs: &mut Bufs, config: &Farneback, size: Size, levels: &[Level], certainty: bool) -> Self {
        let applicability = tables::applicability(config.poly_n, config.poly_sigma);
        let normalized = certainty.then(|| Normalized::new(bufs, size, levels));
        let expansion = |bufs: &mut Bufs, k: usize, level: &Level, slot: usize| {
            let frames = ["even frames", "odd frames"][slot];
            Expansion {
                quad: bufs.computed(format!("quad, level {k}, {frames}"), Shape::quads(level.size)),
                cross_term: bufs
                    .computed(format!("cross term, level {k}, {frames}"), Shape::planar(level.size, 1)),
                certainty: normalized.as_ref().map(|normalized| normalized.expansion(k, slot)),
            }
        };
        Self {
            levels: levels
                .iter()
                .enumerate()
                .map(|(k, level)| [0, 1].map(|slot| expansion(bufs, k, level, slot)))
                .collect(),
            size,
            radius: config.poly_n,
            weights_y: bufs.constant(
                "applicability, columns",
                tables::applicability_from(&applicability.weights, config.poly_n as usize),
            ),
            weights_x: bufs.constant(
                "applicability, rows",
                tables::applicability_from(
                    &applicability.weights,
                    (config.poly_n as usize).next_multiple_of(4),
                ),
            ),
            applicability,
            image: bufs.computed("level's image", Shape::planar(size, 1)),
            moments: normalized.is_none().then(|| bufs.computed("moments", Shape::planar(size, 3))),
            normalized,
            pyramid: Pyramid::new(bufs, size, levels),
            sizes: levels.iter().map(|level| level.size).collect(),
        }
    }

    /// The steps that expand a gray image into this slot. Its certainty is required if the estimator takes one.
    pub(super) fn steps(&self, gray: BufId, certainty: Option<BufId>, slot: usize) -> Vec<Step> {
        let mut steps = Vec::new();
        let pictures = match (&self.normalized, certainty) {
            (Some(normalized), Some(certainty)) => {
                steps.push(normalized.premultiply(gray, certainty, self.size));
                normalized.pictures(self.image)
            }
            _ => vec![[gray, self.image]],
        };
        for (k, size) in self.sizes.iter().enumerate() {
            for &[full, image] in &pictures {
                self.pyramid.reduce(&mut steps, k, full, image);
            }
            self.expand(&mut steps, k, *size, slot);
        }
        steps
    }

    /// The polynomial expansion of a level's image.
    fn expand(&self, steps: &mut Vec<Step>, k: usize, size: Size, slot: usize) {
        let Expansion { quad, cross_term, certainty } = self.levels[k][slot];
        if let (Some(normalized), Some(certainty)) = (&self.normalized, certainty) {
            let inputs = [self.image, self.weights_y, self.weights_x];
            steps.extend(normalized.expand(k, size, self.radius, inputs, [quad, cross_term, certainty]));
        }
        let Some(moments) = self.moments else { return };
        steps.push(Step::new(
            &expansion_y::KERNEL,
            format!("level {k}"),
            expansion_y::Params { width: size.width, height: size.height, radius: self.radius },
            &[self.image, self.weights_y],
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
