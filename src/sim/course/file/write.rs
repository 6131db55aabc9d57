use std::fmt::Write;
use std::path::Path;

use glam::{DMat3, DVec3};
use serde_json::Value;

use super::{FORMAT, VERSION};
use crate::error::Result;
use crate::io::write_bytes;
use crate::sim::Form;
use crate::sim::course::Course;

/// Point and normal of the plane that needs no numbers.
const GROUND: [DVec3; 2] = [DVec3::ZERO, DVec3::NEG_Z];

/// Writes a course to a file, beside its place and then renamed into it.
///
/// # Errors
/// As [`encode`], and [`Error::Io`](crate::Error::Io).
pub fn write(path: impl AsRef<Path>, course: &Course) -> Result<()> {
    write_bytes(path, encode(course)?.as_bytes())
}

/// A course as the text of a file, from which [`decode`](super::decode) makes the same course to the last bit. Each surface
/// has a line.
///
/// # Errors
/// As [`Course::validate`].
pub fn encode(course: &Course) -> Result<String> {
    course.validate()?;
    let mut lines = vec![
        format!("  \"format\": \"{FORMAT}\""),
        format!("  \"version\": {VERSION}"),
        format!("  \"name\": {}", Value::from(course.name.as_str())),
        format!("  \"seed\": {}", course.seed),
        format!("  \"start_ned_m\": {:?}", course.start_ned_m.to_array()),
        format!("  \"start_yaw_rad\": {:?}", course.start_yaw_rad),
        format!("  \"goal_yaw_rad\": {:?}", course.goal_yaw_rad),
        format!("  \"length_m\": {:?}", course.length_m),
        format!("  \"altitude_m\": {:?}", course.altitude_m),
    ];
    if !course.centre_line_m.is_empty() {
        let points = course.centre_line_m.iter().map(|point| format!("    {:?}", point.to_array()));
        lines.push(format!("  \"centre_line_m\": [\n{}\n  ]", points.collect::<Vec<_>>().join(",\n")));
    }
    let surfaces = course.world.surfaces.iter().map(|surface| format!("    {{{}}}", members(surface.form())));
    lines.push(format!("  \"surfaces\": [\n{}\n  ]", surfaces.collect::<Vec<_>>().join(",\n")));
    Ok(format!("{{\n{}\n}}\n", lines.join(",\n")))
}

/// The members of a surface's object. A number is written as Rust shows it: the shortest decimal that is read as the same.
fn members(form: Form) -> String {
    let (kind, vectors) = match form {
        Form::Plane { point_world, normal_world } if [point_world, normal_world] == GROUND => {
            ("ground", vec![])
        }
        Form::Plane { point_world, normal_world } => {
            ("plane", vec![("point_m", point_world), ("normal", normal_world)])
        }
        Form::Rectangle { centre_world, to_right, to_top } => {
            ("rectangle", vec![("centre_m", centre_world), ("to_right_m", to_right), ("to_top_m", to_top)])
        }
        Form::Cylinder { base_world, top_world, .. } => {
            ("cylinder", vec![("base_m", base_world), ("top_m", top_world)])
        }
        Form::Cuboid { centre_world, edges_m, .. } => {
            ("box", vec![("centre_m", centre_world), ("edges_m", edges_m)])
        }
    };
    let mut text = format!("\"kind\": \"{kind}\"");
    let mut add = |key, value: &dyn std::fmt::Debug| {
        // To a text it cannot fail.
        let _ = write!(text, ", \"{key}\": {value:?}");
    };
    for (key, vector) in vectors {
        add(key, &vector.to_array());
    }
    match form {
        Form::Cylinder { radius_m, .. } => add("radius_m", &radius_m),
        Form::Cuboid { world_from_box, .. } if world_from_box != DMat3::IDENTITY => {
            add("axes", &world_from_box.to_cols_array_2d());
        }
        _ => {}
    }
    text
}
