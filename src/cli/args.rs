//! The flags that several subcommands share.

use std::fmt::Display;
use std::str::FromStr;

use clap::{Args, ValueEnum};

use crate::error::{Error, Result};
use crate::flow::{Farneback, Outside, Update, Window};

/// Reads a whole number, and says so of what is none.
pub(super) fn whole<T: FromStr>(text: &str) -> Result<T> {
    let wrong = |_| Error::parameter("number", format_args!("{text:?}"), "a whole number from 0 on");
    text.trim().parse().map_err(wrong)
}

/// Reads a whole number from `low` to `high`, and says so of what is none.
pub(super) fn whole_within<T>(low: T, high: T) -> impl Fn(&str) -> Result<T> + Clone + Send + Sync
where
    T: FromStr + PartialOrd + Display + Copy + Send + Sync,
{
    move |text| {
        let number = text.trim().parse().ok().filter(|number| (low..=high).contains(number));
        let expected = format_args!("a whole number from {low} to {high}");
        number.ok_or_else(|| Error::parameter("number", format_args!("{text:?}"), expected))
    }
}

/// An error about a parameter, as one about the flag that it was given by.
pub(super) fn named_by_flags(error: Error, flags: &[(&'static str, &'static str)]) -> Error {
    match error {
        Error::Parameter { name, value, expected } => {
            let flag = flags.iter().find(|(parameter, _)| *parameter == name);
            Error::Parameter { name: flag.map_or(name, |(_, flag)| flag), value, expected }
        }
        error => error,
    }
}

/// Parameters of the flow.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Flow parameters")]
pub(super) struct FlowArgs {
    /// Parameters to begin with; the flags below replace single ones, and their defaults are those of the preset default
    #[arg(long, value_enum, default_value_t = Preset::Default)]
    preset: Preset,
    /// A level's size against the next finer one, above 0 and below 1 [default: 0.5]
    #[arg(long, value_name = "RATIO", allow_negative_numbers = true)]
    pyr_scale: Option<f64>,
    /// Levels beside the full picture, 0 to 32 [default: 3]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    levels: Option<u32>,
    /// Width of the averaging window in pixels, 2 to 1024 [default: 15]
    #[arg(long, value_name = "PX", allow_negative_numbers = true)]
    winsize: Option<u32>,
    /// Iterations on each level, 1 to 1000 [default: 3]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    iterations: Option<u32>,
    /// Radius of the polynomial expansion in pixels, 1 to 32 [default: 5]
    #[arg(long, value_name = "PX", allow_negative_numbers = true)]
    poly_n: Option<u32>,
    /// Standard deviation of the expansion's Gaussian in pixels, 0 to 100; 0 is 0.3 × poly-n [default: 1.2]
    #[arg(long, value_name = "PX", allow_negative_numbers = true)]
    poly_sigma: Option<f64>,
    /// Shape of the averaging window [default: box]
    #[arg(long, value_enum)]
    window: Option<WindowArg>,
    /// What the window averages in each iteration [default: flow]
    #[arg(long, value_enum)]
    update: Option<UpdateArg>,
    /// What a pixel counts for where the flow leads out of the second picture [default: first]
    #[arg(long, value_enum)]
    outside: Option<OutsideArg>,
}

#[derive(ValueEnum, Clone, Copy, Debug)]
enum Preset {
    /// Half the default's work: 1 iteration, winsize 13
    Fast,
    /// 3 iterations, winsize 15, 3 levels
    Default,
    /// Three times the default's work: 10 iterations, winsize 13, 5 levels, poly-sigma 1.1
    Accurate,
    /// Half the default's work and less error, except where there is no texture (as in a sky): 1 iteration of increments,
    /// Gaussian winsize 31, nothing from outside the picture
    Increment,
}

#[derive(ValueEnum, Clone, Copy, Debug)]
enum WindowArg {
    /// All neighbours count the same
    Box,
    /// Near neighbours count more
    Gaussian,
}

#[derive(ValueEnum, Clone, Copy, Debug)]
enum UpdateArg {
    /// The flow, as OpenCV does
    Flow,
    /// What is added to the flow so far: finer detail from a wider window. Takes a Gaussian window, or one iteration
    Increment,
}

#[derive(ValueEnum, Clone, Copy, Debug)]
enum OutsideArg {
    /// The first picture stands alone there, as in OpenCV
    First,
    /// Nothing: the window's other pixels decide
    Nothing,
}

impl FlowArgs {
    /// The parameters, checked.
    pub(super) fn farneback(&self) -> Result<Farneback> {
        let preset = match self.preset {
            Preset::Fast => Farneback::fast(),
            Preset::Default => Farneback::default(),
            Preset::Accurate => Farneback::accurate(),
            Preset::Increment => Farneback::increment(),
        };
        let window = self.window.map(|window| match window {
            WindowArg::Box => Window::Box,
            WindowArg::Gaussian => Window::Gaussian,
        });
        let update = self.update.map(|update| match update {
            UpdateArg::Flow => Update::Flow,
            UpdateArg::Increment => Update::Increment,
        });
        let outside = self.outside.map(|outside| match outside {
            OutsideArg::First => Outside::First,
            OutsideArg::Nothing => Outside::Nothing,
        });
        let flow = Farneback {
            pyr_scale: self.pyr_scale.unwrap_or(preset.pyr_scale),
            levels: self.levels.unwrap_or(preset.levels),
            winsize: self.winsize.unwrap_or(preset.winsize),
            iterations: self.iterations.unwrap_or(preset.iterations),
            poly_n: self.poly_n.unwrap_or(preset.poly_n),
            poly_sigma: self.poly_sigma.unwrap_or(preset.poly_sigma),
            window: window.unwrap_or(preset.window),
            update: update.unwrap_or(preset.update),
            outside: outside.unwrap_or(preset.outside),
            ..preset
        };
        flow.validate()?;
        Ok(flow)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn the_help_tells_the_default_of_every_parameter() {
        let command = FlowArgs::augment_args(clap::Command::new("flow"));
        let flow = Farneback::default();
        for (id, value) in [
            ("pyr_scale", flow.pyr_scale.to_string()),
            ("levels", flow.levels.to_string()),
            ("winsize", flow.winsize.to_string()),
            ("iterations", flow.iterations.to_string()),
            ("poly_n", flow.poly_n.to_string()),
            ("poly_sigma", flow.poly_sigma.to_string()),
            ("window", format!("{:?}", flow.window).to_lowercase()),
            ("update", format!("{:?}", flow.update).to_lowercase()),
            ("outside", format!("{:?}", flow.outside).to_lowercase()),
        ] {
            let mut arguments = command.get_arguments();
            let help = arguments.find(|argument| argument.get_id() == id).unwrap().get_help().unwrap();
            assert!(help.to_string().ends_with(&format!("[default: {value}]")), "{id}: {help}");
        }
    }
}
