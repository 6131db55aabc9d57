//! The options for the vehicle and the air, shared by the commands that fly.

use std::str::FromStr;

use clap::{Args, ValueEnum};
use glam::DVec3;

use crate::cli::flow_args::FlowArgs;
use crate::error::{Error, Result};
use crate::sim::flight::{Body, FlightConfig, camera_of_fov};
use crate::sim::vehicle::{Gusts, MAX_WIND_M_S, TurnParams, VaneErrors, VerticalSpeedErrors};
use crate::steer::SteerParams;

/// The options for the vehicle and the air.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Vehicle and air")]
pub(in crate::cli) struct SetupArgs {
    /// Body of the vehicle
    #[arg(long, value_enum, default_value_t = BodyArg::Airframe)]
    body: BodyArg,
    /// Velocity of the air, m/s towards north, east and down, each within ±100
    #[arg(long, value_name = "N,E,D", allow_hyphen_values = true, default_value = "0,0,0")]
    wind: Ned,
    /// Gusts on top of the wind
    #[arg(long, value_enum, default_value_t = GustsArg::None)]
    gusts: GustsArg,
    /// Measure the direction of motion with vanes instead of the flow. Vanes measure it relative to the air, not to the
    /// ground: in wind, which makes the flight drift, steering is worse with them
    #[arg(long)]
    vanes: bool,
    /// Leave the elevation of the direction of motion to the flow, too, without the autopilot's vertical speed
    #[arg(long)]
    no_vertical_speed: bool,
    /// Fly on after a surface came nearer than the vehicle's radius, through it if need be, and count such touches. The
    /// outcome is crashed all the same
    #[arg(long)]
    fly_on: bool,
    /// Horizontal field of view of the camera between the middles of its sides, without its distortion, in degrees, 20 to
    /// 120 [default: 86.7]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, help_heading = "Camera and steering")]
    fov_deg: Option<f64>,
    /// Parameters of the steering, for example radius_m=1.5,memory_s=2. Angles are in radians, times in seconds
    #[arg(
        long,
        value_name = "NAME=VALUE,...",
        value_delimiter = ',',
        allow_hyphen_values = true,
        help_heading = "Camera and steering",
        long_help = steer_help()
    )]
    steer: Vec<String>,
    #[command(flatten)]
    flow: FlowArgs,
}

/// The help of `--steer`: every parameter with its default.
fn steer_help() -> String {
    let params = SteerParams::default();
    let shown = |value: String| match value.parse::<f64>() {
        Ok(number) => ((1e4 * number).round() / 1e4).to_string(),
        Err(_) => value,
    };
    let all = params.named().into_iter().map(|(name, value)| format!("{name}={}", shown(value)));
    format!(
        "Parameters of the steering, for example radius_m=1.5,memory_s=2. Angles are in radians, times in seconds. All, with \
         their defaults to four decimals: {}",
        all.collect::<Vec<_>>().join(", ")
    )
}

#[derive(ValueEnum, Clone, Copy, Debug)]
enum BodyArg {
    /// A rigid body with an inner control loop
    Airframe,
    /// A point in coordinated turns
    Turn,
}

#[derive(ValueEnum, Clone, Copy, Debug)]
enum GustsArg {
    /// Steady wind only
    None,
    /// Light turbulence at an altitude of 50 m
    Light,
    /// Moderate turbulence at an altitude of 50 m
    Moderate,
}

/// Three numbers separated by commas.
#[derive(Clone, Copy, Debug)]
struct Ned(DVec3);

impl FromStr for Ned {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let expected = format!("three speeds as N,E,D, each within ±{MAX_WIND_M_S} m/s");
        let wrong = || Error::parameter("wind", format_args!("{text:?}"), &expected);
        let numbers: Vec<f64> =
            text.split(',').map(|part| part.trim().parse().map_err(|_| wrong())).collect::<Result<_>>()?;
        let axes: [f64; 3] = numbers.try_into().map_err(|_| wrong())?;
        let sound = axes.iter().all(|axis| axis.abs() <= MAX_WIND_M_S);
        if sound { Ok(Self(axes.into())) } else { Err(wrong()) }
    }
}

impl SetupArgs {
    /// The base configuration of all flights. Their flow has parameters of its own unless an algorithm or a preset is
    /// given.
    ///
    /// # Errors
    /// As [`FlowArgs::algorithm`].
    pub(in crate::cli) fn config(&self) -> Result<FlightConfig> {
        let mut config = FlightConfig {
            body: match self.body {
                BodyArg::Airframe => Body::default(),
                BodyArg::Turn => Body::Turn(TurnParams::default()),
            },
            wind_ned_m_s: self.wind.0,
            gusts: match self.gusts {
                GustsArg::None => None,
                GustsArg::Light => Some(Gusts::LIGHT),
                GustsArg::Moderate => Some(Gusts::MODERATE),
            },
            vanes: self.vanes.then(VaneErrors::default),
            vertical_speed: (!self.no_vertical_speed).then(VerticalSpeedErrors::default),
            fly_on: self.fly_on,
            ..FlightConfig::default()
        };
        if let Some(fov_deg) = self.fov_deg {
            if !(20.0..=120.0).contains(&fov_deg) {
                return Err(Error::parameter("--fov-deg", fov_deg, "20 to 120"));
            }
            config.camera = camera_of_fov(config.camera.size, fov_deg.to_radians());
        }
        for part in &self.steer {
            let (name, value) = part
                .split_once('=')
                .ok_or_else(|| Error::parameter("--steer", format_args!("{part:?}"), "NAME=VALUE"))?;
            config.steer.set(name.trim(), value)?;
        }
        config.steer.validate()?;
        config.pipeline.algorithm = self.flow.algorithm_or(&config.pipeline.algorithm)?;
        Ok(config)
    }

    /// The options, as text.
    pub(in crate::cli) fn text(&self) -> String {
        let (body, gusts, vanes) = self.names();
        let [north, east, down] = self.wind.0.to_array();
        let vanes = if vanes { "vanes" } else { "no vanes" };
        let vertical = if self.no_vertical_speed { ", no vertical speed" } else { "" };
        let fly_on = if self.fly_on { ", flown on" } else { "" };
        let fov = self.fov_deg.map(|fov_deg| format!(", fov {fov_deg}°")).unwrap_or_default();
        let steer = if self.steer.is_empty() { String::new() } else { format!(", {}", self.steer.join(",")) };
        format!(
            "body {body}, wind {north},{east},{down}, gusts {gusts}, {vanes}{vertical}{fly_on}{fov}{steer}"
        )
    }

    /// The values of `--body`, `--gusts` and `--vanes`.
    pub(in crate::cli) fn names(&self) -> (String, String, bool) {
        let name = |value: Option<clap::builder::PossibleValue>| {
            value.map(|value| value.get_name().to_owned()).unwrap_or_default()
        };
        (name(self.body.to_possible_value()), name(self.gusts.to_possible_value()), self.vanes)
    }
}
