//! How the view sphere is looked at.

use super::HeadingModel;
use crate::error::{Error, Result, in_ranges};

/// Where the camera's turn is taken out of the flow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Derotation {
    /// Before the flow: the frame before is resampled as the turned camera would have seen it, so that only what is
    /// left has to be found. Most accurate in hard turns; the frame before is expanded once more for every pair.
    #[default]
    Before,
    /// After the flow, on the sphere. Exact for the flow that was found, but a large turn is hard to find.
    After,
    /// After the flow, whose search begins with the turn.
    Primed,
}

/// How the flow on the view sphere is summed up.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Sphere {
    /// Where the camera's turn is taken out.
    pub derotation: Derotation,
    /// How the direction of motion is carried on from frame to frame.
    pub heading: HeadingModel,
    /// Pixels of the side of the cells that the flow is averaged over, 1 to 64. Farnebäck's errors are alike over about
    /// 8 px, so that smaller cells show no more.
    pub cell: u32,
    /// Pixels from one sample of a cell to the next, 1 to the cell's side.
    pub step: u32,
    /// How far the window of the divergence reaches around a cell, in cells, 1 to 16; that of the nearness rate reaches
    /// half as far.
    pub window: u32,
    /// Columns and rows of sectors over the field of view, each 1 to 256.
    pub sectors: [u32; 2],
    /// The upper quantile that a sector gives of its nearness rates and divergences, 0.5 to 0.99.
    pub quantile: f64,
    /// Cells that are trusted less are left out, 0.01 to 0.9.
    pub least_confidence: f64,
    /// Standard error of a fully trusted cell's flow, in pixels, above 0 and at most 10.
    pub noise_px: f64,
    /// Pixels within the frame's border over which a place becomes trusted, 0 to 1000.
    pub margin_px: f64,
}

impl Default for Sphere {
    fn default() -> Self {
        Self {
            derotation: Derotation::default(),
            heading: HeadingModel::default(),
            cell: 8,
            step: 4,
            window: 2,
            sectors: [24, 9],
            quantile: 0.8,
            least_confidence: 0.2,
            noise_px: 0.03,
            margin_px: 8.0,
        }
    }
}

impl Sphere {
    /// Checks every parameter's range.
    ///
    /// # Errors
    /// [`Error::Parameter`], naming the first one that is out of range.
    pub fn validate(&self) -> Result<()> {
        for (name, value, low, high) in [
            ("cell", self.cell, 1, 64),
            ("step", self.step, 1, self.cell.clamp(1, 64)),
            ("window", self.window, 1, 16),
            ("sectors", self.sectors[0], 1, super::Grid::MAX_SIDE),
            ("sectors", self.sectors[1], 1, super::Grid::MAX_SIDE),
        ] {
            if !(low..=high).contains(&value) {
                return Err(Error::parameter(name, value, format_args!("{low} to {high}")));
            }
        }
        in_ranges(&[
            ("quantile", self.quantile, 0.5, 0.99),
            ("least_confidence", self.least_confidence, 0.01, 0.9),
            ("noise_px", self.noise_px, 1e-6, 10.0),
            ("margin_px", self.margin_px, 0.0, 1000.0),
        ])
    }
}
