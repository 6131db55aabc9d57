use std::fs::File;
use std::io::Read;
use std::path::Path;

use glam::{DMat3, DVec3};
use serde_json::value::RawValue;

use super::format::{
    CourseFile, Cuboid, Cylinder, FORMAT, Ground, Head, Kind, Number, Plane, Rectangle, SurfaceHead, VERSION,
    Wall,
};
use super::problem::Part;
use crate::error::{Error, Result};
use crate::sim::course::{Course, MAX_SURFACES, wall_between};
use crate::sim::{Surface, World};

/// The longest file accepted, in bytes: room for the most surfaces of a world, generously formatted.
const MAX_FILE: u64 = 16 << 20;

/// Reads a course from a file and checks it with [`Course::validate`].
///
/// # Errors
/// [`Error::Io`]; [`Error::Format`] naming the missing, invalid or unknown member and its surface.
pub fn read(path: impl AsRef<Path>) -> Result<Course> {
    let path = path.as_ref();
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(|source| Error::io(path, source))?;
    file.take(MAX_FILE + 1).read_to_end(&mut bytes).map_err(|source| Error::io(path, source))?;
    decode(path, &bytes)
}

/// Parses a course from the bytes of a file. `path` is the name in error messages.
///
/// # Errors
/// [`Error::Format`] as in [`read`].
pub fn decode(path: &Path, bytes: &[u8]) -> Result<Course> {
    if bytes.len() as u64 > MAX_FILE {
        let expected = format!("at most {MAX_FILE} bytes");
        return Err(Error::format(path, "file length", format!("over {MAX_FILE} bytes"), expected));
    }
    let part = Part { path, what: "course file", surface: None };
    // The version comes first, as the members of others may differ.
    let head: Head = part.read(bytes)?;
    if head.format != FORMAT {
        return Err(part.wrong("format", format_args!("{:?}", head.format), format_args!("{FORMAT:?}")));
    }
    if head.version != VERSION {
        return Err(part.wrong("version", head.version, VERSION));
    }
    let file: CourseFile<&RawValue> = part.read(bytes)?;
    if file.surfaces.len() > MAX_SURFACES {
        return Err(part.wrong("surfaces", file.surfaces.len(), format_args!("at most {MAX_SURFACES}")));
    }
    let surfaces = (0..).zip(&file.surfaces).map(|(i, raw)| {
        let part = Part { path, what: "surface", surface: Some(i) };
        surface(&part, raw.get().as_bytes()).map_err(|error| part.in_file(error))
    });
    let course = Course {
        world: World { surfaces: surfaces.collect::<Result<_>>()?, up_world: DVec3::NEG_Z },
        name: file.name,
        seed: file.seed,
        start_ned_m: Number::values(file.start_ned_m),
        start_yaw_rad: file.start_yaw_rad.0,
        goal_yaw_rad: file.goal_yaw_rad.0,
        length_m: file.length_m.0,
        altitude_m: Number::values(file.altitude_m),
        centre_line_m: file.centre_line_m.into_iter().map(Number::values).collect(),
    };
    course.validate().map_err(|error| part.in_file(error))?;
    Ok(course)
}

fn surface(part: &Part<'_>, text: &[u8]) -> Result<Surface> {
    let SurfaceHead { kind } = part.read(text)?;
    match kind {
        Kind::Ground => {
            let Ground { .. } = part.read(text)?;
            Surface::plane(DVec3::ZERO, DVec3::NEG_Z)
        }
        Kind::Plane => {
            let Plane { point_m, normal, .. } = part.read(text)?;
            Surface::plane(Number::values(point_m), Number::values(normal))
        }
        Kind::Wall => {
            let Wall { from_m, to_m, height_m, .. } = part.read(text)?;
            wall_between(Number::values(from_m), Number::values(to_m), height_m.0)
        }
        Kind::Rectangle => {
            let Rectangle { centre_m, to_right_m, to_top_m, .. } = part.read(text)?;
            let [centre, to_right, to_top] = [centre_m, to_right_m, to_top_m].map(Number::values);
            Surface::rectangle(centre, to_right, to_top)
        }
        Kind::Cylinder => {
            let Cylinder { base_m, top_m, radius_m, .. } = part.read(text)?;
            Surface::cylinder(Number::values(base_m), Number::values(top_m), radius_m.0)
        }
        Kind::Box => {
            let Cuboid { centre_m, edges_m, yaw_rad, axes, .. } = part.read(text)?;
            let turn = match (yaw_rad, axes) {
                (None, None) => DMat3::IDENTITY,
                (Some(yaw_rad), None) => DMat3::from_rotation_z(yaw_rad.0),
                (None, Some(axes)) => DMat3::from_cols_array_2d(&axes.map(Number::values)),
                (Some(yaw_rad), Some(_)) => {
                    let found = format_args!("{} beside axes", yaw_rad.0);
                    return Err(part.wrong("yaw_rad", found, "at most one of the two"));
                }
            };
            Surface::cuboid(Number::values(centre_m), turn, Number::values(edges_m))
        }
    }
}
