//! Course files: JSON that can be written by hand.
//!
//! Values are in metres and radians, NED. `seed`, `start_yaw_rad`, `goal_yaw_rad` and `centre_line_m`, an array of
//! points (north, east), are optional and default to 0 or empty. Every other member is required exactly once, and
//! unknown members are errors. docs/worlds.md describes each member.
//!
//! ```json
//! {
//!   "format": "viewsphere course",
//!   "version": 1,
//!   "name": "yard",
//!   "start_ned_m": [0, 0, -10],
//!   "goal_yaw_rad": 0,
//!   "length_m": 120,
//!   "altitude_m": [2, 30],
//!   "surfaces": [
//!     {"kind": "ground"},
//!     {"kind": "wall", "from_m": [80, -20], "to_m": [90, 30], "height_m": 40},
//!     {"kind": "cylinder", "base_m": [40, 5, 0], "top_m": [40, 5, -25], "radius_m": 0.3},
//!     {"kind": "box", "centre_m": [60, -15, -10], "edges_m": [12, 16, 20], "yaw_rad": 0.5}
//!   ]
//! }
//! ```
//!
//! Further kinds are `plane` with `point_m` and `normal`, and `rectangle` with `centre_m`, `to_right_m` and `to_top_m`,
//! as in [`Surface`](crate::sim::Surface). A box has either `yaw_rad` or `axes`, the directions of its three edges, or
//! neither. The texture of a surface depends on its index in the array.

mod format;
mod problem;
mod read;
mod write;

pub use self::read::{decode, read};
pub use self::write::{encode, write};

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
