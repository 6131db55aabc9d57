//! The buffers and steps of the method.

use super::{HornSchunck, Penalty};
use crate::flow::coarse_to_fine::{CoarseToFine, Iteration};
use crate::flow::gradients::Gradients;
use crate::flow::images::{Images, LevelImage};
use crate::flow::levels::levels_down_to;
use crate::flow::{Evidence, Stages, Wanted};
use crate::frame::Size;
use crate::kernels::{brightness_equations, cubic_warp, links, smoothness, sweep};
use crate::plan::{BufId, Bufs, Shape, Step};

/// ε of the robust penalty of brightness, in gray levels.
const BRIGHTNESS: f32 = 0.5;
/// ε of the robust penalty of the flow's slopes, in pixels per pixel.
const SLOPE: f32 = 0.02;
/// Width in pixels of the confidence's Gaussian window.
const CONFIDENCE_WINDOW: u32 = 21;

/// The buffers and steps of the method.
pub(super) struct HornSchunckStages {
    config: HornSchunck,
    size: Size,
    images: Images,
    coarse_to_fine: CoarseToFine,
    mean: BufId,
    change: BufId,
    share: BufId,
    equations: BufId,
    smooth_weight: BufId,
    /// Four channels of zeros, which stand for the expected slopes and for the image's own.
    zero: BufId,
    system: BufId,
    link: BufId,
    confidence: Option<(Gradients, BufId)>,
}

impl HornSchunckStages {
    pub(super) fn new(bufs: &mut Bufs, config: &HornSchunck, size: Size, wanted: Wanted) -> Self {
        let levels = levels_down_to(size, config.pyr_scale, config.levels, f64::from(config.smallest));
        let [one, two, four, five] = [1, 2, 4, 5].map(|channels| Shape::planar(size, channels));
        let weight = (config.alpha * config.alpha) as f32;
        let runs = config.warps * runs(config);
        Self {
            config: config.clone(),
            size,
            images: Images::new(bufs, size, &levels, |_| true, wanted),
            coarse_to_fine: CoarseToFine::new(bufs, &levels, config.pyr_scale, wanted, |_| runs),
            mean: bufs.computed("mean of both images", one),
            change: bufs.computed("change", one),
            share: bufs.computed("share that both images show", one),
            equations: bufs.computed("equations", five),
            smooth_weight: match config.penalty {
                Penalty::Quadratic => bufs.constant("smoothness", vec![weight; one.len()]),
                Penalty::Robust => bufs.computed("smoothness", one),
            },
            zero: bufs.constant("no slope", vec![0.0; four.len()]),
            system: bufs.computed("system", five),
            link: bufs.computed("links", two),
            confidence: (wanted.confidence || wanted.evidence)
                .then(|| (Gradients::new(bufs, size, CONFIDENCE_WINDOW, true), bufs.computed("confidence", one))),
        }
    }

    fn iterate(&self, steps: &mut Vec<Step>, iteration: &Iteration, pair: [LevelImage; 2]) {
        let size = iteration.level.size;
        if (iteration.number - 1).is_multiple_of(runs(&self.config)) {
            self.linearize(steps, iteration, pair);
        }
        steps.push(Step::new(
            &sweep::KERNEL,
            iteration.label.clone(),
            sweep::Params { width: size.width, height: size.height, omega: self.config.omega as f32 },
            &[self.system, self.link, iteration.so_far],
            &[(iteration.flow, Shape::planar(size, 2))],
        ));
    }

    /// The linear equations at the flow so far, in `system` and `link`.
    fn linearize(&self, steps: &mut Vec<Step>, iteration: &Iteration, [first, second]: [LevelImage; 2]) {
        let Iteration { level, so_far, ref label, .. } = *iteration;
        let Size { width, height } = level.size;
        let [one, two, five] = [1, 2, 5].map(|channels| Shape::planar(level.size, channels));
        steps.push(Step::new(
            &cubic_warp::KERNEL,
            label.clone(),
            cubic_warp::Params { width, height },
            &[first.gray, first.certainty, second.gray, second.certainty, so_far],
            &[(self.mean, one), (self.change, one), (self.share, one)],
        ));
        let is_robust = self.config.penalty == Penalty::Robust;
        let robust = if is_robust { 1.0 / (BRIGHTNESS * BRIGHTNESS) } else { 0.0 };
        steps.push(Step::new(
            &brightness_equations::KERNEL,
            label.clone(),
            brightness_equations::Params { width, height, robust, prior: 0.0 },
            &[self.mean, self.change, self.share],
            &[(self.equations, five)],
        ));
        if is_robust {
            let alpha = (self.config.alpha * self.config.alpha) as f32 * SLOPE;
            steps.push(Step::new(
                &smoothness::KERNEL,
                label.clone(),
                smoothness::Params { width, height, alpha, beta: 1.0, edge: 0.0, robust: SLOPE * SLOPE },
                &[so_far, self.zero, self.zero],
                &[(self.smooth_weight, one)],
            ));
        }
        steps.push(Step::new(
            &links::KERNEL,
            label.clone(),
            links::Params { width, height },
            &[self.equations, so_far, self.smooth_weight, self.zero],
            &[(self.system, five), (self.link, two)],
        ));
    }
}

/// Runs of [`sweep`] in a warp, each of which writes the flow.
fn runs(config: &HornSchunck) -> u32 {
    config.sweeps / sweep::SWEEPS
}

impl Stages for HornSchunckStages {
    fn ingest(&self, gray: BufId, certainty: Option<BufId>, slot: usize) -> Vec<Step> {
        self.images.steps(gray, certainty, slot)
    }

    fn pair(&self, _parity: usize, slots: [usize; 2], initial: BufId, flow: BufId) -> Vec<Step> {
        let pair = |k: usize| slots.map(|slot| self.images.level(k, slot));
        let iterations = self.config.warps * runs(&self.config);
        let mut steps = self.coarse_to_fine.steps(|_| iterations, initial, flow, |steps, iteration| {
            self.iterate(steps, &iteration, pair(iteration.k));
        });
        if let Some((gradients, plane)) = &self.confidence {
            gradients.confidence(&mut steps, self.size, pair(0), flow, *plane);
        }
        steps
    }

    fn confidence(&self) -> Option<BufId> {
        self.confidence.as_ref().map(|(_, plane)| *plane)
    }

    fn evidence(&self, _slots: [usize; 2]) -> Evidence {
        Evidence::Confidence(Stages::confidence(self).unwrap_or_else(|| unreachable!("it was wanted")))
    }
}
