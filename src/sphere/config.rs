//! The configuration of the view sphere.

use super::HeadingModel;
use crate::error::{Error, Result, in_ranges};

/// Where the flow is derotated, that is, where the flow of the camera's rotation is removed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Derotation {
    /// Before the flow is estimated: the previous frame is resampled as the rotated camera would have seen it, so that
    /// only the translational flow is left to find. Most accurate under fast rotation; the previous frame is expanded
    /// once more for every pair.
    #[default]
    Before,
    /// After the flow is estimated, on the sphere. Exact for the estimated flow, but the flow of a fast rotation is
    /// hard to estimate.
    After,
    /// After the flow is estimated, as [`Derotation::After`]; the search begins with the flow of the rotation.
    Primed,
}

/// The configuration of the view sphere: how flow is derotated and aggregated.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Sphere {
    /// Where the flow is derotated.
    pub derotation: Derotation,
    /// How the heading is carried from frame to frame.
    pub heading: HeadingModel,
    /// Side of the cells over which the flow is averaged, in pixels, 1 to 64. The errors of Farnebäck's flow are
    /// correlated over about 8 px, so that smaller cells carry no more information.
    pub cell: u32,
    /// Distance of a cell's samples in pixels, 1 to the cell's side.
    pub step: u32,
    /// Radius of the divergence's window around a cell, in cells, 1 to 16. The window of the nearness rate has half
    /// this radius.
    pub window: u32,
    /// Columns and rows of sectors over the field of view, each 1 to 256.
    pub sectors: [u32; 2],
    /// The rank of a sector's upper quantile of nearness rates and divergences, 0.5 to 0.99. The lower quantile's rank
    /// is 1 minus this.
    pub quantile: f64,
    /// Whether a cell counts by the confidence of its flow along the direction in which translation moves it, where the
    /// direction of motion is known. Nearness rates of thin things are then known that are else left out; divergences,
    /// which need the flow in every direction, are less exact. Estimators with a confidence of their own ignore it.
    pub directional: bool,
    /// The least confidence of a cell that counts, 0.01 to 0.9.
    pub least_confidence: f64,
    /// Standard error of the flow of a cell with confidence 1, in pixels, above 0 and at most 10.
    pub noise_px: f64,
    /// Width of the strip along the frame's border over which the certainty rises from 0 to 1, in pixels, 0 to 1000.
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
            directional: false,
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
