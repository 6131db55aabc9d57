//! Parsers of flag values shared by several subcommands, and errors that name the flag.

use std::fmt::Display;
use std::str::FromStr;

use crate::error::{Error, Result};

/// Parses a whole number.
pub(super) fn whole<T: FromStr>(text: &str) -> Result<T> {
    let wrong = |_| Error::parameter("number", format_args!("{text:?}"), "a whole number from 0 on");
    text.trim().parse().map_err(wrong)
}

/// Parses a whole number from `low` to `high`.
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

/// Renames an error's parameter to the flag that set it.
pub(super) fn named_by_flags(error: Error, flags: &[(&'static str, &'static str)]) -> Error {
    match error {
        Error::Parameter { name, value, expected } => {
            let flag = flags.iter().find(|(parameter, _)| *parameter == name);
            Error::Parameter { name: flag.map_or(name, |(_, flag)| flag), value, expected }
        }
        error => error,
    }
}
