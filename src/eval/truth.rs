//! The ground truth of a pair of frames.

use super::metrics::check_size;
use crate::error::{Error, Result};
use crate::frame::{FlowField, Plane};

/// The ground truth of a pair of frames.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundTruth {
    /// The flow in pixels; unknown where nothing is to be compared.
    pub flow: FlowField,
    /// Where the second frame does not show what the first one does, if that is known: `true` for occluded pixels, one value
    /// for each.
    pub occluded: Option<Vec<bool>>,
    /// The distance along each pixel's ray in metres, if it is known: infinite for the sky, NaN where it is unknown.
    pub depth_m: Option<Plane>,
}

impl GroundTruth {
    /// Checks that the parts have one size.
    ///
    /// # Errors
    /// [`Error::Length`], [`Error::SizeMismatch`]; as in [`FlowField::validate`] and [`Plane::validate`].
    pub fn validate(&self) -> Result<()> {
        self.flow.validate()?;
        if let Some(depth_m) = &self.depth_m {
            depth_m.validate()?;
            check_size("depth", depth_m.size, self.flow.size)?;
        }
        let expected = self.flow.data.len();
        match &self.occluded {
            Some(occluded) if occluded.len() != expected => {
                Err(Error::Length { what: "occluded", found: occluded.len(), expected })
            }
            _ => Ok(()),
        }
    }
}

impl From<FlowField> for GroundTruth {
    fn from(flow: FlowField) -> Self {
        Self { flow, occluded: None, depth_m: None }
    }
}
