//! The buffers and steps of the method.

use super::FarnebackTv;
use super::buffers::{Confidence, Fit, Slopes, Window};
use super::iterations::{iterations, warped, warps};
use super::memory::{PreviousFlow, ThirdFrame};
use crate::flow::coarse_to_fine::{CoarseToFine, Iteration};
use crate::flow::expansions::{Expanded, Expansion, Expansions};
use crate::flow::levels::levels_down_to;
use crate::flow::{Evidence, Level, Stages, Wanted};
use crate::frame::Size;
use crate::kernels::{
    expected_slope, fit_weight, links, misfit, nonlocal, robust_equations, slope_weights, smoothness, solve_increment, sweep,
    upsample, weighted_robust_equations, window_y,
};
use crate::plan::{BufId, Bufs, Shape, Step};

/// Radius and standard deviation in pixels of the neighbourhood that is expanded.
const POLY: (u32, f64) = (2, 1.0);
/// Radius and standard deviation in pixels of the window of the first increment on each level.
const INCREMENT_WINDOW: (usize, f64) = (8, 2.5);
/// Slopes are averaged on levels of this scale and coarser ones.
const SLOPE_SCALE: f64 = 0.25;
/// The share of its Hessian by which an expansion is continued to a place between pixels.
pub(super) const KAPPA: f32 = 0.3;
/// ζ²: the floor of the squared slope that divides an equation.
pub(super) const FLOOR: f32 = 0.25;
/// ε²: the squared residual, in square pixels, up to which the equations' robust weight is nearly constant.
pub(super) const ROBUST: f32 = 0.01;
/// What is added to the determinant of a window's equations.
const REGULAR: f32 = 1e-6;
/// The squared difference of slopes at which their weight in the mean is ½.
const SLOPE_SPREAD: f32 = 9e-6;
/// Over-relaxation.
const OMEGA: f32 = 1.95;

/// The buffers and steps of the method.
pub(super) struct FarnebackTvStages {
    config: FarnebackTv,
    levels: Vec<Level>,
    /// The number of the finest computed level.
    finest: usize,
    /// How many levels, from that one on, end with a non-local step.
    nonlocal: usize,
    expansions: Expansions,
    coarse_to_fine: CoarseToFine,
    equations: BufId,
    columns: BufId,
    increment: Window,
    slopes: Slopes,
    smooth_weight: BufId,
    system: BufId,
    link: BufId,
    fit: Option<Fit>,
    confidence: Option<Confidence>,
    /// The certainty of frames that have none.
    full_certainty: Option<BufId>,
    third_frame: Option<ThirdFrame>,
    previous_flow: Option<PreviousFlow>,
}

/// The images of a pair.
#[derive(Clone, Copy)]
struct Images {
    /// The parity of the later one's frame.
    parity: usize,
    /// The slot of the first one.
    first_slot: usize,
    /// Their expansions on a level.
    expansions: [Expansion; 2],
}

impl FarnebackTvStages {
    pub(super) fn new(bufs: &mut Bufs, config: &FarnebackTv, size: Size, wanted: Wanted) -> Self {
        let levels = levels_down_to(size, config.pyr_scale, 64, f64::from(config.smallest));
        let finest = (config.skip as usize).min(levels.len() - 1);
        let nonlocal = levels[finest..].iter().filter(|level| level.scale >= config.nonlocal_scale - 1e-9).count();
        let nonlocal = if config.samples > 0 { nonlocal } else { 0 };
        let iterations = |k: usize| iterations(config, k, finest, nonlocal);
        let expanded = Expanded {
            poly_n: POLY.0,
            poly_sigma: POLY.1,
            unsmoothed: true,
            skip: finest,
            kept_images: nonlocal,
            outside: 1.0,
        };
        let own = levels[finest].size;
        let [one, two, five] = [1, 2, 5].map(|channels| Shape::planar(own, channels));
        let confidence = wanted.confidence || wanted.evidence;
        Self {
            config: config.clone(),
            expansions: Expansions::new(bufs, expanded, size, &levels, wanted.certainty),
            coarse_to_fine: CoarseToFine::new(bufs, &levels, config.pyr_scale, wanted, iterations),
            equations: bufs.computed("equations", five),
            columns: bufs.computed("averaged columns", five),
            increment: Window::new(bufs, "window of increments", INCREMENT_WINDOW),
            slopes: Slopes::new(bufs, &levels, finest),
            smooth_weight: bufs.computed("smoothness", one),
            system: bufs.computed("system", five),
            link: bufs.computed("links", two),
            fit: (nonlocal > 0 || confidence).then(|| Fit::new(bufs, own, nonlocal > 0)),
            confidence: confidence.then(|| Confidence::new(bufs, own, size)),
            full_certainty: (!wanted.certainty && (nonlocal > 0 || confidence || config.third_frame > 0.0))
                .then(|| bufs.constant("full certainty", vec![1.0; one.len()])),
            third_frame: (config.third_frame > 0.0)
                .then(|| ThirdFrame::new(bufs, config, &levels, finest, wanted)),
            previous_flow: (config.carry > 0.0).then(|| PreviousFlow::new(bufs, config, own, wanted)),
            finest,
            nonlocal,
            levels,
        }
    }

    /// Whether a computed level ends with a non-local step.
    fn is_nonlocal(&self, k: usize) -> bool {
        k < self.finest + self.nonlocal
    }

    fn iterations(&self, k: usize) -> u32 {
        iterations(&self.config, k, self.finest, self.nonlocal)
    }

    /// The writes of the flow up to the last warp.
    fn warped(&self, k: usize) -> u32 {
        warped(&self.config, k, self.finest)
    }

    /// The certainty of an expansion.
    fn certainty(&self, expansion: Expansion) -> BufId {
        self.full_certainty.or(expansion.certainty).unwrap_or_else(|| unreachable!("there is one of the two"))
    }

    /// The buffer of the equations that are solved.
    fn solved_equations(&self) -> BufId {
        self.third_frame.as_ref().map_or(self.equations, |third| third.equations)
    }

    /// The buffer of the slopes that are expected on a level, once its first iteration has run.
    fn slope(&self, k: usize) -> BufId {
        match k + 1 == self.levels.len() && !self.averages_slopes(k) {
            true => self.slopes.zero,
            false => self.slopes.of_level[k],
        }
    }

    fn averages_slopes(&self, k: usize) -> bool {
        self.levels[k].scale <= SLOPE_SCALE + 1e-6 && warps(&self.config, k, self.finest) > 0
    }

    fn iterate(&self, steps: &mut Vec<Step>, iteration: &Iteration, pair: Images) {
        let (k, warped) = (iteration.k, self.warped(iteration.k));
        if iteration.number == 1 {
            self.read_slopes(steps, iteration);
            self.increment(steps, iteration, pair);
        } else if iteration.number == warped + 1 && self.is_nonlocal(k) {
            self.nonlocal(steps, iteration, pair);
        } else if iteration.number > warped {
            steps.extend(self.previous_flow.iter().map(|previous| previous.step(pair.parity, iteration)));
        } else {
            if iteration.number.is_multiple_of(2) {
                self.equations(steps, iteration, pair);
                self.smoothness(steps, iteration, pair.expansions[0]);
            }
            let size = iteration.level.size;
            steps.push(Step::new(
                &sweep::KERNEL,
                iteration.label.clone(),
                sweep::Params { width: size.width, height: size.height, omega: OMEGA },
                &[self.system, self.link, iteration.so_far],
                &[(iteration.flow, Shape::planar(size, 2))],
            ));
        }
    }

    /// The step that takes over the coarser level's expected slopes.
    fn read_slopes(&self, steps: &mut Vec<Step>, iteration: &Iteration) {
        let (k, size) = (iteration.k, iteration.level.size);
        let (Some([place_x, place_y]), Some(coarser)) = (self.slopes.place[k], self.levels.get(k + 1)) else {
            return;
        };
        let params = upsample::Params {
            width: size.width,
            height: size.height,
            in_width: coarser.size.width,
            in_height: coarser.size.height,
            scale: 1.0,
            channels: 4,
        };
        let output = [(self.slopes.of_level[k], Shape::planar(size, 4))];
        let inputs = [self.slope(k + 1), place_x, place_y];
        steps.push(Step::new(&upsample::KERNEL, iteration.label.clone(), params, &inputs, &output));
    }

    fn equations(&self, steps: &mut Vec<Step>, iteration: &Iteration, pair: Images) {
        let [first, second] = pair.expansions;
        let size = iteration.level.size;
        let params = robust_equations::Params {
            width: size.width,
            height: size.height,
            kappa: KAPPA,
            floor: FLOOR,
            robust: ROBUST,
            outside: 0.0,
            border: if iteration.number == 1 { 1.0 } else { 0.0 },
        };
        let output = [(self.equations, Shape::planar(size, 5))];
        let label = iteration.label.clone();
        steps.push(match (first.certainty, second.certainty) {
            (Some(certainty_0), Some(certainty_1)) => Step::new(
                &weighted_robust_equations::KERNEL,
                label,
                params,
                &[
                    first.quad,
                    first.cross_term,
                    certainty_0,
                    second.quad,
                    second.cross_term,
                    certainty_1,
                    iteration.so_far,
                ],
                &output,
            ),
            _ => Step::new(
                &robust_equations::KERNEL,
                label,
                params,
                &[first.quad, first.cross_term, second.quad, second.cross_term, iteration.so_far],
                &output,
            ),
        });
        if let Some(third) = &self.third_frame {
            third.add(steps, pair.parity, iteration, first, [self.certainty(first), self.equations]);
        }
    }

    /// The increment that solves the equations averaged over a window.
    fn increment(&self, steps: &mut Vec<Step>, iteration: &Iteration, pair: Images) {
        self.equations(steps, iteration, pair);
        let (width, height) = (iteration.level.size.width, iteration.level.size.height);
        let radius = self.increment.radius as u32;
        self.average_columns(steps, iteration, &self.increment);
        steps.push(Step::new(
            &solve_increment::KERNEL,
            iteration.label.clone(),
            solve_increment::Params { width, height, radius, regular: REGULAR },
            &[self.columns, self.increment.x, iteration.so_far],
            &[(iteration.flow, Shape::planar(iteration.level.size, 2))],
        ));
    }

    fn average_columns(&self, steps: &mut Vec<Step>, iteration: &Iteration, window: &Window) {
        let Size { width, height } = iteration.level.size;
        steps.push(Step::new(
            &window_y::KERNEL,
            iteration.label.clone(),
            window_y::Params { width, height, radius: window.radius as u32 },
            &[self.solved_equations(), window.y],
            &[(self.columns, Shape::planar(iteration.level.size, 5))],
        ));
    }

    /// The equations that hold neighbours to each other, from those of each pixel, in `system` and `link`.
    fn smoothness(&self, steps: &mut Vec<Step>, iteration: &Iteration, first: Expansion) {
        let Iteration { k, level, so_far, ref label, .. } = *iteration;
        let Size { width, height } = level.size;
        let [one, two, four, five] = [1, 2, 4, 5].map(|channels| Shape::planar(level.size, channels));
        let coarsest = k + 1 == self.levels.len();
        if self.averages_slopes(k) {
            // The equations are needed after it; their average is not.
            let params = slope_weights::Params { width, height, spread: SLOPE_SPREAD };
            let before = if coarsest && iteration.number == 2 { self.slopes.zero } else { self.slope(k) };
            let inputs = [so_far, before];
            steps.push(Step::new(&slope_weights::KERNEL, label.clone(), params, &inputs, &[(self.system, five)]));
            let window = &self.slopes.window;
            let radius = window.radius as u32;
            let params = window_y::Params { width, height, radius };
            let output = [(self.columns, five)];
            steps.push(Step::new(&window_y::KERNEL, label.clone(), params, &[self.system, window.y], &output));
            let params = expected_slope::Params { width, height, radius };
            let output = [(self.slopes.of_level[k], four)];
            steps.push(Step::new(&expected_slope::KERNEL, label.clone(), params, &[self.columns, window.x], &output));
        }
        let slope = self.slope(k);
        let params = smoothness::Params {
            width,
            height,
            alpha: self.config.alpha as f32,
            beta: 0.1,
            edge: 1.0 / (15.0 * 15.0),
            robust: 0.005 * 0.005,
        };
        let inputs = [so_far, slope, first.quad];
        steps.push(Step::new(&smoothness::KERNEL, label.clone(), params, &inputs, &[(self.smooth_weight, one)]));
        let inputs = [self.solved_equations(), so_far, self.smooth_weight, slope];
        let outputs = [(self.system, five), (self.link, two)];
        steps.push(Step::new(&links::KERNEL, label.clone(), links::Params { width, height }, &inputs, &outputs));
    }

    /// The misfit of a level's flow, in the buffers of `fit`.
    fn misfit(&self, steps: &mut Vec<Step>, label: &str, level: Level, pair: [Expansion; 2], flow: BufId) {
        let Some(fit) = &self.fit else { return };
        let [first, second] = pair;
        let (width, height, plane) = (level.size.width, level.size.height, Shape::planar(level.size, 1));
        let certainty = self.certainty(first);
        steps.push(Step::new(
            &misfit::KERNEL,
            label,
            misfit::Params { width, height, kappa: KAPPA, floor: FLOOR },
            &[first.quad, first.cross_term, second.quad, second.cross_term, certainty, flow],
            &[(fit.squared_misfit, plane), (fit.agreement, plane)],
        ));
    }

    fn nonlocal(&self, steps: &mut Vec<Step>, iteration: &Iteration, pair: Images) {
        let Iteration { k, level, so_far, flow, ref label, .. } = *iteration;
        let (Some(fit), Some(images)) = (&self.fit, self.expansions.images[k]) else { return };
        let Some(weight) = fit.weight else { return };
        self.misfit(steps, label, level, pair.expansions, so_far);
        let Size { width, height } = level.size;
        let plane = [(weight, Shape::planar(level.size, 1))];
        let params = fit_weight::Params { width, height };
        steps.push(Step::new(&fit_weight::KERNEL, label.clone(), params, &[fit.squared_misfit], &plane));
        // The nearness of samples falls off with their spacing.
        let sigma = if self.config.spacing < 3 { 7.0 } else { 9.0_f32 };
        let params = nonlocal::Params {
            width,
            height,
            radius: self.config.samples,
            spacing: self.config.spacing,
            rounds: if self.config.samples > 2 { 4 } else { 3 },
            nearness: -std::f32::consts::LOG2_E / (2.0 * sigma * sigma),
            tone: 1.0 / (20.0 * 20.0),
            robust: 0.05 * 0.05,
        };
        let inputs = [so_far, self.slope(k), images[pair.first_slot], weight];
        let output = [(flow, Shape::planar(level.size, 2))];
        steps.push(Step::new(&nonlocal::KERNEL, label.clone(), params, &inputs, &output));
    }

    /// The steps of the confidence, from the flow of the finest computed level.
    fn judge(&self, steps: &mut Vec<Step>, pair: [Expansion; 2], flow: BufId) {
        let (Some(fit), Some(confidence)) = (&self.fit, &self.confidence) else { return };
        let level = self.levels[self.finest];
        self.misfit(steps, Confidence::LABEL, level, pair, flow);
        confidence.judge(steps, fit.agreement, flow, self.levels[0].size);
    }
}

impl Stages for FarnebackTvStages {
    fn ingest(&self, gray: BufId, certainty: Option<BufId>, slot: usize) -> Vec<Step> {
        self.expansions.steps(gray, certainty, slot)
    }

    fn pair(&self, parity: usize, slots: [usize; 2], initial: BufId, flow: BufId) -> Vec<Step> {
        let expansions = |k: usize| slots.map(|slot| self.expansions.level(k, slot));
        let iterations = |k: usize| self.iterations(k);
        let mut steps = self.coarse_to_fine.steps(iterations, initial, flow, |steps, iteration| {
            let pair = Images { parity, first_slot: slots[0], expansions: expansions(iteration.k) };
            self.iterate(steps, &iteration, pair);
        });
        let finest = self.coarse_to_fine.flow(self.finest).unwrap_or(flow);
        self.judge(&mut steps, expansions(self.finest), finest);
        if let Some(third) = &self.third_frame {
            for (k, level) in self.levels.iter().enumerate().skip(self.finest) {
                let kept = expansions(k)[third.kept];
                third.keep(&mut steps, parity, (k, level.size), kept, self.certainty(kept));
            }
        }
        steps
    }

    fn confidence(&self) -> Option<BufId> {
        self.confidence.as_ref().map(|confidence| confidence.plane)
    }

    fn evidence(&self, _slots: [usize; 2]) -> Evidence {
        let plane = self.confidence.as_ref().map(|confidence| confidence.plane);
        Evidence::Confidence(plane.unwrap_or_else(|| unreachable!("it was wanted")))
    }

    fn carried(&self) -> Vec<[BufId; 2]> {
        let expansions = self.third_frame.iter().flat_map(ThirdFrame::carried);
        expansions.chain(self.previous_flow.iter().map(|previous| previous.state)).collect()
    }
}
