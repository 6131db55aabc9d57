//! Dense pyramidal Lucas–Kanade flow.
//!
//! B. Lucas and T. Kanade, An iterative image registration technique with an application to stereo vision, IJCAI 1981;
//! pyramid and warping after J.-Y. Bouguet, Pyramidal implementation of the Lucas Kanade feature tracker, 2001, here
//! for every pixel. Each iteration warps the second image by the flow so far. Each pixel's equations are linearized
//! around its own displacement, and the solution of a window is the one displacement that fits all of its pixels best.

use super::coarse_to_fine::{CoarseToFine, Iteration};
use super::gradients::Gradients;
use super::images::Images;
use super::parameter::{self, Choice, Parameter, Parameters, choice_name, choose, read, within};
use super::{Estimator, Evidence, Stages, Wanted, Window, levels};
use crate::error::{Error, Result};
use crate::frame::Size;
use crate::kernels::solve;
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

impl Parameters for LucasKanade {
    const NAME: &'static str = "lucas-kanade";
    const ABOUT: &'static str = "image gradients at every pixel, pyramidal with warping";
    const LIST: &'static [Parameter] = &[
        Parameter::number("pyr_scale", "RATIO", "Size of a level relative to the next finer one, above 0 and below 1"),
        Parameter::number("levels", "N", "Levels beside the full image, 0 to 32"),
        Parameter::number("winsize", "PX", "Width of the averaging window in pixels, 2 to 1024"),
        Parameter::number("iterations", "N", "Iterations on each level, 1 to 1000"),
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
        let plane = Shape::planar(size, 1);
        Box::new(LucasKanadeStages {
            images: Images::new(bufs, size, &levels, |_| true, wanted),
            coarse_to_fine: CoarseToFine::new(bufs, &levels, self.pyr_scale, wanted, |_| 0),
            gradients: Gradients::new(bufs, size, self.winsize, self.window == Window::Gaussian),
            confidence: (wanted.confidence || wanted.evidence).then(|| bufs.computed("confidence", plane)),
            iterations: self.iterations,
            size,
        })
    }
}

/// The buffers and steps of the method.
struct LucasKanadeStages {
    size: Size,
    iterations: u32,
    images: Images,
    coarse_to_fine: CoarseToFine,
    gradients: Gradients,
    confidence: Option<BufId>,
}

impl Stages for LucasKanadeStages {
    fn ingest(&self, gray: BufId, certainty: Option<BufId>, slot: usize) -> Vec<Step> {
        self.images.steps(gray, certainty, slot)
    }

    fn pair(&self, _parity: usize, slots: [usize; 2], initial: BufId, flow: BufId) -> Vec<Step> {
        let gradients = &self.gradients;
        let pair = |k: usize| slots.map(|slot| self.images.level(k, slot));
        let mut steps = self.coarse_to_fine.steps(|_| self.iterations, initial, flow, |steps, iteration| {
            let Iteration { k, level, label, so_far, flow, .. } = iteration;
            gradients.steps(steps, &label, level.size, pair(k), so_far, 0);
            let Size { width, height } = level.size;
            let params = solve::Params { width, height, radius: gradients.radius };
            let inputs = [gradients.columns, gradients.window_x];
            steps.push(Step::new(&solve::KERNEL, label, params, &inputs, &[(flow, Shape::planar(level.size, 2))]));
        });
        if let Some(plane) = self.confidence {
            gradients.confidence(&mut steps, self.size, pair(0), flow, plane);
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
