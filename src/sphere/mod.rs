//! The view sphere: bearings, derotated flow on the unit sphere, nearness rate and divergence, and the sectors that
//! summarize them. Everything is in the camera's frame at the later of the two exposures: x to the right, y down, z
//! forward.

mod aggregate;
mod aggregator;
mod alarm;
mod config;
mod eigen;
mod grid;
mod heading;
pub mod model;
mod motion;
mod plan;
mod rectify;
mod residual_rotation;
mod sectors;

pub use aggregator::{CellFlow, SectorAggregator};
pub use alarm::{Alarm, AlarmFilter, Threat};
pub use config::{Derotation, Sphere};
pub use grid::{Cells, Grid, angles_rad, bearing};
pub use heading::{HeadingFilter, HeadingModel};
pub use motion::MOTION_LEN;
pub use motion::{Climb, Heading, Motion};
pub use plan::ExtraOutputs;
pub(crate) use plan::{Cameras, plan};
pub use residual_rotation::residual_rotation_rad_s;
pub use sectors::{Sector, Sectors};
