use glam::{DVec2, DVec3};

use super::{Course, LARGEST_M, MAX_SURFACES};
use crate::error::{Error, Result};
use crate::sim::Form;

/// The most characters of a name.
const MAX_NAME: usize = 200;

impl Course {
    /// Checks that the course can be flown: that its numbers are finite and in order, and that the start is free of
    /// surfaces and within the altitude band.
    ///
    /// # Errors
    /// [`Error::Parameter`] naming the field.
    pub fn validate(&self) -> Result<()> {
        if self.name.chars().any(char::is_control) || !(1..=MAX_NAME).contains(&self.name.chars().count()) {
            return Err(Error::parameter(
                "name",
                format_args!("{:?}", self.name),
                "a line of 1 to 200 characters",
            ));
        }
        if self.world.surfaces.len() > MAX_SURFACES {
            let found = format_args!("{} surfaces", self.world.surfaces.len());
            return Err(Error::parameter("world", found, format_args!("at most {MAX_SURFACES}")));
        }
        if self.world.up_world != DVec3::NEG_Z {
            return Err(Error::parameter("up_world", self.world.up_world, "the direction of -z"));
        }
        if let Some(i) = self.world.surfaces.iter().position(|surface| !is_near(surface.form())) {
            let expected = format_args!("within ±{LARGEST_M} m");
            return Err(Error::parameter(
                "world",
                format_args!("one whose surface {i} is too far away"),
                expected,
            ));
        }
        for (name, yaw_rad) in [("start_yaw_rad", self.start_yaw_rad), ("goal_yaw_rad", self.goal_yaw_rad)] {
            if !(yaw_rad.abs() <= LARGEST_M) {
                return Err(Error::parameter(name, yaw_rad, "a finite angle"));
            }
        }
        if !(self.length_m > 0.0 && self.length_m <= LARGEST_M) {
            return Err(Error::parameter("length_m", self.length_m, format_args!("above 0 to {LARGEST_M}")));
        }
        let [low, high] = self.altitude_m;
        if !(low >= 0.0 && low < high && high <= LARGEST_M) {
            let expected = format_args!("a band with the lower end first, within 0 to {LARGEST_M}");
            return Err(Error::parameter("altitude_m", format_args!("{low} to {high}"), expected));
        }
        let near = |point: &DVec2| point.abs().cmple(DVec2::splat(LARGEST_M)).all();
        if !self.centre_line_m.iter().all(near) || self.centre_line_m.len() == 1 {
            let found = format_args!("{} points", self.centre_line_m.len());
            let expected = format_args!("none, or at least two within ±{LARGEST_M} m");
            return Err(Error::parameter("centre_line_m", found, expected));
        }
        let clearance_m = self.world.clearance_m(self.start_ned_m);
        if !(clearance_m > 0.0 && self.start_ned_m.abs().max_element() <= LARGEST_M) {
            let found = format_args!("{}, {clearance_m} m from the nearest surface", self.start_ned_m);
            return Err(Error::parameter("start_ned_m", found, "a position outside all surfaces"));
        }
        let start_m = -self.start_ned_m.z;
        if !(low..=high).contains(&start_m) {
            let found = format_args!("{}, at an altitude of {start_m} m", self.start_ned_m);
            let expected = format_args!("one within altitude_m, {low} to {high} m");
            return Err(Error::parameter("start_ned_m", found, expected));
        }
        Ok(())
    }
}

/// Whether none of the form's numbers exceeds [`LARGEST_M`].
fn is_near(form: Form) -> bool {
    let (vectors, length_m) = match form {
        Form::Plane { point_world, normal_world } => ([point_world, normal_world, DVec3::ZERO], 0.0),
        Form::Rectangle { centre_world, to_right, to_top } => ([centre_world, to_right, to_top], 0.0),
        Form::Cylinder { base_world, top_world, radius_m } => {
            ([base_world, top_world, DVec3::ZERO], radius_m)
        }
        Form::Cuboid { centre_world, edges_m, .. } => ([centre_world, edges_m, DVec3::ZERO], 0.0),
    };
    vectors.iter().all(|vector| vector.abs().max_element() <= LARGEST_M) && length_m <= LARGEST_M
}
