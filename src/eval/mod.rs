//! Evaluation of flow fields against ground truth.
//!
//! [`flow_error`] compares two fields. A [`Score`] also tells the errors of [classes](Class) of pixels apart, and how well a
//! confidence tells bad pixels; it can be added up over pairs. `data_set`, which needs the feature `io`, finds the pairs of
//! public data sets, and [`estimate`] runs an algorithm on one.

mod boundaries;
mod class;
mod confidence_score;
#[cfg(feature = "io")]
pub mod data_set;
mod estimate;
mod metrics;
#[cfg(all(feature = "io", feature = "serde"))]
mod result;
mod roc;
mod run_spec;
mod scene;
mod score;
mod sparsification;
#[cfg(all(feature = "io", feature = "serde"))]
mod table;
mod tally;
mod texture;
mod truth;

pub use class::{Class, Classes};
pub use confidence_score::{BAD_PX, Bad, ConfidenceScore};
pub use estimate::{Estimate, PairTime, estimate};
pub use metrics::{FlowError, angular_error_deg, endpoint_error, flow_error};
#[cfg(all(feature = "io", feature = "serde"))]
pub use result::{Ended, Job, PairResult};
pub use roc::Roc;
pub use run_spec::RunSpec;
pub use scene::Scene;
pub use score::Score;
pub use sparsification::{STEPS, Sparsification};
#[cfg(all(feature = "io", feature = "serde"))]
pub use table::{Ratios, Row, Table};
pub use tally::{Moments, Tally};
#[cfg(feature = "cli")]
pub(crate) use texture::gray_levels;
pub use truth::GroundTruth;
