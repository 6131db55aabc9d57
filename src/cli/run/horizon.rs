//! The up direction, from the attitude at the first frame, integrated from the gyro.

use glam::DVec3;

use super::gyro::Numbers;
use crate::camera::{FRD_FROM_CAMERA, world_from_body};
use crate::error::{Error, Result};
use crate::pipeline::Cue;

/// The up direction, while it is known.
pub(super) struct Horizon {
    up_camera: Option<DVec3>,
}

impl Horizon {
    /// From the camera's roll and pitch at the first frame, in degrees; unknown if they are.
    pub(super) fn new(level_deg: Option<Numbers<2>>) -> Result<Self> {
        let up = |Numbers([roll_deg, pitch_deg]): Numbers<2>| {
            for (name, value, limit) in [("roll", roll_deg, 180.0), ("pitch", pitch_deg, 90.0)] {
                if !(value.abs() <= limit) {
                    let expected = format!("-{limit} to {limit} degrees of {name}");
                    return Err(Error::parameter("--level", value, expected));
                }
            }
            let world_from_body = world_from_body(roll_deg.to_radians(), pitch_deg.to_radians(), 0.0);
            Ok(FRD_FROM_CAMERA.transpose() * (world_from_body.transpose() * DVec3::NEG_Z))
        };
        Ok(Self { up_camera: level_deg.map(up).transpose()? })
    }

    /// The up direction in the camera's frame at the next frame. Unknown from the first frame on whose rotation is
    /// unknown.
    pub(super) fn at(&mut self, cue: &Cue<'_>) -> Option<DVec3> {
        if cue.interval_s.is_some() {
            let turned = self.up_camera.zip(cue.prev_from_cur);
            self.up_camera = turned.map(|(up, prev_from_cur)| prev_from_cur.transpose() * up);
        }
        self.up_camera
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::time::Duration;

    use glam::DMat3;

    use super::*;
    use crate::camera::{Camera, Lens};
    use crate::frame::Size;
    use crate::sphere::{Grid, Heading, Sectors};

    #[test]
    fn up_is_above_and_turns_with_the_camera_until_a_turn_is_not_known() {
        let up = |text: &str| Horizon::new(Some(text.parse().unwrap())).unwrap().up_camera.unwrap();
        assert!((up("0,0") - DVec3::NEG_Y).length() < 1e-15);
        // Nose up: the zenith moves forward. Right wing down: it moves to the left.
        assert!(up("0,20").z > 0.3 && up("20,0").x < -0.3);
        for level in ["181,0", "0,-91", "NaN,0"] {
            assert!(Horizon::new(Some(level.parse().unwrap())).is_err(), "{level}");
        }

        let camera =
            Camera { size: Size::new(8, 8), f_u: 8.0, f_v: 8.0, u_0: 3.5, v_0: 3.5, lens: Lens::NONE };
        let sectors = Sectors::unknown(Grid::over(&camera, [1, 1]).unwrap());
        let cue = |interval_s, prev_from_cur| Cue {
            frame: 0,
            time_s: 0.0,
            interval_s,
            invalid: None,
            prev_from_cur,
            residual_rotation_rad_s: None,
            heading: Heading::UNKNOWN,
            sectors: &sectors,
            threat: None,
            flow: None,
            looming: None,
            cells: None,
            spherical_flow: None,
            latency: Duration::ZERO,
        };
        let mut horizon = Horizon::new(Some("0,0".parse().unwrap())).unwrap();
        assert_eq!(horizon.at(&cue(None, None)), Some(up("0,0")));
        // About the forward axis, clockwise: the right wing goes down.
        let right = DMat3::from_rotation_z(0.3);
        let found = horizon.at(&cue(Some(0.1), Some(right))).unwrap();
        assert!((found - up(&format!("{},0", 0.3_f64.to_degrees()))).length() < 1e-12, "{found}");
        assert_eq!(horizon.at(&cue(Some(0.1), None)), None);
        assert_eq!(horizon.at(&cue(Some(0.1), Some(right))), None);
    }
}
