//! What one pair leaves for the next: the expansions of its older frame, and its flow.

use super::FarnebackTv;
use super::stages::{FLOOR, KAPPA, ROBUST};
use crate::flow::coarse_to_fine::Iteration;
use crate::flow::expansions::Expansion;
use crate::flow::{Level, Wanted};
use crate::frame::Size;
use crate::kernels::{carry, keep_expansion, older_equations};
use crate::plan::{BufId, Bufs, Shape, Step};

/// τ: the difference from the previous flow, in pixels of the finest computed level, at which its weight is half.
const CARRY_SPREAD: f32 = 0.2;

/// The third frame: the one before the pair. Its equations count beside the pair's own.
pub(super) struct ThirdFrame {
    weight: f32,
    /// Its time in displacements from the first image of a pair.
    time: f32,
    /// Whether the pair's first or second image is the older frame of the next pair.
    pub(super) kept: usize,
    /// For each level, finest first: quads, and cross terms with certainties, by the parity of the pair that reads them.
    levels: Vec<Option<[[BufId; 2]; 2]>>,
    /// The sums of both equations.
    pub(super) equations: BufId,
}

impl ThirdFrame {
    pub(super) fn new(bufs: &mut Bufs, config: &FarnebackTv, levels: &[Level], finest: usize, wanted: Wanted) -> Self {
        let level = |(k, level): (usize, &Level)| {
            let rest = Size::new(level.size.width, 2 * level.size.height);
            (k >= finest).then(|| {
                let mut kept = |what: &str, shape: Shape| {
                    ["even", "odd"].map(|parity| bufs.computed(format!("older {what}, level {k}, {parity} frames"), shape))
                };
                [kept("quad", Shape::quads(level.size)), kept("cross term and certainty", Shape::planar(rest, 1))]
            })
        };
        Self {
            weight: config.third_frame as f32,
            time: if wanted.backward { 2.0 } else { -1.0 },
            kept: usize::from(wanted.backward),
            levels: levels.iter().enumerate().map(level).collect(),
            equations: bufs.computed("equations with the older frame's", Shape::planar(levels[finest].size, 5)),
        }
    }

    /// The step that adds the older frame's equations to `pair`. `certainty` is that of the first image.
    pub(super) fn add(
        &self,
        steps: &mut Vec<Step>,
        parity: usize,
        iteration: &Iteration,
        first: Expansion,
        [certainty, pair]: [BufId; 2],
    ) {
        let Some([quad, rest]) = self.levels[iteration.k] else { return };
        let size = iteration.level.size;
        steps.push(Step::new(
            &older_equations::KERNEL,
            iteration.label.clone(),
            older_equations::Params {
                width: size.width,
                height: size.height,
                kappa: KAPPA,
                floor: FLOOR,
                robust: ROBUST,
                border: if iteration.number == 1 { 1.0 } else { 0.0 },
                time: self.time,
                weight: self.weight,
            },
            &[first.quad, first.cross_term, certainty, quad[parity], rest[parity], iteration.so_far, pair],
            &[(self.equations, Shape::planar(size, 5))],
        ));
    }

    /// The step that keeps an expansion of a level for the next pair. `certainty` is the expansion's.
    pub(super) fn keep(
        &self,
        steps: &mut Vec<Step>,
        parity: usize,
        (k, size): (usize, Size),
        expansion: Expansion,
        certainty: BufId,
    ) {
        let Some([quad, rest]) = self.levels[k] else { return };
        let (width, height) = (size.width, size.height);
        steps.push(Step::new(
            &keep_expansion::KERNEL,
            format!("level {k}"),
            keep_expansion::Params { width, height },
            &[expansion.quad, expansion.cross_term, certainty],
            &[
                (quad[1 - parity], Shape::quads(size)),
                (rest[1 - parity], Shape::planar(Size::new(width, 2 * height), 1)),
            ],
        ));
    }

    pub(super) fn carried(&self) -> impl Iterator<Item = [BufId; 2]> {
        self.levels.iter().flatten().flatten().copied()
    }
}

/// The previous pair's flow, towards which a pair's is drawn.
pub(super) struct PreviousFlow {
    weight: f32,
    sense: f32,
    /// Flow and presence on the finest computed level, by the parity of the pair that reads them.
    pub(super) state: [BufId; 2],
}

impl PreviousFlow {
    pub(super) fn new(bufs: &mut Bufs, config: &FarnebackTv, size: Size, wanted: Wanted) -> Self {
        Self {
            weight: config.carry as f32,
            sense: if wanted.backward { 1.0 } else { -1.0 },
            state: ["even", "odd"]
                .map(|parity| bufs.computed(format!("previous flow, {parity} frames"), Shape::planar(size, 3))),
        }
    }

    pub(super) fn step(&self, parity: usize, iteration: &Iteration) -> Step {
        let size = iteration.level.size;
        Step::new(
            &carry::KERNEL,
            iteration.label.clone(),
            carry::Params {
                width: size.width,
                height: size.height,
                sense: self.sense,
                weight: self.weight,
                inverse: 1.0 / (CARRY_SPREAD * CARRY_SPREAD),
            },
            &[iteration.so_far, self.state[parity]],
            &[(iteration.flow, Shape::planar(size, 2)), (self.state[1 - parity], Shape::planar(size, 3))],
        )
    }
}
