//! How far a measured flow is from the true one.

use crate::frame::Plane;
use crate::quantile::median;

/// How far a frame's measured flow is from the true one; or a flight's, as medians over its frames.
///
/// A cell's truth is the mean over the samples that its measured flow is the mean of, each from what its ray meets and the
/// exact poses of the two frames; what the gyro gets wrong of the turn between them is part of the error. The sky stands
/// still, infinitely far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Median length by which the flow on the view sphere from one frame to the next, the camera's turn taken out, is off in
    /// the half of the trusted cells that is trusted more than the other: in pixels of the ideal picture's middle. None where
    /// there are no such cells.
    pub better_half_error_px: Option<f64>,
    /// The same in all trusted cells.
    pub trusted_error_px: Option<f64>,
    /// The share of cells that are trusted, by [`Sphere::least_confidence`](crate::sphere::Sphere::least_confidence) or
    /// more: 0 to 1.
    pub trusted: f64,
    /// Median relative error of the time to contact, in trusted cells whose true one is between 0.7 and 4 s; a cell that
    /// shows nothing coming nearer is infinitely wrong. None where there are no such cells.
    pub contact_error: Option<f64>,
    /// How many of these there are; of a flight, in all its frames together.
    pub contact_cells: usize,
}

/// The divergence of the flow on the view sphere in each cell, 1/s.
#[derive(Clone, Debug, PartialEq)]
pub struct Divergences {
    /// As measured; NaN in cells around which too little is trusted.
    pub measured_hz: Plane,
    /// In truth: the mean over a cell.
    pub true_hz: Plane,
}

impl Measured {
    /// Medians over frames; none of no frames.
    pub(super) fn over(frames: &[Self]) -> Option<Self> {
        let of = |part: fn(&Self) -> Option<f64>| median(frames.iter().filter_map(part));
        Some(Self {
            better_half_error_px: of(|frame| frame.better_half_error_px),
            trusted_error_px: of(|frame| frame.trusted_error_px),
            trusted: of(|frame| Some(frame.trusted))?,
            contact_error: of(|frame| frame.contact_error),
            contact_cells: frames.iter().map(|frame| frame.contact_cells).sum(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(error_px: f64, contact: Option<f64>) -> Measured {
        Measured {
            better_half_error_px: Some(error_px),
            trusted_error_px: None,
            trusted: error_px,
            contact_error: contact,
            contact_cells: 3,
        }
    }

    #[test]
    fn a_flight_is_the_median_of_its_frames() {
        assert_eq!(Measured::over(&[]), None);
        let frames = [frame(0.3, None), frame(0.1, Some(f64::INFINITY)), frame(0.2, Some(0.05))];
        let expected = Measured { contact_error: Some(f64::INFINITY), contact_cells: 9, ..frame(0.2, None) };
        assert_eq!(Measured::over(&frames), Some(expected));
    }
}
