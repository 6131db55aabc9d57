use std::fs::File;
use std::io::Read;
use std::path::Path;

use glam::{DMat3, DVec2, DVec3};
use serde_json::Value;

use super::members::Members;
use super::unique::Unique;
use super::{FORMAT, VERSION};
use crate::error::{Error, Result};
use crate::sim::course::{Course, MAX_SURFACES, wall_between};
use crate::sim::{Surface, World};

/// No file is longer: the most surfaces of a world, each in more words than it needs.
const MAX_FILE: u64 = 16 << 20;

/// Reads a course from a file, and checks it with [`Course::validate`].
///
/// # Errors
/// [`Error::Io`]; [`Error::Format`] naming what is missing, wrong or not known, and in which surface.
pub fn read(path: impl AsRef<Path>) -> Result<Course> {
    let path = path.as_ref();
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(|source| Error::io(path, source))?;
    file.take(MAX_FILE + 1).read_to_end(&mut bytes).map_err(|source| Error::io(path, source))?;
    decode(path, &bytes)
}

/// A course from the bytes of a file. `path` is the name for error messages.
///
/// # Errors
/// [`Error::Format`] as [`read`].
pub fn decode(path: &Path, bytes: &[u8]) -> Result<Course> {
    if bytes.len() as u64 > MAX_FILE {
        let expected = format!("at most {MAX_FILE} bytes");
        return Err(Error::format(path, "file length", format!("over {MAX_FILE} bytes"), expected));
    }
    let Unique(value) = serde_json::from_slice(bytes)
        .map_err(|error| Error::format(path, "course file", format!("broken: {error}"), "JSON"))?;
    let mut file = Members::new(path, "course file", String::new(), value)?;
    let format = file.text("format", &format!("{FORMAT:?}"))?;
    if format != FORMAT {
        return Err(file.wrong("format", format_args!("{format:?}"), format_args!("{FORMAT:?}")));
    }
    let version = file.whole("version")?;
    if version != VERSION {
        return Err(file.wrong("version", version, VERSION));
    }
    let optional = |file: &mut Members<'_>, key| if file.has(key) { file.number(key) } else { Ok(0.0) };
    let course = Course {
        name: file.text("name", "a text")?,
        seed: if file.has("seed") { file.whole("seed")? } else { 0 },
        start_ned_m: file.numbers("start_ned_m")?.into(),
        start_yaw_rad: optional(&mut file, "start_yaw_rad")?,
        goal_yaw_rad: optional(&mut file, "goal_yaw_rad")?,
        length_m: file.number("length_m")?,
        altitude_m: file.numbers("altitude_m")?,
        centre_line_m: match file.has("centre_line_m") {
            true => file.rows("centre_line_m")?.into_iter().map(DVec2::from_array).collect(),
            false => Vec::new(),
        },
        world: World { surfaces: surfaces(path, &mut file)?, up_world: DVec3::NEG_Z },
    };
    file.end(
        "format, version, name, seed, start_ned_m, start_yaw_rad, goal_yaw_rad, length_m, altitude_m, \
         centre_line_m or surfaces",
    )?;
    course.validate().map_err(|error| file.in_file(error))?;
    Ok(course)
}

fn surfaces(path: &Path, file: &mut Members<'_>) -> Result<Vec<Surface>> {
    let list = file.list("surfaces")?;
    if list.len() > MAX_SURFACES {
        return Err(file.wrong("surfaces", list.len(), format_args!("at most {MAX_SURFACES}")));
    }
    list.into_iter().enumerate().map(|(i, value)| surface(path, i, value)).collect()
}

fn surface(path: &Path, i: usize, value: Value) -> Result<Surface> {
    let mut members = Members::new(path, "surface", format!(" in surface {i}"), value)?;
    let kinds = "ground, plane, wall, rectangle, cylinder or box";
    let kind = members.text("kind", kinds)?;
    let vector = |members: &mut Members<'_>, key| members.numbers(key).map(DVec3::from_array);
    let (surface, known) = match kind.as_str() {
        "ground" => (Surface::plane(DVec3::ZERO, DVec3::NEG_Z), "kind"),
        "plane" => {
            let [point, normal] = [vector(&mut members, "point_m")?, vector(&mut members, "normal")?];
            (Surface::plane(point, normal), "kind, point_m or normal")
        }
        "wall" => {
            let [from, to] = [members.numbers("from_m")?, members.numbers("to_m")?].map(DVec2::from_array);
            (wall_between(from, to, members.number("height_m")?), "kind, from_m, to_m or height_m")
        }
        "rectangle" => {
            let centre = vector(&mut members, "centre_m")?;
            let [to_right, to_top] = [vector(&mut members, "to_right_m")?, vector(&mut members, "to_top_m")?];
            (Surface::rectangle(centre, to_right, to_top), "kind, centre_m, to_right_m or to_top_m")
        }
        "cylinder" => {
            let [base, top] = [vector(&mut members, "base_m")?, vector(&mut members, "top_m")?];
            (Surface::cylinder(base, top, members.number("radius_m")?), "kind, base_m, top_m or radius_m")
        }
        "box" => {
            let [centre, edges] = [vector(&mut members, "centre_m")?, vector(&mut members, "edges_m")?];
            let turn = if members.has("axes") {
                let axes = members.rows::<3>("axes")?;
                let axes: [[f64; 3]; 3] = axes
                    .try_into()
                    .map_err(|axes: Vec<_>| members.wrong("axes", axes.len(), "three vectors"))?;
                DMat3::from_cols_array_2d(&axes)
            } else if members.has("yaw_rad") {
                DMat3::from_rotation_z(members.number("yaw_rad")?)
            } else {
                DMat3::IDENTITY
            };
            (Surface::cuboid(centre, turn, edges), "kind, centre_m, edges_m, and yaw_rad or axes")
        }
        other => return Err(members.wrong("kind", format_args!("{other:?}"), kinds)),
    };
    members.place(format!(" in surface {i}, a {kind}"));
    members.end(known)?;
    surface.map_err(|error| members.in_file(error))
}
