//! The parameters of sparse pyramidal Lucas–Kanade.

use crate::error::{Error, Result};
use crate::frame::Size;
use crate::kernels::patches::MAX_SAMPLES;

/// The parameters of sparse pyramidal Lucas–Kanade, as in OpenCV's `calcOpticalFlowPyrLK`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackParameters {
    /// Columns and rows of the window around a point, 3 to 1024 px each, at most 4096 samples in all, and no larger than
    /// the frame.
    pub window: [u32; 2],
    /// Levels of the pyramid beside the full image (`maxLevel`), 0 to 16. Levels that the window would cover in width or
    /// height are left out.
    pub levels: u32,
    /// The most iterations on each level, 1 to 100.
    pub iterations: u32,
    /// The length of a step that ends the iterations, 0 to 10 px.
    pub epsilon: f64,
    /// The least smaller eigenvalue of a window's mean structure tensor, at least 0 (`minEigThreshold`), in OpenCV's unit:
    /// (32 gray levels per pixel)², with gray levels from 0 to 255.
    pub min_eigenvalue: f64,
}

impl Default for TrackParameters {
    fn default() -> Self {
        Self { window: [21, 21], levels: 3, iterations: 30, epsilon: 0.01, min_eigenvalue: 1e-4 }
    }
}

impl TrackParameters {
    /// Checks every parameter's range, for frames of this size.
    ///
    /// # Errors
    /// [`Error::Parameter`] naming the first one that is out of range or NaN.
    pub fn validate(&self, size: Size) -> Result<()> {
        let [columns, rows] = self.window;
        let window = || format!("{columns}×{rows}");
        let samples = u64::from(columns) * u64::from(rows);
        if columns.min(rows) < 3 || columns.max(rows) > 1024 || samples > MAX_SAMPLES as u64 {
            let expected = "sides of 3 to 1024 px and at most 4096 samples";
            return Err(Error::parameter("window", window(), expected));
        }
        if columns > size.width || rows > size.height {
            return Err(Error::parameter("window", window(), format_args!("at most the frame's {size}")));
        }
        if self.levels > 16 {
            return Err(Error::parameter("levels", self.levels, "0 to 16"));
        }
        if !(1..=100).contains(&self.iterations) {
            return Err(Error::parameter("iterations", self.iterations, "1 to 100"));
        }
        if !(0.0..=10.0).contains(&self.epsilon) {
            return Err(Error::parameter("epsilon", self.epsilon, "0 to 10 px"));
        }
        if !(0.0..=1e9).contains(&self.min_eigenvalue) {
            return Err(Error::parameter("min_eigenvalue", self.min_eigenvalue, "0 to 10⁹"));
        }
        Ok(())
    }
}
