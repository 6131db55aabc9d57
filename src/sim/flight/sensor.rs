//! Which sensor a flight steers by.

use crate::named::named;

/// What the steering sees by: a ladder from what is known exactly to what a camera gives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Sensor {
    /// The true nearness and the true direction of motion.
    Depth,
    /// The true flow of each cell.
    Flow,
    /// The true flow, blurred as a window blurs it, and noisy.
    NoisyFlow,
    /// Pictures through a lens, and a [`Pipeline`](crate::Pipeline).
    #[default]
    Images,
}

/// What [`Sensor::NoisyFlow`] does to the true flow. The defaults stand for Farnebäck's flow in pictures of 320×240, as a
/// flight computes it: the better half of the cells in a corridor are 0.064 px off in the median, which is a standard
/// deviation of 0.055 px along each axis, and what windows of 3 px on each level (with the expansion's 1.2 px) let through is
/// halved at the same detail as by a Gaussian of 3.1 px.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct FlowNoise {
    /// Standard deviation of the Gaussian that it is blurred with, in pixels, above 0.
    pub blur_px: f64,
    /// Standard deviation of what is added to each cell along two axes, in pixels.
    pub white_px: f64,
    /// Standard deviation of the factor that it is multiplied with, against 1.
    pub relative: f64,
}

impl Default for FlowNoise {
    fn default() -> Self {
        Self { blur_px: 3.1, white_px: 0.055, relative: 0.03 }
    }
}

impl Sensor {
    /// All of them: the ladder from what is known exactly to what a camera gives.
    pub const ALL: [Self; 4] = [Self::Depth, Self::Flow, Self::NoisyFlow, Self::Images];

    /// The name: `depth`, `flow`, `noisy-flow` or `images`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Depth => "depth",
            Self::Flow => "flow",
            Self::NoisyFlow => "noisy-flow",
            Self::Images => "images",
        }
    }
}

named!(Sensor, "sensor");

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        for sensor in Sensor::ALL {
            assert_eq!(sensor.to_string().parse::<Sensor>().unwrap(), sensor);
        }
        let error = "camera".parse::<Sensor>().unwrap_err().to_string();
        assert_eq!(error, "sensor is \"camera\", expected depth, flow, noisy-flow, images");
    }
}
