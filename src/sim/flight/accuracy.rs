//! The error of the measured flow against the true flow.

use crate::frame::Plane;
use crate::quantile::median;

/// The error of a frame's measured flow against the true flow. For a flight, the medians over its frames.
///
/// The true flow of a cell is the mean over the same samples as the measured one. Each sample's flow follows from the
/// point that its ray meets and from the exact poses of the two frames. So the error includes that of the gyro's
/// rotation between them. The sky is at rest and infinitely far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The median length of the error of the derotated flow on the view sphere, frame to frame, over the more confident
    /// half of the trusted cells. In pixels at the centre of the ideal image. `None` if no cell is trusted.
    pub better_half_error_px: Option<f64>,
    /// The same over all trusted cells.
    pub trusted_error_px: Option<f64>,
    /// The share of trusted cells, 0 to 1: those whose confidence is at least
    /// [`Sphere::least_confidence`](crate::sphere::Sphere::least_confidence).
    pub trusted: f64,
    /// The median relative error of the time to contact, over the trusted cells whose true time is 0.7 to 4 s. The
    /// error of a cell that measures no approach is infinite. `None` if there are no such cells.
    pub contact_error: Option<f64>,
    /// The number of these cells; for a flight, summed over all frames.
    pub contact_cells: usize,
}

/// The divergence of the flow on the view sphere, per cell, 1/s.
#[derive(Clone, Debug, PartialEq)]
pub struct Divergences {
    /// The measured divergence; NaN where too little of the neighbourhood is trusted.
    pub measured_hz: Plane,
    /// The true divergence: the mean over the cell.
    pub true_hz: Plane,
}

impl Measured {
    /// The medians over the frames; `None` if there are no frames.
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
