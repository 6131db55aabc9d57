//! The members of a course file, as serde reads and writes them.

use serde::de::IgnoredAny;
use serde::{Deserialize, Deserializer, Serialize};

use crate::sim::course::LARGEST_M;

pub(super) const FORMAT: &str = "viewsphere course";
pub(super) const VERSION: u64 = 1;

/// The members of every version of the format.
#[derive(Deserialize)]
#[serde(expecting = "an object in braces")]
pub(super) struct Head {
    pub(super) format: String,
    pub(super) version: u64,
}

/// A whole file. Surfaces are read as raw values, one by one, so that an error can name the surface; they are written
/// as [`Entry`] values.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CourseFile<S> {
    pub(super) format: String,
    pub(super) version: u64,
    pub(super) name: String,
    #[serde(default)]
    pub(super) seed: u64,
    pub(super) start_ned_m: [Number; 3],
    #[serde(default)]
    pub(super) start_yaw_rad: Number,
    #[serde(default)]
    pub(super) goal_yaw_rad: Number,
    pub(super) length_m: Number,
    pub(super) altitude_m: [Number; 2],
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) centre_line_m: Vec<[Number; 2]>,
    pub(super) surfaces: Vec<S>,
}

/// A coordinate, length or angle within ±[`LARGEST_M`].
#[derive(Clone, Copy, Default, Serialize, Deserialize)]
#[serde(try_from = "f64")]
pub(super) struct Number(pub(super) f64);

impl TryFrom<f64> for Number {
    type Error = String;

    fn try_from(value: f64) -> Result<Self, String> {
        match value.abs() <= LARGEST_M {
            true => Ok(Self(value)),
            // In the form of serde's own messages, which `Part::problem` takes apart.
            false => Err(format!("invalid value: {value:?}, expected a number within ±{LARGEST_M}")),
        }
    }
}

impl Number {
    pub(super) fn values<const N: usize, T: From<[f64; N]>>(numbers: [Self; N]) -> T {
        numbers.map(|Self(number)| number).into()
    }
}

/// The kind of a surface.
#[derive(Deserialize)]
#[serde(variant_identifier, rename_all = "lowercase", expecting = "the name of a kind")]
pub(super) enum Kind {
    Ground,
    Plane,
    Wall,
    Rectangle,
    Cylinder,
    Box,
}

/// The members of every surface.
#[derive(Deserialize)]
#[serde(expecting = "an object in braces")]
pub(super) struct SurfaceHead {
    pub(super) kind: Kind,
}

/// A surface as it is written: its kind and that kind's members.
#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub(super) enum Entry {
    Ground,
    Plane(Plane),
    Rectangle(Rectangle),
    Cylinder(Cylinder),
    Box(Cuboid),
}

/// The members of a kind. [`SurfaceHead`] has already read the kind itself.
macro_rules! members {
    ($(#[$meta:meta])* $name:ident { $($(#[$attribute:meta])* $field:ident: $type:ty),* $(,)? }) => {
        $(#[$meta])*
        #[derive(Serialize, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub(super) struct $name {
            #[serde(rename = "kind", skip_serializing)]
            pub(super) _kind: IgnoredAny,
            $($(#[$attribute])* pub(super) $field: $type,)*
        }
    };
}

members!(
    /// The plane z = 0. It needs no numbers.
    Ground {}
);
members!(Plane { point_m: [Number; 3], normal: [Number; 3] });
members!(
    /// An upright wall on the ground. It is written back as a rectangle.
    Wall { from_m: [Number; 2], to_m: [Number; 2], height_m: Number }
);
members!(Rectangle { centre_m: [Number; 3], to_right_m: [Number; 3], to_top_m: [Number; 3] });
members!(Cylinder { base_m: [Number; 3], top_m: [Number; 3], radius_m: Number });
members!(
    Cuboid {
        centre_m: [Number; 3],
        edges_m: [Number; 3],
        #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
        yaw_rad: Option<Number>,
        #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
        axes: Option<[[Number; 3]; 3]>,
    }
);

/// Reads a member that may be missing, but not `null`.
fn present<'de, T: Deserialize<'de>, D: Deserializer<'de>>(from: D) -> Result<Option<T>, D::Error> {
    T::deserialize(from).map(Some)
}
