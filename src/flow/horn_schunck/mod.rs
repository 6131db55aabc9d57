//! Horn and Schunck's global method: constancy of brightness and smoothness of the flow.
//!
//! The flow (u, v) minimises the sum over all pixels of (I_x u + I_y v + I_t)² + α² (‖∇u‖² + ‖∇v‖²), gray levels from 0 to
//! 255. Differences of neighbours stand for ∇, none across the border. Larger motion is found coarse to fine: each warp
//! linearises the first term at the flow so far, and the smoothness is always that of the whole flow. The minimum is that of
//! linear equations, which red-black over-relaxation solves.

mod parameters;
mod stages;

use stages::HornSchunckStages;

use super::parameter::within;
use super::{Estimator, Stages, Wanted};
use crate::error::{Error, Result};
use crate::frame::Size;
use crate::plan::Bufs;

/// Parameters of [`horn-schunck`](crate::flow): constant brightness and a smooth flow, over the whole image at once.
///
/// B. K. P. Horn and B. G. Schunck, Determining optical flow, Artificial Intelligence 17, 1981, for the energy; T. Brox,
/// A. Bruhn, N. Papenberg and J. Weickert, High accuracy optical flow estimation based on a theory for warping, ECCV 2004,
/// for warps and for robust penalties with lagged weights.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct HornSchunck {
    /// α, in gray levels of 255 for white: α² is the weight of smoothness, 0.1 to 1000. More suits noise and weak texture,
    /// less fine detail.
    pub alpha: f64,
    /// The penalty of both terms.
    pub penalty: Penalty,
    /// The size of a level relative to the next finer one, in (0, 1).
    pub pyr_scale: f64,
    /// Levels beside the full image, 0 to 32.
    pub levels: u32,
    /// Levels whose shorter side would be under this are left out, in pixels, 8 to 1024.
    pub smallest: u32,
    /// Warps on each level, 1 to 100. Robust weights are those of each warp's beginning.
    pub warps: u32,
    /// Sweeps of relaxation in each warp, an even number from 2 to 10000.
    pub sweeps: u32,
    /// ω: the step of a pixel relative to the one that solves its own equations, 1 to 1.99. The more sweeps, the nearer to
    /// 2 is best.
    pub omega: f64,
}

/// The penalty of the terms of [`HornSchunck`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "kebab-case"))]
pub enum Penalty {
    /// x²: the energy of 1981.
    Quadratic,
    /// 2 ε² √(1 + x²/ε²), which is that of Charbonnier, Blanc-Féraud, Aubert and Barlaud (IEEE Trans. Image Processing
    /// 1997): as the square up to ε, then in proportion to the magnitude, so that occlusions and edges of the flow count
    /// less. ε is half a gray level for brightness and .02 pixels per pixel for the flow's slopes.
    Robust,
}

impl HornSchunck {
    /// Two warps of 10 sweeps on each level.
    pub fn fast() -> Self {
        Self { warps: 2, sweeps: 10, ..Self::default() }
    }

    /// Five warps of 40 sweeps.
    pub fn accurate() -> Self {
        Self { warps: 5, sweeps: 40, ..Self::default() }
    }

    /// The robust penalty, with ten warps of 10 sweeps.
    pub fn robust() -> Self {
        Self { alpha: 12.0, penalty: Penalty::Robust, warps: 10, sweeps: 10, ..Self::default() }
    }

    /// The method of 1981: one level and one warp, for motion of a pixel or two.
    pub fn classic() -> Self {
        Self { alpha: 15.0, levels: 0, warps: 1, sweeps: 400, omega: 1.95, ..Self::default() }
    }
}

impl Default for HornSchunck {
    fn default() -> Self {
        Self {
            alpha: 14.0,
            penalty: Penalty::Quadratic,
            pyr_scale: 0.5,
            levels: 32,
            smallest: 16,
            warps: 3,
            sweeps: 20,
            omega: 1.9,
        }
    }
}

impl Estimator for HornSchunck {
    fn validate(&self) -> Result<()> {
        within("alpha", self.alpha, 0.1, 1000.0)?;
        if !(self.pyr_scale > 0.0 && self.pyr_scale < 1.0) {
            return Err(Error::parameter("pyr_scale", self.pyr_scale, "a number above 0 and below 1"));
        }
        within("levels", self.levels, 0, 32)?;
        within("smallest", self.smallest, 8, 1024)?;
        within("warps", self.warps, 1, 100)?;
        within("sweeps", self.sweeps, 2, 10_000)?;
        if !self.sweeps.is_multiple_of(2) {
            return Err(Error::parameter("sweeps", self.sweeps, "an even number from 2 to 10000"));
        }
        within("omega", self.omega, 1.0, 1.99)
    }

    fn stages(&self, bufs: &mut Bufs, size: Size, wanted: Wanted) -> Box<dyn Stages> {
        Box::new(HornSchunckStages::new(bufs, self, size, wanted))
    }
}
