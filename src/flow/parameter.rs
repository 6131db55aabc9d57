//! The parameters of an estimator by name, for command lines and records.

use std::fmt::Display;
use std::str::FromStr;

use crate::error::{Error, Result};

/// A parameter of an estimator.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// The name, as in the struct.
    pub name: &'static str,
    /// The placeholder of its value in a help text, for example `PX`.
    pub value_name: &'static str,
    /// The meaning and the range, in one line.
    pub help: &'static str,
    /// The possible values, each with its meaning; empty for numbers.
    pub choices: &'static [Choice],
}

impl Parameter {
    /// A number.
    pub(crate) const fn number(name: &'static str, value_name: &'static str, help: &'static str) -> Self {
        Self { name, value_name, help, choices: &[] }
    }

    /// One of several named values.
    pub(crate) const fn choice(name: &'static str, help: &'static str, choices: &'static [Choice]) -> Self {
        Self { name, value_name: "NAME", help, choices }
    }
}

/// A named value and its meaning, in one line.
pub type Choice = (&'static str, &'static str);

/// A set of parameters that can be listed, read and set by name.
pub trait Parameters: Sized + Default {
    /// The name of the method on the command line and in JSON.
    const NAME: &'static str;
    /// A one-line description of the method.
    const ABOUT: &'static str;
    /// All parameters, in the order of a help text.
    const LIST: &'static [Parameter];
    /// The presets: named sets of values, each with its meaning; one of them is `default`.
    const PRESETS: &'static [Choice];

    /// The values of a preset; `None` for an unknown name.
    fn preset(name: &str) -> Option<Self>;

    /// The value of a parameter as text; `None` for an unknown name.
    fn get(&self, name: &str) -> Option<String>;

    /// Sets a parameter from text. It does not check ranges: [`Estimator::validate`](super::Estimator::validate) does.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an unknown parameter, and for text that is not one of its values.
    fn set(&mut self, name: &str, value: &str) -> Result<()>;
}

/// Reads a parameter's value from text.
///
/// # Errors
/// [`Error::Parameter`] with the parameter's help if the text is not a value of it.
pub(crate) fn read<T: FromStr>(list: &'static [Parameter], name: &str, value: &str) -> Result<T> {
    value.trim().parse().map_err(|_| wrong(list, name, value))
}

/// The error of a value that cannot be parsed, or of an unknown parameter.
pub(crate) fn wrong(list: &'static [Parameter], name: &str, value: &str) -> Error {
    match list.iter().find(|parameter| parameter.name == name) {
        None => {
            let names: Vec<&str> = list.iter().map(|parameter| parameter.name).collect();
            Error::parameter("parameter", format_args!("{name:?}"), names.join(", "))
        }
        Some(Parameter { name, choices: [], help, .. }) => {
            Error::parameter(name, format_args!("{value:?}"), lower_first(help))
        }
        Some(Parameter { name, choices, .. }) => {
            let values: Vec<&str> = choices.iter().map(|(value, _)| *value).collect();
            Error::parameter(name, format_args!("{value:?}"), values.join(" or "))
        }
    }
}

fn lower_first(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map(|first| first.to_lowercase().chain(letters).collect()).unwrap_or_default()
}

/// Possible values: the name and the value of each.
pub(crate) fn choice_name<T: PartialEq + Copy>(choices: &[(&'static str, T)], value: T) -> &'static str {
    choices.iter().find(|(_, known)| *known == value).map_or("", |(name, _)| name)
}

/// The value of a name.
pub(crate) fn choose<T: Copy>(
    list: &'static [Parameter],
    choices: &[(&'static str, T)],
    name: &str,
    value: &str,
) -> Result<T> {
    let known = choices.iter().find(|(known, _)| *known == value.trim());
    known.map(|(_, value)| *value).ok_or_else(|| wrong(list, name, value))
}

/// Checks that a number is within a range, limits included. NaN is outside.
pub(crate) fn within<T: PartialOrd + Display>(name: &'static str, value: T, low: T, high: T) -> Result<()> {
    if value >= low && value <= high {
        return Ok(());
    }
    Err(Error::parameter(name, value, format_args!("{low} to {high}")))
}
