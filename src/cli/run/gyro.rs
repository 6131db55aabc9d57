//! The flags of the gyro: its log, its mount and its errors.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, ValueEnum};
use glam::{DMat3, DVec3};

use crate::camera::{FLU_FROM_CAMERA, FRD_FROM_CAMERA};
use crate::error::{Error, Result};
use crate::imu::GyroConfig;
use crate::io::gyro_log;
use crate::live::GyroFeed;
use crate::sphere::Derotation;

/// The gyro's log, and its relation to the camera.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Gyro")]
pub(super) struct GyroArgs {
    /// Log of a gyro, by which the flow is derotated: columns time_s,gyro_x_rad_s,… or EuRoC's
    #[arg(long, value_name = "FILE")]
    pub(super) gyro: Option<PathBuf>,
    /// The gyro's reading at rest, in its own frame, in rad/s
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, requires = "gyro")]
    gyro_bias: Option<Numbers<3>>,
    /// Added to the log's times to give the frames' times, in seconds
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, requires = "gyro")]
    gyro_offset_s: Option<f64>,
    /// Mount of the gyro: optical (the camera's axes: right, down, forward), frd (forward, right, down), flu
    /// (forward, left, up), or 9 numbers: the rotation from the gyro's frame to the camera's, row by row [default:
    /// optical]
    #[arg(long, value_name = "MOUNT", allow_hyphen_values = true, requires = "gyro")]
    camera_from_gyro: Option<Mount>,
    /// Where the camera's rotation is removed from the flow [default: before]
    #[arg(long, value_enum, requires = "gyro")]
    derotation: Option<DerotationArg>,
}

/// Where the camera's rotation is removed from the flow.
#[derive(ValueEnum, Clone, Copy, Debug)]
enum DerotationArg {
    /// From the previous frame, before the flow is estimated: most accurate in fast rotation
    Before,
    /// From the estimated flow
    After,
    /// From the estimated flow, whose search starts from the rotation
    Primed,
}

impl GyroArgs {
    pub(super) fn config(&self) -> Result<Option<GyroConfig>> {
        if self.gyro.is_none() {
            return Ok(None);
        }
        let default = GyroConfig::default();
        let config = GyroConfig {
            bias_rad_s: self.gyro_bias.map_or(default.bias_rad_s, |Numbers(bias)| bias.into()),
            time_offset_s: self.gyro_offset_s.unwrap_or(default.time_offset_s),
            camera_from_gyro: self.camera_from_gyro.map_or(default.camera_from_gyro, |Mount(turn)| turn),
            ..default
        };
        config.validate()?;
        Ok(Some(config))
    }

    pub(super) fn derotation(&self) -> Derotation {
        match self.derotation {
            None | Some(DerotationArg::Before) => Derotation::Before,
            Some(DerotationArg::After) => Derotation::After,
            Some(DerotationArg::Primed) => Derotation::Primed,
        }
    }

    /// Reads the log, to be fed sample by sample.
    pub(super) fn feed(&self) -> Result<GyroFeed> {
        let samples = self.gyro.as_ref().map(gyro_log::read).transpose()?.unwrap_or_default();
        Ok(GyroFeed::new(samples, self.gyro_offset_s.unwrap_or(0.0)))
    }
}

/// Numbers separated by commas or blanks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Numbers<const N: usize>(pub(super) [f64; N]);

impl<const N: usize> FromStr for Numbers<N> {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let words = text.split([',', ' ']).filter(|word| !word.is_empty());
        let numbers: Option<Vec<f64>> = words.map(|word| word.parse().ok()).collect();
        let numbers = numbers.and_then(|numbers| numbers.try_into().ok()).map(Self);
        numbers.ok_or_else(|| Error::parameter("list", text, format_args!("{N} numbers, comma-separated")))
    }
}

/// The rotation from the gyro's frame to the camera's.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Mount(DMat3);

impl FromStr for Mount {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        match text {
            "optical" => Ok(Self(DMat3::IDENTITY)),
            "frd" => Ok(Self(FRD_FROM_CAMERA.transpose())),
            "flu" => Ok(Self(FLU_FROM_CAMERA.transpose())),
            _ => {
                let Numbers([a, b, c, d, e, f, g, h, i]) = text.parse().map_err(|_| {
                    Error::parameter("mount", text, "optical, frd, flu, or 9 numbers, comma-separated")
                })?;
                let rows = [DVec3::new(a, b, c), DVec3::new(d, e, f), DVec3::new(g, h, i)];
                Ok(Self(DMat3::from_cols(rows[0], rows[1], rows[2]).transpose()))
            }
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn mounts_take_the_bodys_axes_to_the_cameras() {
        let to_camera = |mount: &str, axis: DVec3| mount.parse::<Mount>().unwrap().0 * axis;
        for mount in ["frd", "flu"] {
            assert_eq!(to_camera(mount, DVec3::X), DVec3::Z, "forward");
        }
        assert_eq!(to_camera("frd", DVec3::Y), DVec3::X);
        assert_eq!(to_camera("flu", DVec3::Y), DVec3::NEG_X);
        assert_eq!(to_camera("optical", DVec3::Y), DVec3::Y);
        assert_eq!(to_camera("0,1,0, 0,0,1, 1,0,0", DVec3::X), DVec3::Z);
        assert!("1,2".parse::<Mount>().is_err() && "up".parse::<Mount>().is_err());
    }
}
