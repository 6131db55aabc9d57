//! Example worlds. A camera at [`START`] looks at the subject of each, straight ahead.

use glam::{DMat3, DVec3};

use super::{Surface, World};
use crate::camera::Pose;
use crate::error::Result;

/// The camera at the origin, its axes along the world's: x to the right, y down, z forward.
pub const START: Pose = Pose { position_world: DVec3::ZERO, world_from_camera: DMat3::IDENTITY };

/// Half the height of pillars, metres: beyond the field of view.
const PILLAR_M: f64 = 100.0;
/// From a pillar to the wall behind it, metres.
const BEHIND_M: f64 = 60.0;
/// Half the width and half the height of the corridor, metres.
const CORRIDOR_M: [f64; 2] = [1.5, 1.25];

/// A wall perpendicular to the line of sight.
///
/// # Errors
/// [`Error::Parameter`](crate::Error::Parameter) for a distance that is not finite.
pub fn frontal_wall(distance_m: f64) -> Result<World> {
    oblique_wall(distance_m, 0.0)
}

/// A wall whose normal is rotated sideways by an angle. The distance is that along the line of sight.
///
/// # Errors
/// As in [`frontal_wall`].
pub fn oblique_wall(distance_m: f64, angle_rad: f64) -> Result<World> {
    let normal = DVec3::new(angle_rad.sin(), 0.0, -angle_rad.cos());
    Ok(World::new(vec![Surface::plane(DVec3::Z * distance_m, normal)?]))
}

/// A pillar straight ahead, and a wall far behind it. The distance is that to the pillar's surface.
///
/// # Errors
/// As in [`frontal_wall`], and for a radius that is not above 0.
pub fn pillar(distance_m: f64, radius_m: f64) -> Result<World> {
    let axis = DVec3::Z * (distance_m + radius_m);
    let pillar = Surface::cylinder(axis + DVec3::Y * PILLAR_M, axis - DVec3::Y * PILLAR_M, radius_m)?;
    let wall = Surface::plane(DVec3::Z * (distance_m + BEHIND_M), DVec3::NEG_Z)?;
    Ok(World::new(vec![pillar, wall]))
}

/// A corridor, 3 m wide and 2.5 m high, with a wall at its end.
///
/// # Errors
/// As in [`frontal_wall`].
pub fn corridor(distance_m: f64) -> Result<World> {
    let [x, y] = CORRIDOR_M;
    let inner = [DVec3::X * x, DVec3::NEG_X * x, DVec3::Y * y, DVec3::NEG_Y * y, DVec3::Z * distance_m];
    Ok(World::new(inner.into_iter().map(|point| Surface::plane(point, -point)).collect::<Result<_>>()?))
}

/// A pillar of 0.3 m radius on a ground 2 m below, a box beside it, and a wall that ends above the horizon under the
/// sky.
///
/// # Errors
/// As in [`frontal_wall`].
pub fn yard(distance_m: f64) -> Result<World> {
    let ground = 2.0;
    let pillar = DVec3::new(-0.8, ground, distance_m);
    let cube = DVec3::new(1.4, ground - 0.75, distance_m + 1.0);
    let wall = DVec3::new(0.0, ground - 2.5, distance_m + 12.0);
    Ok(World::new(vec![
        Surface::plane(DVec3::Y * ground, DVec3::NEG_Y)?,
        Surface::cylinder(pillar, pillar + DVec3::NEG_Y * 4.0, 0.3)?,
        Surface::cuboid(cube, DMat3::from_rotation_y(0.5), DVec3::new(1.2, 1.5, 1.0))?,
        Surface::rectangle(wall, DVec3::X * 9.0, DVec3::NEG_Y * 2.5)?,
    ]))
}
