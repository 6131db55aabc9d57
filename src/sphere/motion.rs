//! The camera's motion between two frames.

use std::f64::consts::FRAC_PI_2;

use glam::{DMat3, DVec3};

use crate::error::{Error, Result, in_ranges};

/// Number of values in a plan's `motion` buffer. See [`Motion::values`].
pub const MOTION_LEN: usize = 16;

/// The camera's motion from the previous frame to the current one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Takes a bearing in the camera's frame at the later exposure into its frame at the earlier one.
    pub prev_from_cur: DMat3,
    /// The direction in which the camera moves, in its frame at the later exposure.
    pub heading: Heading,
}

/// The direction in which the camera moves, with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heading {
    /// A unit vector in the camera's frame (x to the right, y down, z forward).
    pub direction: DVec3,
    /// Standard error of the direction, in radians; above 1 the direction counts as unknown.
    pub error_rad: f64,
}

impl Heading {
    /// An unknown heading: straight ahead, with unbounded error.
    pub const UNKNOWN: Self = Self { direction: DVec3::Z, error_rad: 10.0 };

    /// Whether the direction is known: an error of at most 1 rad.
    pub fn is_known(&self) -> bool {
        self.error_rad <= 1.0
    }
}

/// How steeply the camera climbs over ground, as an autopilot knows it from its attitude and its vertical speed.
///
/// The flow gives the heading's elevation less well than its azimuth: where thin upright things are most of what it is
/// measured on, their flow is mixed with that of what is behind them, and the heading comes out too low.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Climb {
    /// Up, a unit vector in the camera's frame at the frame's exposure.
    pub up: DVec3,
    /// The angle of the motion above the horizontal, −π/2 to π/2.
    pub angle_rad: f64,
}

impl Climb {
    /// Checks that up is a unit vector, and the angle within its range.
    ///
    /// # Errors
    /// [`Error::Parameter`] for the one that is not.
    pub fn validate(&self) -> Result<()> {
        if !((self.up.length() - 1.0).abs() <= 1e-3) {
            return Err(Error::parameter("up", self.up, "a unit vector"));
        }
        in_ranges(&[("angle_rad", self.angle_rad, -FRAC_PI_2, FRAC_PI_2)])
    }

    /// The heading of the same azimuth with this climb. A vertical heading has no azimuth, and stays.
    pub(crate) fn of(&self, heading: Heading) -> Heading {
        let Some(level) = heading.direction.reject_from(self.up).try_normalize() else { return heading };
        let (sin, cos) = self.angle_rad.sin_cos();
        Heading { direction: cos * level + sin * self.up, ..heading }
    }
}

impl Motion {
    /// No rotation, and an unknown heading.
    pub const UNKNOWN: Self = Self { prev_from_cur: DMat3::IDENTITY, heading: Heading::UNKNOWN };

    /// The values of the `motion` buffer: the three rows of `prev_from_cur − 1`, each padded with a zero, then the
    /// heading and its error. Without the identity a small rotation keeps all its digits in `f32`.
    pub fn values(&self) -> [f32; MOTION_LEN] {
        let rows = (self.prev_from_cur - DMat3::IDENTITY).transpose();
        let mut values = [0.0; MOTION_LEN];
        let heading = self.heading.direction.extend(self.heading.error_rad);
        for (four, row) in values.chunks_exact_mut(4).zip(
            [rows.x_axis, rows.y_axis, rows.z_axis].map(|row| row.extend(0.0)).into_iter().chain([heading]),
        ) {
            four.copy_from_slice(&row.as_vec4().to_array());
        }
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_hold_the_turn_less_the_identity() {
        let motion = Motion {
            prev_from_cur: DMat3::from_rotation_z(0.1),
            heading: Heading { direction: DVec3::Y, error_rad: 0.25 },
        };
        let values = motion.values();
        let (sin, cos) = 0.1_f64.sin_cos();
        let expected = [cos - 1.0, -sin, 0.0, 0.0, sin, cos - 1.0].map(|v| v as f32);
        assert_eq!(values[..6], expected);
        assert_eq!(values[12..], [0.0, 1.0, 0.0, 0.25]);
        assert_eq!(Motion::UNKNOWN.values()[..12], [0.0; 12]);
    }

    #[test]
    fn a_climb_keeps_the_azimuth_and_sets_the_elevation() {
        let up = DVec3::new(0.1, -1.0, 0.2).normalize();
        let seen = Heading { direction: DVec3::new(0.3, 0.2, 1.0).normalize(), error_rad: 0.02 };
        let climb = Climb { up, angle_rad: 0.1 };
        assert!(climb.validate().is_ok());
        let found = climb.of(seen);
        assert!((found.direction.length() - 1.0).abs() < 1e-12 && found.error_rad == 0.02);
        assert!((found.direction.dot(up).asin() - 0.1).abs() < 1e-12);
        let azimuth = |direction: DVec3| direction.reject_from(up).normalize();
        assert!(azimuth(found.direction).distance(azimuth(seen.direction)) < 1e-12);
        let vertical = Heading { direction: up, error_rad: 0.0 };
        assert_eq!(climb.of(vertical), vertical);
        for wrong in [Climb { up: DVec3::ZERO, ..climb }, Climb { angle_rad: f64::NAN, ..climb }] {
            assert!(wrong.validate().is_err());
        }
    }
}
