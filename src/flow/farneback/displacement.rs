//! What is computed of two frames: on each level, coarse to fine, the equations, their average and their solution.

use super::expansion::{Expansion, Expansions};
use super::{Farneback, Outside, Update, Window};
use crate::flow::{Level, Wanted};
use crate::kernels::{
    advance, area, certain_matrices, confidence, matrices, residual, solve, tables, upsample, window_y,
};
use crate::plan::{BufId, Bufs, Shape, Step};

/// The buffers of this part of the plan.
pub(super) struct Displacement {
    levels: Vec<FlowLevel>,
    pyr_scale: f64,
    iterations: u32,
    radius: u32,
    /// How much what is outside the second frame counts.
    outside: f32,
    window_y: BufId,
    window_x: BufId,
    equations: BufId,
    columns: BufId,
    start: Start,
    trust: Option<Trust>,
}

/// One level's flow and how the coarser level's is read.
struct FlowLevel {
    level: Level,
    /// The finest level's flow is the plan's.
    flow: Option<BufId>,
    /// Where every other iteration's flow goes, if each is added to the one before.
    other: Option<BufId>,
    place: Option<[BufId; 2]>,
}

/// The buffers of the confidence.
struct Trust {
    /// Where frames come without a certainty, one that is the same everywhere.
    certainty: Option<BufId>,
    confidence: BufId,
}

/// What the coarsest level begins with.
enum Start {
    /// No motion.
    Zero(BufId),
    /// The given flow, read by these covers.
    Given([BufId; 2]),
}

impl Displacement {
    pub(super) fn new(bufs: &mut Bufs, config: &Farneback, levels: &[Level], wanted: Wanted) -> Self {
        let finest = levels[0].size;
        let coarsest = levels[levels.len() - 1].size;
        let start = if wanted.initial_flow {
            Start::Given([
                bufs.constant("columns of the given flow", tables::cover(finest.width, coarsest.width)),
                bufs.constant("rows of the given flow", tables::cover(finest.height, coarsest.height)),
            ])
        } else {
            Start::Zero(bufs.constant("no motion", vec![0.0; Shape::planar(coarsest, 2).len()]))
        };
        let flow_level = |(k, &level): (usize, &Level)| FlowLevel {
            level,
            flow: (k > 0).then(|| bufs.computed(format!("flow, level {k}"), Shape::planar(level.size, 2))),
            other: (config.update == Update::Increment)
                .then(|| bufs.computed(format!("flow so far, level {k}"), Shape::planar(level.size, 2))),
            place: levels.get(k + 1).map(|coarser| {
                [
                    bufs.constant(
                        format!("columns of level {}", k + 1),
                        tables::place(coarser.size.width, level.size.width),
                    ),
                    bufs.constant(
                        format!("rows of level {}", k + 1),
                        tables::place(coarser.size.height, level.size.height),
                    ),
                ]
            }),
        };
        let window = tables::window(config.winsize, config.window == Window::Gaussian);
        let radius = window.len() / 2;
        Self {
            levels: levels.iter().enumerate().map(flow_level).collect(),
            pyr_scale: config.pyr_scale,
            iterations: config.iterations,
            radius: radius as u32,
            outside: if config.outside == Outside::First { 1.0 } else { 0.0 },
            window_y: bufs.constant("window, columns", tables::window_from(&window, radius)),
            window_x: bufs.constant("window, rows", tables::window_from(&window, radius.next_multiple_of(4))),
            equations: bufs.computed("equations", Shape::planar(finest, 5)),
            columns: bufs.computed("averaged columns", Shape::planar(finest, 5)),
            start,
            trust: wanted.confidence.then(|| Trust {
                certainty: (!wanted.certainty)
                    .then(|| bufs.constant("equal certainty", vec![1.0; Shape::planar(finest, 1).len()])),
                confidence: bufs.computed("confidence", Shape::planar(finest, 1)),
            }),
        }
    }

    /// Where the confidence goes.
    pub(super) fn confidence(&self) -> Option<BufId> {
        self.trust.as_ref().map(|trust| trust.confidence)
    }

    /// The flow from the picture in the first of two slots to that in the second. It begins with the given one, if the
    /// estimator takes one.
    pub(super) fn steps(
        &self,
        expansions: &Expansions,
        [first, second]: [usize; 2],
        given: BufId,
        flow: BufId,
    ) -> Vec<Step> {
        let mut steps = Vec::new();
        let mut coarser: Option<(BufId, Level)> = None;
        for (k, level) in self.levels.iter().enumerate().rev() {
            let own = level.flow.unwrap_or(flow);
            // The flow after so many iterations: after all of them the level's own.
            let after = |iterations: u32| match level.other {
                Some(other) if !(self.iterations - iterations).is_multiple_of(2) => other,
                _ => own,
            };
            let mut so_far = after(0);
            match (coarser, &self.start) {
                (Some((flow, of)), _) => steps.push(self.refine(k, level, flow, of, so_far)),
                (None, Start::Given(cover)) => steps.push(self.reduce(k, level, given, *cover, so_far)),
                (None, Start::Zero(zero)) => so_far = *zero,
            }
            let pair = [expansions.levels[k][first], expansions.levels[k][second]];
            for i in 1..=self.iterations {
                let label = format!("level {k}, iteration {i}");
                self.iterate(&mut steps, label, level, pair, [so_far, after(i)]);
                so_far = after(i);
            }
            coarser = Some((own, level.level));
            if let (0, Some(trust)) = (k, &self.trust) {
                self.judge(&mut steps, trust, level.level, pair, own);
            }
        }
        steps
    }

    /// The coarser level's flow as a beginning.
    fn refine(&self, k: usize, level: &FlowLevel, coarse: BufId, of: Level, flow: BufId) -> Step {
        let size = level.level.size;
        let [place_x, place_y] = level.place.unwrap_or_else(|| unreachable!("a coarser level was computed"));
        Step::new(
            &upsample::KERNEL,
            format!("level {k}"),
            upsample::Params {
                width: size.width,
                height: size.height,
                in_width: of.size.width,
                in_height: of.size.height,
                scale: (1.0 / self.pyr_scale) as f32,
            },
            &[coarse, place_x, place_y],
            &[(flow, Shape::planar(size, 2))],
        )
    }

    /// A given flow as a beginning.
    fn reduce(&self, k: usize, level: &FlowLevel, given: BufId, [x, y]: [BufId; 2], flow: BufId) -> Step {
        let (size, finest) = (level.level.size, self.levels[0].level.size);
        Step::new(
            &area::KERNEL,
            format!("level {k}"),
            area::Params {
                width: size.width,
                height: size.height,
                in_width: finest.width,
                in_height: finest.height,
                scale: level.level.scale as f32,
            },
            &[given, x, y],
            &[(flow, Shape::planar(size, 2))],
        )
    }

    fn iterate(
        &self,
        steps: &mut Vec<Step>,
        label: String,
        level: &FlowLevel,
        [first, second]: [Expansion; 2],
        [so_far, flow]: [BufId; 2],
    ) {
        let size = level.level.size;
        let (width, height) = (size.width, size.height);
        let five = Shape::planar(size, 5);
        let equations = matrices::Params {
            width,
            height,
            carried: if level.other.is_some() { 0.0 } else { 1.0 },
            outside: self.outside,
        };
        steps.push(match (first.certainty, second.certainty) {
            (Some(certainty_0), Some(certainty_1)) => Step::new(
                &certain_matrices::KERNEL,
                label.clone(),
                equations,
                &[
                    first.quad,
                    first.cross_term,
                    certainty_0,
                    second.quad,
                    second.cross_term,
                    certainty_1,
                    so_far,
                ],
                &[(self.equations, five)],
            ),
            _ => Step::new(
                &matrices::KERNEL,
                label.clone(),
                equations,
                &[first.quad, first.cross_term, second.quad, second.cross_term, so_far],
                &[(self.equations, five)],
            ),
        });
        steps.push(Step::new(
            &window_y::KERNEL,
            label.clone(),
            window_y::Params { width, height, radius: self.radius },
            &[self.equations, self.window_y],
            &[(self.columns, five)],
        ));
        let params = solve::Params { width, height, radius: self.radius };
        let flow = [(flow, Shape::planar(size, 2))];
        steps.push(match level.other {
            None => Step::new(&solve::KERNEL, label, params, &[self.columns, self.window_x], &flow),
            Some(_) => {
                Step::new(&advance::KERNEL, label, params, &[self.columns, self.window_x, so_far], &flow)
            }
        });
    }

    /// The confidence in the finest level's flow.
    fn judge(
        &self,
        steps: &mut Vec<Step>,
        trust: &Trust,
        level: Level,
        [first, second]: [Expansion; 2],
        flow: BufId,
    ) {
        let (width, height) = (level.size.width, level.size.height);
        let five = Shape::planar(level.size, 5);
        let certainty =
            trust.certainty.or(first.certainty).unwrap_or_else(|| unreachable!("there is one of the two"));
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
            &[(self.columns, five)],
        ));
        steps.push(Step::new(
            &confidence::KERNEL,
            "confidence",
            confidence::Params { width, height, radius: self.radius },
            &[self.columns, self.window_x],
            &[(trust.confidence, Shape::planar(level.size, 1))],
        ));
    }
}
