//! The steps of a pair of frames: on each level, coarse to fine, the equations, their average and their solution.

use super::{Farneback, Motion, Outside, Update, Window};
use crate::flow::coarse_to_fine::{CoarseToFine, Iteration};
use crate::flow::expansions::{Expansion, Expansions};
use crate::flow::{Level, Wanted};
use crate::frame::Size;
use crate::kernels::{
    affine_columns, confidence, normal_equations, residual, robust_equations, solve, solve_affine, solve_increment, tables,
    weighted_normal_equations, weighted_robust_equations, window_y,
};
use crate::plan::{BufId, Bufs, Shape, Step};

/// The share of its Hessian by which an expansion is continued to a place between pixels, with normalised equations.
const KAPPA: f32 = 0.3;
/// ζ²: the floor of the squared slope that divides a normalised equation.
const FLOOR: f32 = 0.04;
/// What is added to the determinant of a window's normalised equations, or to the diagonal for an affine motion.
const REGULAR: f32 = 1e-6;

/// What is added to the diagonal of the normal matrix of an affine motion.
const AFFINE_REGULAR: f32 = 1e-3;

/// The buffers of this part of the plan.
pub(super) struct Displacement {
    coarse_to_fine: CoarseToFine,
    finest: Level,
    iterations: u32,
    /// Whether an iteration adds its result to the flow so far.
    adds: bool,
    /// Whether each equation is divided by its own slope.
    normalized: bool,
    radius: u32,
    /// The weight of pixels that the flow takes outside the second frame.
    outside: f32,
    window_y: BufId,
    equations: BufId,
    /// The average that a constant motion and the confidence take.
    average: Option<Average>,
    /// The columns' moments, if the motion is affine.
    moments: Option<BufId>,
    evidence: Option<Evidence>,
}

/// The buffers of the equations' average over a window.
#[derive(Clone, Copy)]
struct Average {
    /// The equations averaged along columns only.
    columns: BufId,
    /// The window's weights along rows.
    window_x: BufId,
}

/// The buffers of the confidence.
struct Evidence {
    /// A constant certainty, for frames without one.
    certainty: Option<BufId>,
    confidence: BufId,
}

impl Displacement {
    pub(super) fn new(bufs: &mut Bufs, config: &Farneback, levels: &[Level], wanted: Wanted) -> Self {
        let finest = levels[0].size;
        let adds = config.update != Update::Flow;
        // The solution of an affine motion reads the flow so far beside its output, so that they are two buffers.
        let affine = config.motion == Motion::Affine;
        let adding = if adds || affine { config.iterations } else { 0 };
        let coarse_to_fine = CoarseToFine::new(bufs, levels, config.pyr_scale, wanted, |_| adding);
        let window = tables::window(config.winsize, config.window == Window::Gaussian);
        let radius = window.len() / 2;
        Self {
            coarse_to_fine,
            finest: levels[0],
            adds,
            normalized: config.update == Update::Normalized,
            iterations: config.iterations,
            radius: radius as u32,
            outside: if config.outside == Outside::First { 1.0 } else { 0.0 },
            window_y: bufs.constant("window, columns", tables::window_from(&window, radius)),
            equations: bufs.computed("equations", Shape::planar(finest, 5)),
            average: (!affine || wanted.confidence).then(|| Average {
                columns: bufs.computed("averaged columns", Shape::planar(finest, 5)),
                window_x: bufs.constant("window, rows", tables::window_from(&window, radius.next_multiple_of(4))),
            }),
            moments: affine.then(|| {
                bufs.computed("moments of columns", Shape::planar(finest, affine_columns::CHANNELS))
            }),
            evidence: wanted.confidence.then(|| Evidence {
                certainty: (!wanted.certainty)
                    .then(|| bufs.constant("full certainty", vec![1.0; Shape::planar(finest, 1).len()])),
                confidence: bufs.computed("confidence", Shape::planar(finest, 1)),
            }),
        }
    }

    /// The plane of the confidence.
    pub(super) fn confidence(&self) -> Option<BufId> {
        self.evidence.as_ref().map(|evidence| evidence.confidence)
    }

    /// The flow from the image in the first slot to the image in the second. The search begins with the given flow, if
    /// the estimator takes one.
    pub(super) fn steps(
        &self,
        expansions: &Expansions,
        [first, second]: [usize; 2],
        given: BufId,
        flow: BufId,
    ) -> Vec<Step> {
        let pair = |k: usize| [first, second].map(|slot| expansions.level(k, slot));
        let mut steps = self.coarse_to_fine.steps(|_| self.iterations, given, flow, |steps, iteration| {
            self.iterate(steps, &iteration, pair(iteration.k));
        });
        if let Some(evidence) = &self.evidence {
            self.judge(&mut steps, evidence, self.finest, pair(0), flow);
        }
        steps
    }

    fn average(&self) -> Average {
        self.average.unwrap_or_else(|| unreachable!("a constant motion and the confidence have one"))
    }

    fn iterate(
        &self,
        steps: &mut Vec<Step>,
        iteration: &Iteration,
        [first, second]: [Expansion; 2],
    ) {
        let Iteration { level, label, so_far, flow, .. } = iteration;
        let (size, so_far) = (level.size, *so_far);
        let (width, height) = (size.width, size.height);
        let five = Shape::planar(size, 5);
        steps.push(self.equations(level.size, label, [first, second], so_far));
        if let Some(moments) = self.moments {
            return self.solve_affine(steps, iteration, moments);
        }
        let Average { columns, window_x } = self.average();
        steps.push(Step::new(
            &window_y::KERNEL,
            label.clone(),
            window_y::Params { width, height, radius: self.radius },
            &[self.equations, self.window_y],
            &[(columns, five)],
        ));
        let radius = self.radius;
        let flow = [(*flow, Shape::planar(size, 2))];
        let label = label.clone();
        steps.push(match self.adds {
            false => {
                let params = solve::Params { width, height, radius };
                Step::new(&solve::KERNEL, label, params, &[columns, window_x], &flow)
            }
            true => {
                let regular = if self.normalized { REGULAR } else { 1e-3 };
                let params = solve_increment::Params { width, height, radius, regular };
                Step::new(&solve_increment::KERNEL, label, params, &[columns, window_x, so_far], &flow)
            }
        });
    }

    /// The steps that average the equations for an affine motion, and solve them.
    fn solve_affine(&self, steps: &mut Vec<Step>, iteration: &Iteration, moments: BufId) {
        let Iteration { level, label, so_far, flow, .. } = iteration;
        let (size, radius, step) = (level.size, self.radius, 1.0 / self.radius as f32);
        let (width, height) = (size.width, size.height);
        steps.push(Step::new(
            &affine_columns::KERNEL,
            label.clone(),
            affine_columns::Params { width, height, radius, step },
            &[self.equations, self.window_y],
            &[(moments, Shape::planar(size, affine_columns::CHANNELS))],
        ));
        let regular = if self.normalized { REGULAR } else { AFFINE_REGULAR };
        let added = if self.adds { 1.0 } else { 0.0 };
        steps.push(Step::new(
            &solve_affine::KERNEL,
            label.clone(),
            solve_affine::Params { width, height, radius, step, regular, added },
            &[moments, self.window_y, *so_far],
            &[(*flow, Shape::planar(size, 2))],
        ));
    }

    /// The step that sets up each pixel's equations.
    fn equations(&self, size: Size, label: &str, [first, second]: [Expansion; 2], so_far: BufId) -> Step {
        let (width, height) = (size.width, size.height);
        let output = [(self.equations, Shape::planar(size, 5))];
        let weighted = [first.certainty, second.certainty];
        let inputs = match weighted {
            [Some(certainty_0), Some(certainty_1)] => vec![
                first.quad,
                first.cross_term,
                certainty_0,
                second.quad,
                second.cross_term,
                certainty_1,
                so_far,
            ],
            _ => vec![first.quad, first.cross_term, second.quad, second.cross_term, so_far],
        };
        let weighted = weighted[0].is_some();
        if self.normalized {
            let kernel =
                if weighted { &weighted_robust_equations::KERNEL } else { &robust_equations::KERNEL };
            let (kappa, floor, outside) = (KAPPA, FLOOR, self.outside);
            let params = robust_equations::Params { width, height, kappa, floor, robust: 0.0, outside, border: 1.0 };
            return Step::new(kernel, label, params, &inputs, &output);
        }
        let kernel = if weighted { &weighted_normal_equations::KERNEL } else { &normal_equations::KERNEL };
        let carried = if self.adds { 0.0 } else { 1.0 };
        let params = normal_equations::Params { width, height, carried, outside: self.outside };
        Step::new(kernel, label, params, &inputs, &output)
    }

    /// The steps that compute the confidence of the finest level's flow.
    fn judge(
        &self,
        steps: &mut Vec<Step>,
        evidence: &Evidence,
        level: Level,
        [first, second]: [Expansion; 2],
        flow: BufId,
    ) {
        let (width, height) = (level.size.width, level.size.height);
        let five = Shape::planar(level.size, 5);
        let Average { columns, window_x } = self.average();
        let certainty =
            evidence.certainty.or(first.certainty).unwrap_or_else(|| unreachable!("there is one of the two"));
        steps.push(Step::new(
            &residual::KERNEL,
            "confidence",
            residual::Params { width, height },
            &[first.quad, first.cross_term, second.quad, second.cross_term, certainty, flow],
            &[(self.equations, five)],
        ));
        steps.push(Step::new(
            &window_y::KERNEL,
            "confidence",
            window_y::Params { width, height, radius: self.radius },
            &[self.equations, self.window_y],
            &[(columns, five)],
        ));
        steps.push(Step::new(
            &confidence::KERNEL,
            "confidence",
            confidence::Params { width, height, radius: self.radius },
            &[columns, window_x],
            &[(evidence.confidence, Shape::planar(level.size, 1))],
        ));
    }
}
