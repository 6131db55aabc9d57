//! Farnebäck's equations, normalised and robust, with total-variation smoothness.
//!
//! Each level begins with one windowed increment. A few warps follow: the equations of each pixel are solved together with a
//! smoothness between neighbours by red-black sweeps. Smoothness is robust (a total variation), lower at the image's edges,
//! and acts on the difference from expected slopes, which coarse levels average and finer ones take over. A non-local step
//! ends the finest levels.

mod buffers;
mod iterations;
mod memory;
mod parameters;
mod stages;

use stages::FarnebackTvStages;

use super::parameter::within;
use super::{Estimator, Stages, Wanted};
use crate::error::{Error, Result};
use crate::frame::Size;
use crate::plan::Bufs;

/// Parameters of [`farneback_tv`](crate::flow): polynomial expansions with total-variation smoothness.
///
/// G. Farnebäck, Two-frame motion estimation based on polynomial expansion, SCIA 2003, for the equations; T. Brox, A. Bruhn,
/// N. Papenberg, J. Weickert, High accuracy optical flow estimation based on a theory for warping, ECCV 2004, for warps and
/// robust functions; D. Sun, S. Roth, M. Black, Secrets of optical flow estimation and their principles, CVPR 2010, for the
/// non-local step.
///
/// [`third_frame`](Self::third_frame) and [`carry`](Self::carry) need a stream, in which the image of a point moves nearly as far
/// in one pair as in the next: the first pair, and one after a reset, has neither an older frame nor an earlier flow. If frames
/// are derotated before the flow, a third frame is refused, because the older image would have to be turned too.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct FarnebackTv {
    /// The size of a level relative to the next finer one, in (0, 1).
    pub pyr_scale: f64,
    /// Levels whose shorter side would be under this are left out, in pixels, 8 to 1024.
    pub smallest: u32,
    /// Finest levels that are left out, 0 to 8: with 1 the flow is computed at half the size and enlarged.
    pub skip: u32,
    /// Warps on the finest computed level, 0 to 100.
    pub warps: u32,
    /// Warps on each coarser level, 0 to 100.
    pub coarse_warps: u32,
    /// α: the weight of smoothness, above 0, at most 1000. Less suits thin things, more smooth scenes.
    pub alpha: f64,
    /// Radius of the non-local step's grid in samples, 0 to 3; 0 leaves the step out.
    pub samples: u32,
    /// The distance of neighbouring samples in pixels, 1 to 16.
    pub spacing: u32,
    /// The smallest scale of the levels that end with a non-local step, 0 to 1.
    pub nonlocal_scale: f64,
    /// The weight, beside the pair's equations, of those of the frame before it, 0 to 1; 0 leaves it out.
    pub third_frame: f64,
    /// The weight of the previous pair's flow where it equals the new one, 0 to 1; 0 leaves it out. It falls to half where they
    /// differ by 0.2 px.
    pub carry: f64,
}

impl FarnebackTv {
    /// Half the size, without a non-local step: about the time of DIS fast, with less error than DIS medium.
    pub fn fast() -> Self {
        Self { skip: 1, warps: 1, coarse_warps: 2, samples: 0, ..Self::accurate() }
    }

    /// Half the size, with a non-local step.
    pub fn half() -> Self {
        Self { skip: 1, warps: 3, coarse_warps: 3, ..Self::accurate() }
    }

    /// Full size, one warp, without a non-local step.
    pub fn light() -> Self {
        Self { warps: 1, coarse_warps: 2, samples: 0, ..Self::accurate() }
    }

    /// Full size, one warp, with a non-local step.
    pub fn medium() -> Self {
        Self { warps: 1, coarse_warps: 2, ..Self::accurate() }
    }

    /// Full size, two warps, with a non-local step.
    pub fn accurate() -> Self {
        Self {
            pyr_scale: 0.5,
            smallest: 24,
            skip: 0,
            warps: 2,
            coarse_warps: 3,
            alpha: 1.5,
            samples: 2,
            spacing: 3,
            nonlocal_scale: 0.5,
            third_frame: 0.0,
            carry: 0.0,
        }
    }

    /// As [`FarnebackTv::accurate`], for thin things.
    pub fn fine() -> Self {
        Self { alpha: 1.2, spacing: 2, ..Self::accurate() }
    }

    /// More levels, warps and samples, for recorded frames.
    pub fn best() -> Self {
        Self {
            pyr_scale: 0.7,
            smallest: 16,
            warps: 3,
            coarse_warps: 3,
            alpha: 1.7,
            samples: 3,
            spacing: 3,
            nonlocal_scale: 0.0,
            ..Self::accurate()
        }
    }
}

impl Default for FarnebackTv {
    fn default() -> Self {
        Self::light()
    }
}

impl Estimator for FarnebackTv {
    fn validate(&self) -> Result<()> {
        if !(self.pyr_scale > 0.0 && self.pyr_scale < 1.0) {
            return Err(Error::parameter("pyr_scale", self.pyr_scale, "a number above 0 and below 1"));
        }
        within("smallest", self.smallest, 8, 1024)?;
        within("skip", self.skip, 0, 8)?;
        within("warps", self.warps, 0, 100)?;
        within("coarse_warps", self.coarse_warps, 0, 100)?;
        if !(self.alpha > 0.0 && self.alpha <= 1000.0) {
            return Err(Error::parameter("alpha", self.alpha, "a number above 0, at most 1000"));
        }
        within("samples", self.samples, 0, 3)?;
        within("spacing", self.spacing, 1, 16)?;
        within("nonlocal_scale", self.nonlocal_scale, 0.0, 1.0)?;
        within("third_frame", self.third_frame, 0.0, 1.0)?;
        within("carry", self.carry, 0.0, 1.0)
    }

    fn has_memory(&self) -> bool {
        self.frames() > 2 || self.carry > 0.0
    }

    fn frames(&self) -> u32 {
        if self.third_frame > 0.0 { 3 } else { 2 }
    }

    fn stages(&self, bufs: &mut Bufs, size: Size, wanted: Wanted) -> Box<dyn Stages> {
        Box::new(FarnebackTvStages::new(bufs, self, size, wanted))
    }
}
