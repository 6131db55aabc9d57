//! Camera poses, and conversions between attitude angles and rotations.

use glam::{DMat3, DVec3};

/// The position and orientation of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The position, in metres in the world's frame.
    pub position_world: DVec3,
    /// The rotation from the camera's frame to the world's.
    pub world_from_camera: DMat3,
}

/// From the camera's frame (right, down, forward) to the body frame of aerospace and MAVLink (forward, right, down).
pub const FRD_FROM_CAMERA: DMat3 = DMat3::from_cols(DVec3::Y, DVec3::Z, DVec3::X);

/// From the camera's frame (right, down, forward) to the body frame of ROS (forward, left, up).
pub const FLU_FROM_CAMERA: DMat3 = DMat3::from_cols(DVec3::NEG_Y, DVec3::NEG_Z, DVec3::X);

/// The rotation from the body's frame to the world's: R_z(yaw) R_y(pitch) R_x(roll).
pub fn world_from_body(roll_rad: f64, pitch_rad: f64, yaw_rad: f64) -> DMat3 {
    let (s_r, c_r) = roll_rad.sin_cos();
    let (s_p, c_p) = pitch_rad.sin_cos();
    let (s_y, c_y) = yaw_rad.sin_cos();
    DMat3::from_cols(
        DVec3::new(c_y * c_p, s_y * c_p, -s_p),
        DVec3::new(c_y * s_p * s_r - s_y * c_r, s_y * s_p * s_r + c_y * c_r, c_p * s_r),
        DVec3::new(c_y * s_p * c_r + s_y * s_r, s_y * s_p * c_r - c_y * s_r, c_p * c_r),
    )
}

/// The largest deviation of a user's matrix from a rotation, per element of M Mᵀ − 1. Files state four digits or more.
const ROTATION_TOLERANCE: f64 = 1e-3;

/// Whether a matrix is a rotation, to the digits that files state: orthogonal, and no mirror.
pub(crate) fn is_rotation(m: &DMat3) -> bool {
    let off = (*m * m.transpose() - DMat3::IDENTITY).to_cols_array();
    off.iter().all(|e| e.abs() <= ROTATION_TOLERANCE) && m.determinant() > 0.0
}

/// Roll, pitch and yaw of a rotation: the inverse of [`world_from_body`]. Pitch is from −π/2 to π/2, the others from −π
/// to π.
///
/// With the nose straight up or down only the sum or the difference of roll and yaw is defined; roll is 0 then.
pub fn roll_pitch_yaw_rad(world_from_body: &DMat3) -> [f64; 3] {
    let [x, y, z] = [world_from_body.x_axis, world_from_body.y_axis, world_from_body.z_axis];
    let level = x.x.hypot(x.y);
    let pitch = (-x.z).atan2(level);
    // Below this the two arguments of atan2 are rounding.
    if level < 1e-12 {
        return [0.0, pitch, (-y.x).atan2(y.y)];
    }
    [y.z.atan2(z.z), pitch, x.y.atan2(x.x)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rotation_is_the_product_of_three() {
        for [roll, pitch, yaw] in [[0.3, -0.4, 1.2], [-2.0, 1.3, -3.0], [0.0, 0.0, 0.0]] {
            let product =
                DMat3::from_rotation_z(yaw) * DMat3::from_rotation_y(pitch) * DMat3::from_rotation_x(roll);
            let found = world_from_body(roll, pitch, yaw);
            assert!(found.abs_diff_eq(product, 1e-15), "{found} {product}");
            assert!((found * found.transpose()).abs_diff_eq(DMat3::IDENTITY, 1e-15));
            let back = roll_pitch_yaw_rad(&found);
            for (a, b) in back.iter().zip([roll, pitch, yaw]) {
                assert!((a - b).abs() <= 1e-14, "{back:?}");
            }
        }
    }

    #[test]
    fn straight_up_and_down_keep_their_rotation() {
        for pitch in [std::f64::consts::FRAC_PI_2, -std::f64::consts::FRAC_PI_2] {
            let rotation = world_from_body(0.4, pitch, 1.0);
            let [roll, pitch, yaw] = roll_pitch_yaw_rad(&rotation);
            assert!(world_from_body(roll, pitch, yaw).abs_diff_eq(rotation, 1e-12));
        }
    }

    /// With z down, yaw is to the right as seen from above; the nose goes up with pitch, the right wing down with
    /// roll.
    #[test]
    fn the_signs_are_those_of_aircraft() {
        let part = |[roll, pitch, yaw]: [f64; 3], axis: DVec3| world_from_body(roll, pitch, yaw) * axis;
        assert!(part([0.0, 0.0, 0.1], DVec3::X).y > 0.0);
        assert!(part([0.0, 0.1, 0.0], DVec3::X).z < 0.0);
        assert!(part([0.1, 0.0, 0.0], DVec3::Y).z > 0.0);
    }

    #[test]
    fn the_body_frames_are_the_camera_renamed() {
        let v = DVec3::new(1.0, 2.0, 3.0);
        assert_eq!(FRD_FROM_CAMERA * v, DVec3::new(3.0, 1.0, 2.0));
        assert_eq!(FLU_FROM_CAMERA * v, DVec3::new(3.0, -1.0, -2.0));
        assert!(FRD_FROM_CAMERA.determinant() == 1.0 && FLU_FROM_CAMERA.determinant() == 1.0);
    }
}
