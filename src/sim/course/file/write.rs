use std::io::{self, Write};
use std::path::Path;

use glam::{DMat3, DVec2, DVec3};
use serde::Serialize;
use serde::de::IgnoredAny;
use serde_json::Serializer;
use serde_json::ser::{CompactFormatter, Formatter};

use super::format::{CourseFile, Cuboid, Cylinder, Entry, FORMAT, Number, Plane, Rectangle, VERSION};
use crate::error::{Error, Result};
use crate::io::write_bytes;
use crate::sim::Form;
use crate::sim::course::Course;

/// Point and normal of the plane that is written as `ground`.
const GROUND: [DVec3; 2] = [DVec3::ZERO, DVec3::NEG_Z];

/// Writes a course to a file. The file is written under a temporary name and then renamed.
///
/// # Errors
/// As in [`encode`], and [`Error::Io`].
pub fn write(path: impl AsRef<Path>, course: &Course) -> Result<()> {
    write_bytes(path, encode(course)?.as_bytes())
}

/// Formats a course as the text of a file, with one line per surface. [`decode`](super::decode) reads back the same
/// course, bit for bit.
///
/// # Errors
/// As in [`Course::validate`].
pub fn encode(course: &Course) -> Result<String> {
    course.validate()?;
    let file = CourseFile {
        format: FORMAT.to_owned(),
        version: VERSION,
        name: course.name.clone(),
        seed: course.seed,
        start_ned_m: vector(course.start_ned_m),
        start_yaw_rad: Number(course.start_yaw_rad),
        goal_yaw_rad: Number(course.goal_yaw_rad),
        length_m: Number(course.length_m),
        altitude_m: course.altitude_m.map(Number),
        centre_line_m: course
            .centre_line_m
            .iter()
            .map(|point: &DVec2| point.to_array().map(Number))
            .collect(),
        surfaces: course.world.surfaces.iter().map(|surface| members(surface.form())).collect(),
    };
    let mut text = Vec::new();
    let wrong = |error: String| Error::parameter("course", error, "one that JSON can represent");
    file.serialize(&mut Serializer::with_formatter(&mut text, Lines::default()))
        .map_err(|error| wrong(error.to_string()))?;
    text.push(b'\n');
    String::from_utf8(text).map_err(|error| wrong(error.to_string()))
}

fn members(form: Form) -> Entry {
    let _kind = IgnoredAny;
    match form {
        Form::Plane { point_world, normal_world } if [point_world, normal_world] == GROUND => Entry::Ground,
        Form::Plane { point_world, normal_world } => {
            Entry::Plane(Plane { _kind, point_m: vector(point_world), normal: vector(normal_world) })
        }
        Form::Rectangle { centre_world, to_right, to_top } => {
            let [centre_m, to_right_m, to_top_m] = [centre_world, to_right, to_top].map(vector);
            Entry::Rectangle(Rectangle { _kind, centre_m, to_right_m, to_top_m })
        }
        Form::Cylinder { base_world, top_world, radius_m } => {
            let [base_m, top_m] = [base_world, top_world].map(vector);
            Entry::Cylinder(Cylinder { _kind, base_m, top_m, radius_m: Number(radius_m) })
        }
        Form::Cuboid { centre_world, world_from_box, edges_m } => {
            let turned = world_from_box != DMat3::IDENTITY;
            let axes = turned.then(|| world_from_box.to_cols_array_2d().map(|axis| axis.map(Number)));
            let [centre_m, edges_m] = [centre_world, edges_m].map(vector);
            Entry::Box(Cuboid { _kind, centre_m, edges_m, yaw_rad: None, axes })
        }
    }
}

fn vector(vector: DVec3) -> [Number; 3] {
    vector.to_array().map(Number)
}

/// A JSON formatter with one line per member of the file, and one per entry of an array of objects or arrays.
#[derive(Default)]
struct Lines {
    /// The number of open arrays and objects.
    depth: usize,
    /// Whether the array has entries on lines of their own.
    entries: bool,
    /// Whether the next entry follows a comma on the same line.
    after_comma: bool,
}

impl Lines {
    /// Begins an array or object. As an entry of one of the file's own arrays it starts a line.
    fn begin<W: ?Sized + Write>(&mut self, out: &mut W, bracket: &[u8]) -> io::Result<()> {
        let space: &[u8] = match (self.depth, self.after_comma) {
            (2, _) => b"\n    ",
            (_, true) => b" ",
            (_, false) => b"",
        };
        self.entries |= self.depth == 2;
        (self.depth, self.after_comma) = (self.depth + 1, false);
        out.write_all(space)?;
        out.write_all(bracket)
    }
}

impl Formatter for Lines {
    fn begin_array<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.begin(out, b"[")
    }

    fn end_array<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.depth -= 1;
        let after_entries = self.depth == 1 && std::mem::take(&mut self.entries);
        out.write_all(if after_entries { b"\n  ]" } else { b"]" })
    }

    fn begin_array_value<W: ?Sized + Write>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        self.after_comma = !first;
        out.write_all(if first { b"" } else { b"," })
    }

    fn begin_object<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.begin(out, b"{")
    }

    fn end_object<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.depth -= 1;
        out.write_all(if self.depth == 0 { b"\n}" } else { b"}" })
    }

    fn begin_object_key<W: ?Sized + Write>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        out.write_all(match (self.depth, first) {
            (1, true) => b"\n  ",
            (1, false) => b",\n  ",
            (_, true) => b"",
            (_, false) => b", ",
        })
    }

    fn begin_object_value<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        out.write_all(b": ")
    }

    fn write_f64<W: ?Sized + Write>(&mut self, out: &mut W, value: f64) -> io::Result<()> {
        out.write_all(if std::mem::take(&mut self.after_comma) { b" " } else { b"" })?;
        CompactFormatter.write_f64(out, value)
    }
}
