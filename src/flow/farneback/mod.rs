//! Pyramidal Farnebäck flow, with OpenCV's semantics to the last border pixel.

mod certain;
mod expansion;
mod motion;

use expansion::{Expansion, Expansions};
use motion::Motion;

use crate::error::{Error, Result};
use crate::flow::levels::levels;
use crate::frame::{PixelFormat, Size};
use crate::kernels::luma;
use crate::plan::{BufId, Bufs, Plan, Shape, Step};

/// The window over which a pixel's neighbours are taken to move alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Window {
    /// All neighbours count the same.
    Box,
    /// Near neighbours count more; the standard deviation is `0.3 · (winsize / 2)` pixels.
    Gaussian,
}

/// What an iteration's window averages, with the flow so far d, Δb = −½ (b2(x + d) − b1(x)), and A the mean of both frames'.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Update {
    /// The flow: `(Σ AᵀA)⁻¹ Σ Aᵀ(Δb + A d)`, as Farnebäck and OpenCV do. Where the flow changes within the window, what has
    /// the most contrast decides.
    Flow,
    /// What is added to it: `d + (Σ AᵀA)⁻¹ Σ AᵀΔb`. What the flow so far knows of such changes is kept, so that a window
    /// may be wider for the same detail, and fewer iterations do. One to three suit it: with each, finer detail of flow and
    /// of noise remains. After one, [`Window::Box`] is refused: it turns round what has waves a little shorter than itself
    /// (its spectrum is there down to −0.22), and each further iteration makes more of those. Where there is no texture at
    /// all, as in a cloudless sky, noise is what remains, where [`Update::Flow`] finds next to no motion.
    Increment,
}

/// What a pixel counts for whose place, where the flow so far leads, is outside the second frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Outside {
    /// The first frame's expansion stands alone, with half its slope in place of the difference, as in OpenCV: what is found
    /// there is arbitrary, and a confidence tells it from the rest.
    First,
    /// Nothing: the window's other pixels decide.
    Nothing,
}

/// Parameters of pyramidal Farnebäck flow.
///
/// Names, ranges and meaning are those of OpenCV's `calcOpticalFlowFarneback`, as far as it has them. The source is
/// G. Farnebäck, Two-frame motion estimation based on polynomial expansion, SCIA 2003.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Farneback {
    /// A level's size against the next finer one, in (0, 1).
    pub pyr_scale: f64,
    /// Levels beside the full picture, 0 to 32. Levels whose shorter side would be under 32 pixels are left out.
    pub levels: u32,
    /// Width of the window in pixels, 2 to 1024. An even one reaches as far as the next odd one.
    pub winsize: u32,
    /// Iterations on each level, 1 to 1000.
    pub iterations: u32,
    /// Radius of the polynomial expansion's neighbourhood in pixels, 1 to 32. Usual are 5 and 7.
    pub poly_n: u32,
    /// Standard deviation of the expansion's Gaussian in pixels, 0 to 100; 0 stands for `0.3 · poly_n`.
    pub poly_sigma: f64,
    /// The window's shape.
    pub window: Window,
    /// What is averaged.
    pub update: Update,
    /// What happens outside the second frame.
    pub outside: Outside,
    /// Whether a pair begins with a given flow, or with that of the pair before, in place of none.
    pub initial_flow: bool,
    /// Whether each frame comes with a certainty of its pixels, a plane of values from 0 to 1. What lies outside that range
    /// is held within it, and what is not a number counts as 0.
    pub certainty: bool,
    /// Whether a confidence is computed beside the flow.
    pub confidence: bool,
}

impl Default for Farneback {
    fn default() -> Self {
        Self {
            pyr_scale: 0.5,
            levels: 3,
            winsize: 15,
            iterations: 3,
            poly_n: 5,
            poly_sigma: 1.2,
            window: Window::Box,
            update: Update::Flow,
            outside: Outside::First,
            initial_flow: false,
            certainty: false,
            confidence: false,
        }
    }
}

impl Farneback {
    /// About half the default's work, for slow computers.
    pub fn fast() -> Self {
        Self { iterations: 1, winsize: 13, ..Self::default() }
    }

    /// Two to three times the default's work, for recorded frames.
    pub fn accurate() -> Self {
        Self { levels: 5, winsize: 13, iterations: 10, poly_sigma: 1.1, ..Self::default() }
    }

    /// One iteration of [`Update::Increment`] over a Gaussian window of 31 px, [`Outside::Nothing`]: about half the default's
    /// work and .27 to .86 of its error on public pairs; made for scenes that have texture everywhere.
    pub fn increment() -> Self {
        Self {
            winsize: 31,
            iterations: 1,
            window: Window::Gaussian,
            update: Update::Increment,
            outside: Outside::Nothing,
            ..Self::default()
        }
    }

    /// Checks every parameter's range, and that errors do not grow with the iterations (see [`Update::Increment`]).
    ///
    /// # Errors
    /// [`Error::Parameter`], naming the first one that is out of range.
    pub fn validate(&self) -> Result<()> {
        if !(self.pyr_scale > 0.0 && self.pyr_scale < 1.0) {
            return Err(Error::parameter("pyr_scale", self.pyr_scale, "a number above 0 and below 1"));
        }
        if !(0.0..=100.0).contains(&self.poly_sigma) {
            return Err(Error::parameter("poly_sigma", self.poly_sigma, "0 to 100"));
        }
        for (name, value, low, high) in [
            ("levels", self.levels, 0, 32),
            ("winsize", self.winsize, 2, 1024),
            ("iterations", self.iterations, 1, 1000),
            ("poly_n", self.poly_n, 1, 32),
        ] {
            if !(low..=high).contains(&value) {
                return Err(Error::parameter(name, value, format_args!("{low} to {high}")));
            }
        }
        if (self.window, self.update) == (Window::Box, Update::Increment) && self.iterations > 1 {
            let expected = "1 where a box averages increments, as errors grow with each further one, or a Gaussian window";
            return Err(Error::parameter("iterations", self.iterations, expected));
        }
        Ok(())
    }

    /// The plan for frames of this size and format.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a parameter or size that is out of range.
    pub fn plan(&self, size: Size, format: PixelFormat) -> Result<Plan> {
        self.validate()?;
        size.validate()?;
        let mut bufs = Bufs::default();
        let frame = bufs.input("frame", luma::row_words(size, format) * size.height as usize);
        let gray = bufs.computed("gray", Shape::planar(size, 1));
        let certainty = self.certainty.then(|| bufs.input("certainty", Shape::planar(size, 1).len()));
        let first = bufs.computed("flow", Shape::planar(size, 2));
        let second = if self.initial_flow {
            bufs.computed("flow of odd frames", Shape::planar(size, 2))
        } else {
            first
        };
        let flow = [first, second];
        let parts = Parts::new(&mut bufs, self, size);
        let plan = Plan {
            size,
            flow_size: size,
            setup: Vec::new(),
            frame,
            certainty,
            motion: None,
            ingest: [0, 1].map(|parity| {
                let mut steps = vec![gray_step(size, format, frame, gray)];
                steps.extend(parts.expand(gray, certainty, parity));
                steps
            }),
            pair: [0, 1].map(|parity| parts.flow([1 - parity, parity], flow[1 - parity], flow[parity])),
            flow,
            initial_flow: self.initial_flow,
            confidence: parts.motion.confidence(),
            fields: Vec::new(),
            bufs: bufs.finish(),
        };
        plan.validate()?;
        Ok(plan)
    }
}

/// The brightness of a frame's pixels.
pub(crate) fn gray_step(size: Size, format: PixelFormat, frame: BufId, gray: BufId) -> Step {
    let params = luma::Params::new(size, format);
    Step::new(&luma::KERNEL, "frame", params, &[frame], &[(gray, Shape::planar(size, 1))])
}

/// The estimator's buffers and the steps that fill them, for plans that do more than flow.
///
/// Pictures are expanded into one of two slots, and the flow leads from the picture in one to that in the other.
pub(crate) struct Parts {
    expansions: Expansions,
    motion: Motion,
}

impl Parts {
    /// Of a configuration and size that are valid.
    pub(crate) fn new(bufs: &mut Bufs, config: &Farneback, size: Size) -> Self {
        let levels = levels(size, config.pyr_scale, config.levels);
        Self {
            expansions: Expansions::new(bufs, config, size, &levels),
            motion: Motion::new(bufs, config, &levels),
        }
    }

    /// The expansion of a gray picture into a slot. Its certainty is needed if the configuration asks for one.
    pub(crate) fn expand(&self, gray: BufId, certainty: Option<BufId>, slot: usize) -> Vec<Step> {
        self.expansions.steps(gray, certainty, slot)
    }

    /// The flow from the picture in the first slot to that in the second. It begins with the given one, if the
    /// configuration asks for one.
    pub(crate) fn flow(&self, slots: [usize; 2], given: BufId, flow: BufId) -> Vec<Step> {
        self.motion.steps(&self.expansions, slots, given, flow)
    }

    /// The expansion of the full picture in a slot.
    pub(crate) fn finest(&self, slot: usize) -> Expansion {
        self.expansions.levels[0][slot]
    }
}
