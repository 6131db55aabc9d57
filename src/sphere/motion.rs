//! The camera's motion between two frames.

use glam::{DMat3, DVec3};

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
}
