//! The options for the vehicle and the air, shared by the commands that fly.

use std::str::FromStr;

use clap::{Args, ValueEnum};
use glam::DVec3;

use crate::cli::flow_args::FlowArgs;
use crate::error::{Error, Result};
use crate::sim::flight::{Body, FlightConfig};
use crate::sim::vehicle::{Gusts, MAX_WIND_M_S, TurnParams, VaneErrors};

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
    #[command(flatten)]
    flow: FlowArgs,
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
            ..FlightConfig::default()
        };
        config.pipeline.algorithm = self.flow.algorithm_or(&config.pipeline.algorithm)?;
        Ok(config)
    }

    /// The options, as text.
    pub(in crate::cli) fn text(&self) -> String {
        let (body, gusts, vanes) = self.names();
        let [north, east, down] = self.wind.0.to_array();
        let vanes = if vanes { "vanes" } else { "no vanes" };
        format!("body {body}, wind {north},{east},{down}, gusts {gusts}, {vanes}")
    }

    /// The values of `--body`, `--gusts` and `--vanes`.
    pub(in crate::cli) fn names(&self) -> (String, String, bool) {
        let name = |value: Option<clap::builder::PossibleValue>| {
            value.map(|value| value.get_name().to_owned()).unwrap_or_default()
        };
        (name(self.body.to_possible_value()), name(self.gusts.to_possible_value()), self.vanes)
    }
}
