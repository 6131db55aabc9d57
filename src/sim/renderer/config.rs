use crate::error::{Error, Result};

/// The configuration of a [`Renderer`](super::Renderer).
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct RendererConfig {
    /// Standard deviation of a pixel's noise, in gray levels of 255: 0 to 64.
    pub noise_levels: f64,
    /// The number of poses averaged per exposure, 1 to 8: see [`Renderer::expose`](super::Renderer::expose). 1 means
    /// no motion blur.
    pub blur_poses: usize,
    /// The visible range, metres: surfaces whose nearest point is further away are not shown. Above 0, infinite by
    /// default.
    pub range_m: f64,
}

impl Default for RendererConfig {
    fn default() -> Self {
        Self { noise_levels: 2.0, blur_poses: 1, range_m: f64::INFINITY }
    }
}

impl RendererConfig {
    /// The largest [`RendererConfig::blur_poses`].
    pub const MAX_POSES: usize = 8;

    /// Checks every field.
    ///
    /// # Errors
    /// [`Error::Parameter`] naming the first field that is out of range.
    pub fn validate(&self) -> Result<()> {
        if !(0.0..=64.0).contains(&self.noise_levels) {
            return Err(Error::parameter("noise_levels", self.noise_levels, "0 to 64 gray levels"));
        }
        if !(1..=Self::MAX_POSES).contains(&self.blur_poses) {
            return Err(Error::parameter(
                "blur_poses",
                self.blur_poses,
                format_args!("1 to {}", Self::MAX_POSES),
            ));
        }
        if !(self.range_m > 0.0) {
            return Err(Error::parameter("range_m", self.range_m, "above 0 m"));
        }
        Ok(())
    }
}
