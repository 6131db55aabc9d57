//! The parameters of corner detection.

use crate::error::{Error, Result};

/// The corner response of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum CornerResponse {
    /// The smaller eigenvalue of the gradients' covariance (Shi and Tomasi 1994).
    #[default]
    MinEigenvalue,
    /// Its determinant less `k` times its squared trace (Harris and Stephens 1988).
    Harris {
        /// The weight of the squared trace, usually 0.04 to 0.06.
        k: f64,
    },
}

/// The parameters of corner detection, as in OpenCV's `goodFeaturesToTrack`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CornerParameters {
    /// The most corners, the strongest ones; 0 for no limit.
    pub max_corners: usize,
    /// The least response relative to the image's largest, above 0 and up to 1.
    pub quality_level: f64,
    /// The least distance between corners in pixels, 0 to 16384. Below 1 it has no effect.
    pub min_distance: f64,
    /// The side in pixels of the block over which the covariance is summed, 1 to 64.
    pub block_size: u32,
    /// The corner response.
    pub response: CornerResponse,
}

impl Default for CornerParameters {
    fn default() -> Self {
        Self {
            max_corners: 500,
            quality_level: 0.01,
            min_distance: 7.0,
            block_size: 3,
            response: CornerResponse::MinEigenvalue,
        }
    }
}

impl CornerParameters {
    /// Checks every parameter's range.
    ///
    /// # Errors
    /// [`Error::Parameter`] naming the first one that is out of range or NaN.
    pub fn validate(&self) -> Result<()> {
        if !(self.quality_level > 0.0 && self.quality_level <= 1.0) {
            return Err(Error::parameter(
                "quality_level",
                self.quality_level,
                "a number above 0 and up to 1",
            ));
        }
        if !(0.0..=16384.0).contains(&self.min_distance) {
            return Err(Error::parameter("min_distance", self.min_distance, "0 to 16384 px"));
        }
        if !(1..=64).contains(&self.block_size) {
            return Err(Error::parameter("block_size", self.block_size, "1 to 64 px"));
        }
        match self.response {
            CornerResponse::Harris { k } if !(0.0..=1.0).contains(&k) => {
                Err(Error::parameter("k", k, "0 to 1"))
            }
            _ => Ok(()),
        }
    }
}
