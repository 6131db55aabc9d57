//! The levels of an image pyramid.

use crate::frame::Size;

/// No level has a side under this many pixels, except the finest.
const SMALLEST_SIDE: f64 = 32.0;

/// One level of an image pyramid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    /// Its size.
    pub size: Size,
    /// Its scale relative to the finest level: 1 there, smaller on coarser levels.
    pub scale: f64,
    /// Standard deviation of the Gaussian that smooths the full image before it is sampled, in pixels of the full
    /// image.
    pub sigma: f64,
    /// Number of samples of that Gaussian.
    pub taps: u32,
}

/// The levels from the finest to the coarsest: the full image and at most `levels` reduced ones, as in OpenCV's
/// `calcOpticalFlowFarneback`. Levels whose shorter side would be under 32 pixels are left out.
pub fn levels(size: Size, pyr_scale: f64, levels: u32) -> Vec<Level> {
    levels_down_to(size, pyr_scale, levels, SMALLEST_SIDE)
}

/// As [`levels`], without levels whose shorter side would be under `smallest` pixels.
pub(super) fn levels_down_to(size: Size, pyr_scale: f64, levels: u32, smallest: f64) -> Vec<Level> {
    let mut result = Vec::new();
    let mut scale = 1.0;
    for k in 0..=levels {
        let side = |side: u32| f64::from(side) * scale;
        if k > 0 && side(size.width.min(size.height)) < smallest {
            break;
        }
        let round = |side: f64| side.round_ties_even() as u32;
        let sigma = (1.0 / scale - 1.0) * 0.5;
        result.push(Level {
            size: Size::new(round(side(size.width)), round(side(size.height))),
            scale,
            sigma,
            taps: (round(sigma * 5.0) | 1).max(3),
        });
        scale *= pyr_scale;
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sizes(size: Size, pyr_scale: f64, count: u32) -> Vec<String> {
        levels(size, pyr_scale, count).iter().map(|level| level.size.to_string()).collect()
    }

    #[test]
    fn end_before_a_side_under_32() {
        assert_eq!(sizes(Size::new(640, 480), 0.5, 9), ["640×480", "320×240", "160×120", "80×60"]);
        assert_eq!(sizes(Size::new(64, 100), 0.5, 9), ["64×100", "32×50"]);
        assert_eq!(sizes(Size::new(63, 100), 0.5, 9), ["63×100"]);
    }

    #[test]
    fn round_half_to_even() {
        assert_eq!(sizes(Size::new(65, 67), 0.5, 1), ["65×67", "32×34"]);
    }

    #[test]
    fn smooth_by_their_scale() {
        let taps: Vec<u32> = levels(Size::new(640, 480), 0.5, 3).iter().map(|level| level.taps).collect();
        assert_eq!(taps, [3, 3, 9, 19]);
    }
}
