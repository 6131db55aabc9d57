//! Courses: simulated worlds to fly through, generated from a seed.
//!
//! All of them are in NED: x to the north, y to the east, z down, the ground at z = 0. The path leads north unless
//! stated otherwise. A seed gives the same world on every machine, up to the last bits of sines.
//!
//! ```
//! use viewsphere::sim::CourseKind;
//!
//! # fn main() -> viewsphere::Result<()> {
//! let kind: CourseKind = "forest:density=1/64:radius=0.2..0.3".parse()?;
//! let course = kind.course(7)?;
//! assert!(course.world.clearance_m(course.start_ned_m) > 9.0);
//! assert_eq!(course.name, "forest:density=0.015625:radius=0.2..0.3");
//! # Ok(())
//! # }
//! ```

mod check;
mod city;
mod corridor;
mod dead_end;
mod field;
#[cfg(all(feature = "io", feature = "serde"))]
pub mod file;
mod forest;
mod gates;
mod kind;
mod poisson_forest;
mod scatter;
mod shortest_way;
mod wall;
mod wires;

use glam::{DVec2, DVec3};

pub use self::city::City;
pub use self::corridor::Corridor;
pub use self::dead_end::DeadEnd;
pub use self::forest::Forest;
pub use self::gates::Gates;
pub use self::kind::CourseKind;
pub use self::poisson_forest::PoissonForest;
pub use self::wall::Wall;
pub use self::wires::Wires;

use super::{Surface, World};
use crate::error::Result;

/// The altitude at which flights start, metres above the ground.
const START_ALTITUDE_M: f64 = 10.0;
/// The distance at which obstacles still matter: the world continues for this length beyond the goal, so that its end
/// cannot be seen before the goal is reached.
const VISIBLE_M: f64 = 60.0;
/// The most surfaces of a world: more than can be rendered in the time of a flight.
const MAX_SURFACES: usize = 16_384;

/// The largest coordinate or length, so that squares and sums stay far from overflow.
const LARGEST_M: f64 = 1e6;

/// A world to fly through, and the task of the flight.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    /// The generator, with the parameters that differ from their defaults, as [`CourseKind`] parses it. For a
    /// hand-made course, one line of at most 200 characters.
    pub name: String,
    /// The seed of its generator.
    pub seed: u64,
    /// The surfaces. Up is −z.
    pub world: World,
    /// The position at which the flight starts.
    pub start_ned_m: DVec3,
    /// The vehicle's initial heading: clockwise from north, seen from above.
    pub start_yaw_rad: f64,
    /// The direction of the goal along the whole path: clockwise from north, seen from above.
    pub goal_yaw_rad: f64,
    /// The progress in that direction at which the goal is reached.
    pub length_m: f64,
    /// The altitude band: least and greatest height above the ground.
    pub altitude_m: [f64; 2],
    /// Points (north, east) of the centre line, in metres; empty if the course has none.
    pub centre_line_m: Vec<DVec2>,
}

impl Course {
    /// The distance of a position from the start in the direction of the goal.
    pub fn progress_m(&self, position_ned_m: DVec3) -> f64 {
        (position_ned_m - self.start_ned_m).truncate().dot(heading(self.goal_yaw_rad))
    }

    /// The distance of a position to the right of the centre line, negative to its left; `None` if the course has no
    /// centre line.
    pub fn offset_m(&self, position_ned_m: DVec3) -> Option<f64> {
        let place = position_ned_m.truncate();
        let offsets = self.centre_line_m.windows(2).filter_map(|ends| {
            let along = (ends[1] - ends[0]).try_normalize()?;
            let from_first = place - ends[0];
            let nearest = ends[0] + along * from_first.dot(along).clamp(0.0, ends[0].distance(ends[1]));
            Some(place.distance(nearest).copysign(along.perp_dot(from_first)))
        });
        offsets.min_by(|a, b| a.abs().total_cmp(&b.abs()))
    }
}

/// The horizontal direction of a yaw: north, east.
fn heading(yaw_rad: f64) -> DVec2 {
    DVec2::new(yaw_rad.cos(), yaw_rad.sin())
}

/// A course to the north that starts at the origin, with the ground and these surfaces.
fn northward(seed: u64, obstacles: Vec<Surface>, length_m: f64, altitude_m: [f64; 2]) -> Result<Course> {
    let ground = Surface::plane(DVec3::ZERO, DVec3::NEG_Z)?;
    let surfaces = std::iter::once(ground).chain(obstacles).collect();
    Ok(Course {
        name: String::new(),
        seed,
        world: World { surfaces, up_world: DVec3::NEG_Z },
        start_ned_m: DVec3::NEG_Z * START_ALTITUDE_M,
        start_yaw_rad: 0.0,
        goal_yaw_rad: 0.0,
        length_m,
        altitude_m,
        centre_line_m: Vec::new(),
    })
}

/// An upright wall from one point (north, east) to another, as thin as a [`Surface::rectangle`].
fn wall_between(from: DVec2, to: DVec2, height_m: f64) -> Result<Surface> {
    let half_height = DVec3::NEG_Z * height_m / 2.0;
    Surface::rectangle(
        from.midpoint(to).extend(0.0) + half_height,
        (to - from).extend(0.0) / 2.0,
        half_height,
    )
}

/// A tree or pillar at a point (north, east).
fn trunk(place: DVec2, radius_m: f64, height_m: f64) -> Result<Surface> {
    Surface::cylinder(place.extend(0.0), place.extend(-height_m), radius_m)
}
