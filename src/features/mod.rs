//! Corner features: pixels whose neighbourhood has texture along two directions, so that it can be found again in the next
//! frame.
//!
//! The corner response is the smaller eigenvalue of the gradients' covariance (Shi and Tomasi, Good features to track, CVPR
//! 1994) or Harris' (Harris and Stephens 1988). Parameters and semantics are those of OpenCV's `goodFeaturesToTrack` with
//! gradients of 3 × 3 pixels: the response and its local maxima are computed by kernels, the selection by quality and
//! distance is made on the host.
//!
//! ```
//! use viewsphere::Backend;
//! use viewsphere::features::{CornerParameters, good_features};
//! use viewsphere::frame::{Frame, PixelFormat, Size};
//!
//! # fn main() -> viewsphere::Result<()> {
//! // A bright square on black: its corners are the pixels (20, 16), (39, 16), (20, 31) and (39, 31).
//! let size = Size::new(64, 48);
//! let bright = |x: u32, y: u32| (20..40).contains(&x) && (16..32).contains(&y);
//! let pixels: Vec<u8> = (0..64 * 48).map(|i| if bright(i % 64, i / 64) { 255 } else { 0 }).collect();
//! let frame = Frame::new(size, PixelFormat::Gray8, &pixels)?;
//! let parameters = CornerParameters { min_distance: 5.0, ..CornerParameters::default() };
//! let corners = good_features(&Backend::Cpu, &frame, None, &parameters)?;
//! assert_eq!(corners.len(), 4);
//! for corner in corners {
//!     let [dx, dy] = [(corner.x - 29.5).abs() - 9.5, (corner.y - 23.5).abs() - 7.5];
//!     assert!(dx.abs() <= 1.0 && dy.abs() <= 1.0, "{corner:?}");
//! }
//! # Ok(())
//! # }
//! ```

mod detector;
mod parameters;
mod select;

pub use detector::{CornerDetector, good_features, plan};
pub use parameters::{CornerParameters, CornerResponse};
pub(crate) use select::Select;

/// A corner: the position of its pixel, and its response.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// The column, in pixels.
    pub x: f32,
    /// The row, in pixels.
    pub y: f32,
    /// The corner response there, in OpenCV's unit: gradients are per pixel, for gray levels from 0 to 1, and averaged over
    /// the block.
    pub response: f32,
}
