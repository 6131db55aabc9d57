//! The kinds of sensor that a flight can steer by.

use crate::named::named;

/// The kind of sensor that a flight steers by, from exact knowledge to a camera.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Sensor {
    /// The true nearness and the true direction of motion.
    Depth,
    /// The true flow of each cell.
    Flow,
    /// The true flow, blurred as by an estimator's window, with noise.
    NoisyFlow,
    /// Images through a lens, and a [`Pipeline`](crate::Pipeline).
    #[default]
    Images,
}

/// The errors that [`Sensor::NoisyFlow`] adds to the true flow. The defaults stand for Farnebäck's flow in images of
/// 320×240, as a flight computes it. There the median error of the better half of the cells in a corridor is 0.064 px,
/// which corresponds to a standard deviation of 0.055 px along each axis. Windows of 3 px on each level, with the 1.2
/// px of the expansion, halve the flow's contrast at the same detail as a Gaussian of 3.1 px.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct FlowNoise {
    /// Standard deviation of the Gaussian blur, in pixels, above 0.
    pub blur_px: f64,
    /// Standard deviation of the noise added to each cell along two axes, in pixels.
    pub white_px: f64,
    /// Standard deviation of each cell's relative scale error.
    pub relative: f64,
}

impl Default for FlowNoise {
    fn default() -> Self {
        Self { blur_px: 3.1, white_px: 0.055, relative: 0.03 }
    }
}

impl Sensor {
    /// All sensors, from exact knowledge to a camera.
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
