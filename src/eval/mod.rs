//! Evaluation of flow fields against ground truth.

mod metrics;
mod scene;

pub use metrics::{FlowError, angular_error_deg, endpoint_error, flow_error};
pub use scene::Scene;
