//! Pyramidal Farnebäck flow, with OpenCV's semantics to the last border pixel.

mod displacement;
mod parameters;

use displacement::Displacement;

use super::expansions::{Expanded, Expansions};
use super::levels::levels_down_to;
use super::parameter::within;
use super::{Estimator, Evidence, Stages, Wanted, levels};
use crate::error::{Error, Result};
use crate::frame::Size;
use crate::plan::{BufId, Bufs, Shape, Step};

/// The window within which a pixel's neighbours are assumed to move alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Window {
    /// All neighbours have the same weight.
    Box,
    /// Near neighbours have more weight; the standard deviation is `0.3 · (winsize / 2)` pixels.
    Gaussian,
}

/// The quantity that an iteration's window averages. Here d is the flow so far, Δb = −½ (b2(x + d) − b1(x)), and A is
/// the mean of both frames' A.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Update {
    /// The flow: `(Σ AᵀA)⁻¹ Σ Aᵀ(Δb + A d)`, as in Farnebäck's paper and OpenCV. Where the flow changes within the
    /// window, the pixels with the most contrast dominate.
    Flow,
    /// The increment of the flow: `d + (Σ AᵀA)⁻¹ Σ AᵀΔb`. Changes within the window that the flow so far contains are
    /// kept, so that a window may be wider for the same detail, and fewer iterations suffice. One to three are
    /// suitable: each adds finer detail of flow and of noise. With more than one, [`Window::Box`] is an error: it
    /// inverts the sign of waves a little shorter than itself (its spectrum falls to −0.22 there), and each further
    /// iteration amplifies them. Where there is no texture at all, as in a cloudless sky, noise remains;
    /// [`Update::Flow`] finds nearly zero motion there.
    Increment,
    /// The increment of normalised equations: each of a pixel's two equations is divided by its own slope, so that its
    /// residual is a displacement in pixels and contrast does not decide
    /// ([`robust_equations`](crate::kernels::robust_equations), without robust weights), and expansions between pixels are
    /// continued along their Hessians. The error on public pairs is below that of OpenCV's DIS medium. Levels go down to a
    /// shorter side of 24 pixels. With more than one iteration, [`Window::Box`] is an error, as for increments.
    Normalized,
}

/// The model of the motion within the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Motion {
    /// All neighbours move alike.
    Constant,
    /// The motion is an affine function of the place: six unknowns in place of two. A wide window then follows slopes of the
    /// flow, as those of the ground. Neighbours outside the image have no weight. On the CPU backend
    /// a frame takes 1.3 to 2.2 times that of a constant motion, more with wide windows.
    Affine,
}

/// The treatment of the neighbourhoods that the image's border cuts off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Border {
    /// The border's pixels are repeated outside, as in OpenCV.
    Replicate,
    /// Pixels outside have no weight: normalised convolution with a certainty of 0 there (Farnebäck's paper, section 2). A frame
    /// takes 1.2 to 1.6 times as long. Alone it leaves outliers beside the border, where the second frame has no match for the
    /// estimate; [`Outside::Nothing`] leaves such pixels out.
    Normalized,
}

/// The shorter side of the smallest level with [`Update::Normalized`], in pixels.
const NORMALIZED_SMALLEST: f64 = 24.0;

/// The treatment of a pixel that the flow so far takes outside the second frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Outside {
    /// The first frame's expansion is used alone, with half its slope in place of the difference, as in OpenCV. The
    /// flow there is arbitrary; the confidence marks it as such.
    First,
    /// The pixel is left out: the window's other pixels decide.
    Nothing,
}

/// Parameters of pyramidal Farnebäck flow.
///
/// Names, ranges and meaning are those of OpenCV's `calcOpticalFlowFarneback`, as far as it has them. The source is
/// G. Farnebäck, Two-frame motion estimation based on polynomial expansion, SCIA 2003.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Farneback {
    /// The size of a level relative to the next finer one, in (0, 1).
    pub pyr_scale: f64,
    /// Levels beside the full image, 0 to 32. Levels whose shorter side would be under 32 pixels are left out; under 24 with
    /// [`Update::Normalized`].
    pub levels: u32,
    /// Width of the window in pixels, 2 to 1024. An even width extends as far as the next odd one.
    pub winsize: u32,
    /// Iterations on each level, 1 to 1000.
    pub iterations: u32,
    /// Radius of the polynomial expansion's neighbourhood in pixels, 1 to 32; usually 5 or 7.
    pub poly_n: u32,
    /// Standard deviation of the expansion's Gaussian in pixels, 0 to 100; 0 stands for `0.3 · poly_n`.
    pub poly_sigma: f64,
    /// The window's shape.
    pub window: Window,
    /// The quantity that the window averages.
    pub update: Update,
    /// The treatment of pixels outside the second frame.
    pub outside: Outside,
    /// The model of the motion within the window.
    pub motion: Motion,
    /// The treatment of neighbourhoods that the image's border cuts off.
    pub border: Border,
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
            motion: Motion::Constant,
            border: Border::Replicate,
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

    /// One iteration of [`Update::Normalized`] over a Gaussian window of 31 px, [`Outside::Nothing`], with a small
    /// neighbourhood of expansion: about half the default's work and .11 to .83 of its error on public pairs. Meant for scenes
    /// with texture everywhere.
    pub fn increment() -> Self {
        Self {
            levels: 32,
            winsize: 31,
            iterations: 1,
            poly_n: 3,
            poly_sigma: 1.0,
            window: Window::Gaussian,
            update: Update::Normalized,
            outside: Outside::Nothing,
            ..Self::default()
        }
    }

    /// The method of the 2003 paper: three iterations of an affine motion in a Gaussian window, expansions of 11 px, and
    /// normalised convolution at the border. The window has 45 px and a standard deviation of 6.6 px, where the paper has 39 and 6;
    /// the expansion's is 1.1 px, where it has 1.5. Levels are beyond the paper.
    pub fn affine() -> Self {
        Self {
            winsize: 45,
            poly_sigma: 1.1,
            window: Window::Gaussian,
            outside: Outside::Nothing,
            motion: Motion::Affine,
            border: Border::Normalized,
            ..Self::default()
        }
    }
}

impl Estimator for Farneback {
    fn validate(&self) -> Result<()> {
        if !(self.pyr_scale > 0.0 && self.pyr_scale < 1.0) {
            return Err(Error::parameter("pyr_scale", self.pyr_scale, "a number above 0 and below 1"));
        }
        within("poly_sigma", self.poly_sigma, 0.0, 100.0)?;
        within("levels", self.levels, 0, 32)?;
        within("winsize", self.winsize, 2, 1024)?;
        within("iterations", self.iterations, 1, 1000)?;
        within("poly_n", self.poly_n, 1, 32)?;
        if self.window == Window::Box && self.update != Update::Flow && self.iterations > 1 {
            let expected = "1 with a box window of increments, whose errors grow with each iteration, or a Gaussian window";
            return Err(Error::parameter("iterations", self.iterations, expected));
        }
        Ok(())
    }

    fn stages(&self, bufs: &mut Bufs, size: Size, wanted: Wanted) -> Box<dyn Stages> {
        let levels = match self.update {
            Update::Flow | Update::Increment => levels(size, self.pyr_scale, self.levels),
            Update::Normalized => levels_down_to(size, self.pyr_scale, self.levels, NORMALIZED_SMALLEST),
        };
        let certain = (self.border == Border::Normalized && !wanted.certainty)
            .then(|| bufs.constant("full certainty of the frame", vec![1.0; Shape::planar(size, 1).len()]));
        let wanted = Wanted { certainty: wanted.certainty || certain.is_some(), ..wanted };
        Box::new(FarnebackStages {
            certain,
            expansions: Expansions::new(
                bufs,
                Expanded {
                    poly_n: self.poly_n,
                    poly_sigma: self.poly_sigma,
                    unsmoothed: self.update == Update::Normalized,
                    outside: if self.border == Border::Normalized { 0.0 } else { 1.0 },
                    ..Expanded::default()
                },
                size,
                &levels,
                wanted.certainty,
            ),
            displacement: Displacement::new(bufs, self, &levels, wanted),
        })
    }
}

/// The buffers and steps of the method.
struct FarnebackStages {
    /// A certainty of 1 for frames without one, if borders need it.
    certain: Option<BufId>,
    expansions: Expansions,
    displacement: Displacement,
}

impl Stages for FarnebackStages {
    fn ingest(&self, gray: BufId, certainty: Option<BufId>, slot: usize) -> Vec<Step> {
        self.expansions.steps(gray, certainty.or(self.certain), slot)
    }

    fn pair(&self, _parity: usize, slots: [usize; 2], initial: BufId, flow: BufId) -> Vec<Step> {
        self.displacement.steps(&self.expansions, slots, initial, flow)
    }

    fn confidence(&self) -> Option<BufId> {
        self.displacement.confidence()
    }

    fn evidence(&self, slots: [usize; 2]) -> Evidence {
        let [first, second] = slots.map(|slot| self.expansions.level(0, slot));
        Evidence::Expansions([first.quad, first.cross_term, second.quad, second.cross_term])
    }
}
