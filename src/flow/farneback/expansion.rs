//! What is computed of one frame alone: its pyramid, and each level's polynomial expansion.

use super::Farneback;
use super::certain::Certain;
use crate::flow::Level;
use crate::flow::pyramid::Pyramid;
use crate::frame::Size;
use crate::kernels::tables::{self, Applicability};
use crate::kernels::{expansion_x, expansion_y};
use crate::plan::{BufId, Bufs, Shape, Step};

/// Where a level's expansion lies: `f(x) ≈ xᵀA x + bᵀx + c`.
#[derive(Clone, Copy)]
pub(super) struct Expansion {
    /// b_x, b_y, A_xx, A_yy of each pixel.
    pub(super) quad: BufId,
    /// 2 A_xy of each pixel.
    pub(super) cross_term: BufId,
    /// How certain it is, where frames come with a certainty.
    pub(super) certainty: Option<BufId>,
}

/// The buffers of this part of the plan.
pub(super) struct Expansions {
    /// Of each level, finest first, for both slots.
    pub(super) levels: Vec<[Expansion; 2]>,
    /// What a certainty adds.
    pub(super) certain: Option<Certain>,
    size: Size,
    radius: u32,
    applicability: Applicability,
    weights_y: BufId,
    weights_x: BufId,
    image: BufId,
    /// Of the expansion without certainty.
    moments: Option<BufId>,
    pyramid: Pyramid,
    sizes: Vec<Size>,
}

impl Expansions {
    pub(super) fn new(bufs: &mut Bufs, config: &Farneback, size: Size, levels: &[Level], certainty: bool) -> Self {
        let applicability = tables::applicability(config.poly_n, config.poly_sigma);
        let certain = certainty.then(|| Certain::new(bufs, size, levels));
        let expansion = |bufs: &mut Bufs, k: usize, level: &Level, slot: usize| {
            let frames = ["even frames", "odd frames"][slot];
            Expansion {
                quad: bufs.computed(format!("quad, level {k}, {frames}"), Shape::quads(level.size)),
                cross_term: bufs
                    .computed(format!("cross term, level {k}, {frames}"), Shape::planar(level.size, 1)),
                certainty: certain.as_ref().map(|certain| certain.expansion(k, slot)),
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
            moments: certain.is_none().then(|| bufs.computed("moments", Shape::planar(size, 3))),
            certain,
            pyramid: Pyramid::new(bufs, size, levels),
            sizes: levels.iter().map(|level| level.size).collect(),
        }
    }

    /// The expansion of a gray picture into this slot. Its certainty is needed if the estimator takes one.
    pub(super) fn steps(&self, gray: BufId, certainty: Option<BufId>, slot: usize) -> Vec<Step> {
        let mut steps = Vec::new();
        let pictures = match (&self.certain, certainty) {
            (Some(certain), Some(certainty)) => {
                steps.push(certain.weigh(gray, certainty, self.size));
                certain.pictures(self.image)
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
        if let (Some(certain), Some(certainty)) = (&self.certain, certainty) {
            let inputs = [self.image, self.weights_y, self.weights_x];
            steps.extend(certain.expand(k, size, self.radius, inputs, [quad, cross_term, certainty]));
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
