//! Adarve and Mahony's flow filter: each frame corrects what the previous flow predicts.
//!
//! The state is the flow. From frame to frame it moves along itself; then brightness, averaged over a small window, corrects
//! the prediction, to which it is held by γ. Where a coarser level finds that the prediction is far off, the finer ones begin
//! with its correction. Little is left to correct at a high frame rate, so one step per frame suffices, and noise is averaged
//! over time.

mod parameters;
mod stages;

use stages::FlowFilterStages;

use super::parameter::within;
use super::{Estimator, Stages, Wanted};
use crate::error::Result;
use crate::frame::Size;
use crate::plan::Bufs;

/// Parameters of [`flow-filter`](crate::flow): a prediction of the flow that each frame corrects, for 60 to 300 frames per
/// second.
///
/// J. D. Adarve and R. Mahony, A filter formulation for computing real time optical flow, IEEE Robotics and Automation
/// Letters 1(2), 2016. Here the second image is warped by the prediction, and equations are averaged over a window.
///
/// It needs a stream: the flow of a first pair, and of one after a reset, begins at zero motion and is drawn towards it by γ.
/// With a given initial flow that is the prediction, and nothing is kept from pair to pair; so it is on the view sphere with a
/// search primed by the gyro. If frames are derotated before the flow, the state still moves along the remaining flow only, and
/// rotation displaces it.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct FlowFilter {
    /// γ: the weight of the prediction on the finest computed level, in squared gray levels per pixel, 0.01 to 100000. More
    /// averages over more frames.
    pub gamma: f64,
    /// Width of the Gaussian window in pixels of its level, 3 to 63; its standard deviation is a fifth of that. An even width
    /// extends as far as the next odd one.
    pub winsize: u32,
    /// Levels beside the full image, each half the size of the next finer one, 0 to 32. Levels whose shorter side would be
    /// under 24 pixels are left out.
    pub levels: u32,
    /// Finest levels that are left out, 0 to 8: with 1 the flow is computed at half the size and enlarged.
    pub skip: u32,
}

impl FlowFilter {
    /// A quarter of the size.
    pub fn fast() -> Self {
        Self { skip: 2, ..Self::default() }
    }

    /// The full size, for fine detail.
    pub fn fine() -> Self {
        Self { gamma: 16.0, winsize: 19, skip: 0, ..Self::default() }
    }
}

impl Default for FlowFilter {
    fn default() -> Self {
        Self { gamma: 64.0, winsize: 13, levels: 3, skip: 1 }
    }
}

impl Estimator for FlowFilter {
    fn has_memory(&self) -> bool {
        true
    }

    fn validate(&self) -> Result<()> {
        within("gamma", self.gamma, 0.01, 1e5)?;
        within("winsize", self.winsize, 3, 63)?;
        within("levels", self.levels, 0, 32)?;
        within("skip", self.skip, 0, 8)
    }

    fn stages(&self, bufs: &mut Bufs, size: Size, wanted: Wanted) -> Box<dyn Stages> {
        Box::new(FlowFilterStages::new(bufs, self, size, wanted))
    }
}
