//! Files of courses: JSON that can be written by hand.
//!
//! Metres and radians, NED. `seed`, `start_yaw_rad`, `goal_yaw_rad` and `centre_line_m`, a list of points (north, east), may
//! be left out and are then 0 or empty; every other member has to be there once, and no further one is known. docs/worlds.md
//! says what each is.
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
//! Further kinds are `plane` with `point_m` and `normal`, and `rectangle` with `centre_m`, `to_right_m` and `to_top_m`, as
//! [`Surface`](crate::sim::Surface) has them. A box has either `yaw_rad` or `axes`, the directions of its three edges, or
//! neither. A surface's place in the list is part of its texture.

mod format;
mod problem;
mod read;
mod write;

pub use self::read::{decode, read};
pub use self::write::{encode, write};

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
