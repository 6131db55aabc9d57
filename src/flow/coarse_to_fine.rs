//! Coarse-to-fine search: the flow of each level of a pyramid begins with that of the coarser level.

use super::{Level, Wanted};
use crate::kernels::{downsample_flow, tables, upsample};
use crate::plan::{BufId, Bufs, Shape, Step};

/// The buffers of the flow on each level, and the tables for reading the coarser level's flow.
pub(super) struct CoarseToFine {
    levels: Vec<FlowLevel>,
    pyr_scale: f64,
    start: Start,
}

/// One level's flow, and the tables for reading the coarser level's.
struct FlowLevel {
    level: Level,
    /// `None` for the finest level, whose flow is the plan's.
    flow: Option<BufId>,
    /// The second buffer, which every other iteration writes, if iterations add to the flow so far.
    other: Option<BufId>,
    place: Option<[BufId; 2]>,
}

/// The initial flow of the coarsest level.
enum Start {
    /// Zero motion.
    Zero(BufId),
    /// The given flow, averaged by these tables.
    Given([BufId; 2]),
}

/// One iteration on one level.
pub(super) struct Iteration {
    /// The level's number, 0 for the finest.
    pub(super) k: usize,
    /// The iteration's number on its level, from 1.
    pub(super) number: u32,
    /// The level.
    pub(super) level: Level,
    /// Its label, for example `level 2, iteration 1`.
    pub(super) label: String,
    /// The flow so far: two channels, in pixels of the level.
    pub(super) so_far: BufId,
    /// The buffer of its result: another one than `from`, if iterations add to the flow so far.
    pub(super) flow: BufId,
}

impl CoarseToFine {
    /// Allocates the buffers for these levels, finest first. `adding` tells how many of a level's iterations add to the flow so
    /// far: all or none. Those that do write alternately to two buffers.
    pub(super) fn new(
        bufs: &mut Bufs,
        levels: &[Level],
        pyr_scale: f64,
        wanted: Wanted,
        adding: impl Fn(usize) -> u32,
    ) -> Self {
        let (finest, coarsest) = (levels[0].size, levels[levels.len() - 1].size);
        let has_start = |k: usize| wanted.initial_flow || k + 1 < levels.len();
        let start = if wanted.initial_flow {
            Start::Given([
                bufs.constant("columns of the initial flow", tables::cover(finest.width, coarsest.width)),
                bufs.constant("rows of the initial flow", tables::cover(finest.height, coarsest.height)),
            ])
        } else {
            Start::Zero(bufs.constant("zero motion", vec![0.0; Shape::planar(coarsest, 2).len()]))
        };
        let flow_level = |(k, &level): (usize, &Level)| FlowLevel {
            level,
            flow: (k > 0).then(|| bufs.computed(format!("flow, level {k}"), Shape::planar(level.size, 2))),
            other: (adding(k) + u32::from(has_start(k)) > 1 && adding(k) > 0)
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
        Self { levels: levels.iter().enumerate().map(flow_level).collect(), pyr_scale, start }
    }

    /// The steps of all levels, coarsest first, with the iterations that `iterations` gives for each level; `iterate` adds
    /// the steps of one iteration. A level without iterations has the flow of the coarser one. The search begins with `initial`, if the plan has one, and the finest level's flow goes to `flow`.
    pub(super) fn steps(
        &self,
        iterations: impl Fn(usize) -> u32,
        initial: BufId,
        flow: BufId,
        iterate: impl Fn(&mut Vec<Step>, Iteration),
    ) -> Vec<Step> {
        let mut steps = Vec::new();
        let mut coarser: Option<(BufId, Level)> = None;
        for (k, level) in self.levels.iter().enumerate().rev() {
            let own = level.flow.unwrap_or(flow);
            let iterations = iterations(k);
            // The buffer of the flow after this many iterations: after the last one the level's own.
            let after = |done: u32| match level.other {
                Some(other) if !(iterations - done).is_multiple_of(2) => other,
                _ => own,
            };
            let mut so_far = after(0);
            match (coarser, &self.start) {
                (Some((flow, of)), _) => steps.push(self.refine(k, level, flow, of, so_far)),
                (None, Start::Given(cover)) => steps.push(self.reduce(k, level, initial, *cover, so_far)),
                (None, Start::Zero(zero)) => so_far = *zero,
            }
            for i in 1..=iterations {
                let label = format!("level {k}, iteration {i}");
                iterate(
                    &mut steps,
                    Iteration { k, number: i, level: level.level, label, so_far, flow: after(i) },
                );
                so_far = after(i);
            }
            coarser = Some((own, level.level));
        }
        steps
    }

    /// The flow of a level; `None` for the finest one, whose flow is the plan's.
    pub(super) fn flow(&self, k: usize) -> Option<BufId> {
        self.levels[k].flow
    }

    /// The step that reads the coarser level's flow as the initial flow.
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
                channels: 2,
            },
            &[coarse, place_x, place_y],
            &[(flow, Shape::planar(size, 2))],
        )
    }

    /// The step that reduces a given flow to the coarsest level.
    fn reduce(&self, k: usize, level: &FlowLevel, given: BufId, [x, y]: [BufId; 2], flow: BufId) -> Step {
        let (size, finest) = (level.level.size, self.levels[0].level.size);
        Step::new(
            &downsample_flow::KERNEL,
            format!("level {k}"),
            downsample_flow::Params {
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
}
