//! The buffers and steps of the method.

use super::FlowFilter;
use crate::flow::gradients::Gradients;
use crate::flow::images::{Images, LevelImage};
use crate::flow::levels::levels_down_to;
use crate::flow::{Evidence, Level, Stages, Wanted};
use crate::frame::Size;
use crate::kernels::{
    brightness_equations, correct, cubic_warp, downsample_flow, solve_increment, tables, transport, upsample, window_y,
};
use crate::plan::{BufId, Bufs, Shape, Step};

/// No level but the full image has a side under this many pixels.
const SMALLEST_SIDE: f64 = 24.0;
/// Standard deviation of the window, as a share of its radius. A box would not do: its spectrum has negative parts, in which
/// correction after correction amplifies noise.
const SIGMA: f64 = 0.4;
/// γ on levels coarser than the finest computed one, which must follow large changes at once.
const COARSE_GAMMA: f32 = 4.0;
/// What is taken off a coarser level's corrections, in pixels of that level.
const THRESHOLD: f32 = 0.1;
/// What is added to the determinant of a window's equations, which γ keeps well off zero.
const REGULAR: f32 = 1e-9;
/// Width in pixels of the confidence's Gaussian window.
const CONFIDENCE_WINDOW: u32 = 21;

/// The buffers and steps of the method.
pub(super) struct FlowFilterStages {
    gamma: f32,
    size: Size,
    levels: Vec<Level>,
    /// The number of the finest computed level.
    finest: usize,
    images: Images,
    start: Start,
    /// For each level that is computed, finest first.
    of_level: Vec<LevelFlow>,
    mean: BufId,
    change: BufId,
    share: BufId,
    equations: BufId,
    columns: BufId,
    window: [BufId; 2],
    radius: u32,
    /// The tables that enlarge the finest computed level's flow.
    enlarge: [BufId; 2],
    confidence: Option<(Gradients, BufId)>,
}

/// The source of the prediction.
enum Start {
    /// The state, by the parity of the pair that reads it, and whether the flow leads back in time.
    State { state: [BufId; 2], backward: bool },
    /// The given flow, averaged by these tables; the result goes to a buffer.
    Given { cover: [BufId; 2], flow: BufId },
}

/// The flow of one level.
struct LevelFlow {
    prediction: BufId,
    /// What follows from the coarser level; `None` on the coarsest one.
    corrected: Option<Corrected>,
    /// Of a level coarser than the finest computed one.
    coarse: Option<Coarse>,
}

/// A prediction corrected by the coarser level.
#[derive(Clone, Copy)]
struct Corrected {
    /// The tables for reading the coarser level's correction.
    place: [BufId; 2],
    prediction: BufId,
}

/// The flow of a level coarser than the finest computed one.
#[derive(Clone, Copy)]
struct Coarse {
    /// The tables that average the finest computed level's prediction.
    cover: [BufId; 2],
    flow: BufId,
}

impl FlowFilterStages {
    pub(super) fn new(bufs: &mut Bufs, config: &FlowFilter, size: Size, wanted: Wanted) -> Self {
        let levels = levels_down_to(size, 0.5, config.levels, SMALLEST_SIDE);
        let finest = (config.skip as usize).min(levels.len() - 1);
        let own = levels[finest].size;
        let [one, two, five] = [1, 2, 5].map(|channels| Shape::planar(own, channels));
        let confident = wanted.confidence || wanted.evidence;
        let radius = config.winsize as usize / 2;
        let window = tables::gauss(SIGMA * radius as f64, 2 * radius as u32 + 1);
        let of_level = (finest..levels.len()).map(|k| LevelFlow::new(bufs, &levels, finest, k)).collect();
        let start = if wanted.initial_flow {
            let cover = [
                bufs.constant("columns of the initial flow", tables::cover(size.width, own.width)),
                bufs.constant("rows of the initial flow", tables::cover(size.height, own.height)),
            ];
            Start::Given { cover, flow: bufs.computed("filtered flow", two) }
        } else {
            let state = ["even", "odd"].map(|pairs| bufs.computed(format!("state for {pairs} pairs"), two));
            Start::State { state, backward: wanted.backward }
        };
        Self {
            gamma: config.gamma as f32,
            size,
            // The confidence needs the full images, too.
            images: Images::new(bufs, size, &levels, |k| k >= finest || confident && k == 0, wanted),
            start,
            of_level,
            mean: bufs.computed("mean of both images", one),
            change: bufs.computed("change", one),
            share: bufs.computed("share that both images show", one),
            equations: bufs.computed("equations", five),
            columns: bufs.computed("averaged columns of the equations", five),
            window: [
                bufs.constant("window of the filter, columns", tables::window_from(&window, radius)),
                bufs.constant("window of the filter, rows", tables::window_from(&window, radius.next_multiple_of(4))),
            ],
            radius: radius as u32,
            enlarge: [
                bufs.constant("columns of the finest level", tables::place(own.width, size.width)),
                bufs.constant("rows of the finest level", tables::place(own.height, size.height)),
            ],
            confidence: confident
                .then(|| (Gradients::new(bufs, size, CONFIDENCE_WINDOW, true), bufs.computed("confidence", Shape::planar(size, 1)))),
            finest,
            levels,
        }
    }

    /// The flow of level `k`, which is computed.
    fn level(&self, k: usize) -> &LevelFlow {
        &self.of_level[k - self.finest]
    }

    /// The step of the prediction on the finest computed level.
    fn predict(&self, steps: &mut Vec<Step>, parity: usize, initial: BufId) {
        let level = self.levels[self.finest];
        let Size { width, height } = level.size;
        let output = [(self.level(self.finest).prediction, Shape::planar(level.size, 2))];
        steps.push(match &self.start {
            Start::State { state, backward } => {
                let params = transport::Params { width, height, sense: if *backward { 1.0 } else { -1.0 } };
                Step::new(&transport::KERNEL, "prediction", params, &[state[parity]], &output)
            }
            Start::Given { cover: [x, y], .. } => {
                let params = reduction(self.size, level.size, level.scale);
                Step::new(&downsample_flow::KERNEL, "prediction", params, &[initial, *x, *y], &output)
            }
        });
    }

    /// The steps of one level, from its prediction to `flow`.
    fn update(&self, steps: &mut Vec<Step>, k: usize, [first, second]: [LevelImage; 2], flow: BufId) {
        let size = self.levels[k].size;
        let Size { width, height } = size;
        let [one, two, five] = [1, 2, 5].map(|channels| Shape::planar(size, channels));
        let label = format!("level {k}");
        let own = self.level(k);
        let mut begin = own.prediction;
        if let Some(Corrected { place: [place_x, place_y], prediction }) = own.corrected {
            let (of, coarser) = (self.levels[k + 1].size, self.level(k + 1));
            let Some(Coarse { flow: coarse, .. }) = coarser.coarse else { unreachable!("it is coarser") };
            steps.push(Step::new(
                &correct::KERNEL,
                label.clone(),
                correct::Params {
                    width,
                    height,
                    in_width: of.width,
                    in_height: of.height,
                    scale: 2.0,
                    threshold: THRESHOLD,
                },
                &[own.prediction, coarse, coarser.prediction, place_x, place_y],
                &[(prediction, two)],
            ));
            begin = prediction;
        }
        steps.push(Step::new(
            &cubic_warp::KERNEL,
            label.clone(),
            cubic_warp::Params { width, height },
            &[first.gray, first.certainty, second.gray, second.certainty, begin],
            &[(self.mean, one), (self.change, one), (self.share, one)],
        ));
        let prior = if k == self.finest { self.gamma } else { COARSE_GAMMA };
        steps.push(Step::new(
            &brightness_equations::KERNEL,
            label.clone(),
            brightness_equations::Params { width, height, robust: 0.0, prior },
            &[self.mean, self.change, self.share],
            &[(self.equations, five)],
        ));
        let [window, window_x] = self.window;
        steps.push(Step::new(
            &window_y::KERNEL,
            label.clone(),
            window_y::Params { width, height, radius: self.radius },
            &[self.equations, window],
            &[(self.columns, five)],
        ));
        steps.push(Step::new(
            &solve_increment::KERNEL,
            label,
            solve_increment::Params { width, height, radius: self.radius, regular: REGULAR },
            &[self.columns, window_x, begin],
            &[(flow, two)],
        ));
    }
}

impl LevelFlow {
    fn new(bufs: &mut Bufs, levels: &[Level], finest: usize, k: usize) -> Self {
        let (size, own) = (levels[k].size, levels[finest].size);
        let two = Shape::planar(size, 2);
        Self {
            prediction: bufs.computed(format!("prediction, level {k}"), two),
            corrected: levels.get(k + 1).map(|Level { size: coarser, .. }| Corrected {
                place: [
                    bufs.constant(format!("columns of level {}", k + 1), tables::place(coarser.width, size.width)),
                    bufs.constant(format!("rows of level {}", k + 1), tables::place(coarser.height, size.height)),
                ],
                prediction: bufs.computed(format!("corrected prediction, level {k}"), two),
            }),
            coarse: (k > finest).then(|| Coarse {
                cover: [
                    bufs.constant(format!("columns of the prediction, level {k}"), tables::cover(own.width, size.width)),
                    bufs.constant(format!("rows of the prediction, level {k}"), tables::cover(own.height, size.height)),
                ],
                flow: bufs.computed(format!("flow, level {k}"), two),
            }),
        }
    }
}

fn reduction(from: Size, to: Size, scale: f64) -> downsample_flow::Params {
    downsample_flow::Params {
        width: to.width,
        height: to.height,
        in_width: from.width,
        in_height: from.height,
        scale: scale as f32,
    }
}

impl Stages for FlowFilterStages {
    fn ingest(&self, gray: BufId, certainty: Option<BufId>, slot: usize) -> Vec<Step> {
        self.images.steps(gray, certainty, slot)
    }

    fn pair(&self, parity: usize, slots: [usize; 2], initial: BufId, flow: BufId) -> Vec<Step> {
        let mut steps = Vec::new();
        self.predict(&mut steps, parity, initial);
        let finest = self.levels[self.finest];
        let filtered = match &self.start {
            Start::State { state, .. } => state[1 - parity],
            Start::Given { flow, .. } => *flow,
        };
        for k in (self.finest..self.levels.len()).rev() {
            let level = self.levels[k];
            let own = self.level(k);
            if let Some(Coarse { cover: [x, y], .. }) = own.coarse {
                steps.push(Step::new(
                    &downsample_flow::KERNEL,
                    format!("level {k}"),
                    reduction(finest.size, level.size, level.scale / finest.scale),
                    &[self.level(self.finest).prediction, x, y],
                    &[(own.prediction, Shape::planar(level.size, 2))],
                ));
            }
            let result = own.coarse.map_or(filtered, |coarse| coarse.flow);
            self.update(&mut steps, k, slots.map(|slot| self.images.level(k, slot)), result);
        }
        let params = upsample::Params {
            width: self.size.width,
            height: self.size.height,
            in_width: finest.size.width,
            in_height: finest.size.height,
            scale: (1.0 / finest.scale) as f32,
            channels: 2,
        };
        let [place_x, place_y] = self.enlarge;
        let output = [(flow, Shape::planar(self.size, 2))];
        steps.push(Step::new(&upsample::KERNEL, "flow", params, &[filtered, place_x, place_y], &output));
        if let Some((gradients, plane)) = &self.confidence {
            let pair = slots.map(|slot| self.images.level(0, slot));
            gradients.confidence(&mut steps, self.size, pair, flow, *plane);
        }
        steps
    }

    fn confidence(&self) -> Option<BufId> {
        self.confidence.as_ref().map(|(_, plane)| *plane)
    }

    fn evidence(&self, _slots: [usize; 2]) -> Evidence {
        Evidence::Confidence(Stages::confidence(self).unwrap_or_else(|| unreachable!("it was wanted")))
    }

    fn carried(&self) -> Vec<[BufId; 2]> {
        match &self.start {
            Start::State { state, .. } => vec![*state],
            Start::Given { .. } => Vec::new(),
        }
    }
}
