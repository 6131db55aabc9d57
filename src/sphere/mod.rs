//! From pixels to the view sphere: bearings, the flow on the unit sphere with the camera's turn taken out, how fast what
//! is seen comes nearer, and sectors that sum it up.
//!
//! All is in the camera's frame at the later of two exposures: x to the right, y down, z forward.

mod alarm;
mod back;
mod config;
mod eigen;
mod front;
mod grid;
mod heading;
pub mod model;
mod motion;
mod plan;
mod remainder;
mod sectors;
mod summary;

pub use alarm::{Alarm, AlarmFilter, Threat};
pub use config::{Derotation, Sphere};
pub use grid::{Cells, Grid, angles_rad, bearing};
pub use heading::{HeadingFilter, HeadingModel};
pub use motion::MOTION_LEN;
pub use motion::{Heading, Motion};
pub use plan::Fields;
pub(crate) use plan::{Eye, plan};
pub use remainder::remaining_turn_rad_s;
pub use sectors::{Sector, Sectors};
pub use summary::{CellFlow, Summary};
