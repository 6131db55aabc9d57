//! Dense pyramidal Lucas–Kanade flow.
//!
//! B. Lucas and T. Kanade, An iterative image registration technique with an application to stereo vision, IJCAI 1981;
//! pyramid and warping after J.-Y. Bouguet, Pyramidal implementation of the Lucas Kanade feature tracker, 2001, here
//! for every pixel. Each iteration warps the second image by the flow so far. Each pixel's equations are linearized
//! around its own displacement, and the solution of a window is the one displacement that fits all of its pixels best.

use super::coarse_to_fine::{CoarseToFine, Iteration};
use super::parameter::{self, Choice, Parameter, Parameters, choice_name, choose, read, within};
use super::pyramid::Pyramid;
use super::{Estimator, Evidence, Level, Stages, Wanted, Window, levels};
use crate::error::{Error, Result};
use crate::frame::Size;
use crate::kernels::{confidence, gradient_equations, premultiply, solve, tables, unweight, warp, window_y};
use crate::plan::{BufId, Bufs, Shape, Step};

/// Parameters of dense pyramidal Lucas–Kanade flow.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct LucasKanade {
    /// The size of a level relative to the next finer one, in (0, 1).
    pub pyr_scale: f64,
    /// Levels beside the full image, 0 to 32. Levels whose shorter side would be under 32 pixels are left out.
    pub levels: u32,
    /// Width of the window in pixels, 2 to 1024. An even width extends as far as the next odd one.
    pub winsize: u32,
    /// Iterations (warps) on each level, 1 to 1000.
    pub iterations: u32,
    /// The window's shape.
    pub window: Window,
}

impl Default for LucasKanade {
    fn default() -> Self {
        Self { pyr_scale: 0.5, levels: 3, winsize: 21, iterations: 3, window: Window::Box }
    }
}

const WINDOWS: [(&str, Window); 2] = [("box", Window::Box), ("gaussian", Window::Gaussian)];

const fn number(name: &'static str, value_name: &'static str, help: &'static str) -> Parameter {
    Parameter { name, value_name, help, choices: &[] }
}

impl Parameters for LucasKanade {
    const NAME: &'static str = "lucas-kanade";
    const ABOUT: &'static str = "image gradients at every pixel, pyramidal with warping";
    const LIST: &'static [Parameter] = &[
        number("pyr_scale", "RATIO", "Size of a level relative to the next finer one, above 0 and below 1"),
        number("levels", "N", "Levels beside the full image, 0 to 32"),
        number("winsize", "PX", "Width of the averaging window in pixels, 2 to 1024"),
        number("iterations", "N", "Iterations on each level, 1 to 1000"),
        Parameter {
            name: "window",
            value_name: "NAME",
            help: "Shape of the averaging window",
            choices: &[
                ("box", "All neighbours have the same weight"),
                ("gaussian", "Near neighbours have more weight"),
            ],
        },
    ];
    const PRESETS: &'static [Choice] = &[
        ("fast", "Half the default's work: 1 iteration"),
        ("default", "3 iterations, winsize 21, 3 levels"),
        ("accurate", "Three times the default's work: 10 iterations, 5 levels"),
    ];

    fn preset(name: &str) -> Option<Self> {
        match name {
            "fast" => Some(Self { iterations: 1, ..Self::default() }),
            "default" => Some(Self::default()),
            "accurate" => Some(Self { iterations: 10, levels: 5, ..Self::default() }),
            _ => None,
        }
    }

    fn get(&self, name: &str) -> Option<String> {
        Some(match name {
            "pyr_scale" => self.pyr_scale.to_string(),
            "levels" => self.levels.to_string(),
            "winsize" => self.winsize.to_string(),
            "iterations" => self.iterations.to_string(),
            "window" => choice_name(&WINDOWS, self.window).to_owned(),
            _ => return None,
        })
    }

    fn set(&mut self, name: &str, value: &str) -> Result<()> {
        match name {
            "pyr_scale" => self.pyr_scale = read(Self::LIST, name, value)?,
            "levels" => self.levels = read(Self::LIST, name, value)?,
            "winsize" => self.winsize = read(Self::LIST, name, value)?,
            "iterations" => self.iterations = read(Self::LIST, name, value)?,
            "window" => self.window = choose(Self::LIST, &WINDOWS, name, value)?,
            _ => return Err(parameter::wrong(Self::LIST, name, value)),
        }
        Ok(())
    }
}

impl Estimator for LucasKanade {
    fn validate(&self) -> Result<()> {
        if !(self.pyr_scale > 0.0 && self.pyr_scale < 1.0) {
            return Err(Error::parameter("pyr_scale", self.pyr_scale, "a number above 0 and below 1"));
        }
        within("levels", self.levels, 0, 32)?;
        within("winsize", self.winsize, 2, 1024)?;
        within("iterations", self.iterations, 1, 1000)
    }

    fn stages(&self, bufs: &mut Bufs, size: Size, wanted: Wanted) -> Box<dyn Stages> {
        let levels = levels(size, self.pyr_scale, self.levels);
        let (plane, five) = (Shape::planar(size, 1), Shape::planar(size, 5));
        let pictures = |bufs: &mut Bufs, name: &str| -> Vec<[BufId; 2]> {
            let picture = |bufs: &mut Bufs, k: usize, level: &Level, frames: &str| {
                bufs.computed(format!("{name}, level {k}, {frames} frames"), Shape::planar(level.size, 1))
            };
            let level = |(k, level)| ["even", "odd"].map(|frames| picture(bufs, k, level, frames));
            levels.iter().enumerate().map(level).collect()
        };
        let window = tables::window(self.winsize, self.window == Window::Gaussian);
        let radius = window.len() / 2;
        Box::new(LucasKanadeStages {
            images: pictures(bufs, "image"),
            weighted: wanted.certainty.then(|| Weighted {
                full: [bufs.computed("weighted gray", plane), bufs.computed("clamped certainty", plane)],
                level: bufs.computed("level's weighted image", plane),
                certainties: pictures(bufs, "certainty"),
            }),
            known: (!wanted.certainty).then(|| bufs.constant("full certainty", vec![1.0; plane.len()])),
            pyramid: Pyramid::new(bufs, size, &levels),
            coarse_to_fine: CoarseToFine::new(bufs, &levels, self.pyr_scale, wanted, false),
            warped: bufs.computed("warped", plane),
            shown: bufs.computed("visible", plane),
            equations: bufs.computed("equations", five),
            columns: bufs.computed("averaged columns", five),
            window_y: bufs.constant("window, columns", tables::window_from(&window, radius)),
            window_x: bufs.constant("window, rows", tables::window_from(&window, radius.next_multiple_of(4))),
            confidence: (wanted.confidence || wanted.evidence).then(|| bufs.computed("confidence", plane)),
            radius: radius as u32,
            iterations: self.iterations,
            levels,
        })
    }
}

/// The buffers and steps of the method.
struct LucasKanadeStages {
    levels: Vec<Level>,
    iterations: u32,
    radius: u32,
    pyramid: Pyramid,
    coarse_to_fine: CoarseToFine,
    /// For each level, finest first, the buffers of both slots.
    images: Vec<[BufId; 2]>,
    weighted: Option<Weighted>,
    /// A certainty of 1 everywhere, for images without one.
    known: Option<BufId>,
    warped: BufId,
    shown: BufId,
    equations: BufId,
    columns: BufId,
    window_y: BufId,
    window_x: BufId,
    confidence: Option<BufId>,
}

/// The buffers that are needed only with a certainty.
struct Weighted {
    /// The image times its certainty, and the certainty clamped to its range.
    full: [BufId; 2],
    level: BufId,
    /// For each level, finest first, the buffers of both slots.
    certainties: Vec<[BufId; 2]>,
}

impl LucasKanadeStages {
    fn certainty(&self, k: usize, slot: usize) -> BufId {
        let of_level = self.weighted.as_ref().map(|weighted| weighted.certainties[k][slot]);
        of_level.or(self.known).unwrap_or_else(|| unreachable!("there is one of the two"))
    }

    /// The equations of a level with the second image warped by a flow, averaged along columns only, in `columns`.
    fn equations(&self, steps: &mut Vec<Step>, k: usize, label: &str, slots: [usize; 2], flow: BufId, residual: u32) {
        let size = self.levels[k].size;
        let (width, height) = (size.width, size.height);
        let (plane, five) = (Shape::planar(size, 1), Shape::planar(size, 5));
        let [first, second] = slots;
        steps.push(Step::new(
            &warp::KERNEL,
            label,
            warp::Params { width, height },
            &[self.images[k][second], self.certainty(k, second), flow],
            &[(self.warped, plane), (self.shown, plane)],
        ));
        steps.push(Step::new(
            &gradient_equations::KERNEL,
            label,
            gradient_equations::Params { width, height, residual },
            &[self.images[k][first], self.certainty(k, first), self.warped, self.shown, flow],
            &[(self.equations, five)],
        ));
        steps.push(Step::new(
            &window_y::KERNEL,
            label,
            window_y::Params { width, height, radius: self.radius },
            &[self.equations, self.window_y],
            &[(self.columns, five)],
        ));
    }
}

impl Stages for LucasKanadeStages {
    fn ingest(&self, gray: BufId, certainty: Option<BufId>, slot: usize) -> Vec<Step> {
        let mut steps = Vec::new();
        let (Some(weighted), Some(certainty)) = (&self.weighted, certainty) else {
            for (k, images) in self.images.iter().enumerate() {
                self.pyramid.reduce(&mut steps, k, gray, images[slot]);
            }
            return steps;
        };
        let size = self.levels[0].size;
        let [full, share] = weighted.full;
        steps.push(Step::new(
            &premultiply::KERNEL,
            "frame",
            premultiply::Params { width: size.width, height: size.height },
            &[gray, certainty],
            &[(full, Shape::planar(size, 1)), (share, Shape::planar(size, 1))],
        ));
        for (k, images) in self.images.iter().enumerate() {
            let size = self.levels[k].size;
            let of_level = weighted.certainties[k][slot];
            self.pyramid.reduce(&mut steps, k, full, weighted.level);
            self.pyramid.reduce(&mut steps, k, share, of_level);
            steps.push(Step::new(
                &unweight::KERNEL,
                format!("level {k}"),
                unweight::Params { width: size.width, height: size.height },
                &[weighted.level, of_level],
                &[(images[slot], Shape::planar(size, 1))],
            ));
        }
        steps
    }

    fn pair(&self, slots: [usize; 2], initial: BufId, flow: BufId) -> Vec<Step> {
        let mut steps = self.coarse_to_fine.steps(|_| self.iterations, initial, flow, |steps, iteration| {
            let Iteration { k, level, label, so_far, flow, .. } = iteration;
            self.equations(steps, k, &label, slots, so_far, 0);
            let params = solve::Params { width: level.size.width, height: level.size.height, radius: self.radius };
            let inputs = [self.columns, self.window_x];
            steps.push(Step::new(&solve::KERNEL, label, params, &inputs, &[(flow, Shape::planar(level.size, 2))]));
        });
        if let Some(plane) = self.confidence {
            self.equations(&mut steps, 0, "confidence", slots, flow, 1);
            let size = self.levels[0].size;
            let params = confidence::Params { width: size.width, height: size.height, radius: self.radius };
            let inputs = [self.columns, self.window_x];
            let output = [(plane, Shape::planar(size, 1))];
            steps.push(Step::new(&confidence::KERNEL, "confidence", params, &inputs, &output));
        }
        steps
    }

    fn confidence(&self) -> Option<BufId> {
        self.confidence
    }

    fn evidence(&self, _slots: [usize; 2]) -> Evidence {
        Evidence::Confidence(self.confidence.unwrap_or_else(|| unreachable!("it was wanted")))
    }
}
