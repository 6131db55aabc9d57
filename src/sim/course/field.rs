//! A generator's parameters as a list, from which their validation, parsing and formatting follow.

use std::fmt;

use crate::error::{Error, Result};

/// A named parameter. It has one value, or the two ends of the range that each value is drawn from.
pub(super) struct Field<'a> {
    pub(super) name: &'static str,
    values: &'a mut [f64],
    limits: [f64; 2],
    unit: &'static str,
}

impl<'a> Field<'a> {
    pub(super) fn one(name: &'static str, value: &'a mut f64, limits: [f64; 2], unit: &'static str) -> Self {
        Self { name, values: std::slice::from_mut(value), limits, unit }
    }

    pub(super) fn range(
        name: &'static str,
        ends: &'a mut [f64; 2],
        limits: [f64; 2],
        unit: &'static str,
    ) -> Self {
        Self { name, values: ends, limits, unit }
    }

    /// Whether the values are within their limits and in order.
    pub(super) fn check(&self) -> Result<()> {
        if self.are_sound(self.values) { Ok(()) } else { Err(self.wrong(self)) }
    }

    /// Parses a value, such as `0.02` or `1/64`, or a range, such as `-20..20`.
    pub(super) fn read(&mut self, text: &str) -> Result<()> {
        let ends = if self.values.len() == 1 { None } else { text.split_once("..") };
        let (from, to) = ends.unwrap_or((text, text));
        match [number(from), number(to)] {
            [Some(from), Some(to)] if self.are_sound(&[from, to]) => {
                for (value, end) in self.values.iter_mut().zip([from, to]) {
                    *value = end;
                }
                Ok(())
            }
            [Some(high), Some(low)] if self.are_sound(&[low, high]) => {
                let expected = format!("the lower end first: {low}..{high}");
                Err(Error::parameter(self.name, format_args!("{text:?}"), expected))
            }
            _ => Err(self.wrong(format_args!("{text:?}"))),
        }
    }

    fn are_sound(&self, values: &[f64]) -> bool {
        let [low, high] = self.limits;
        values.iter().all(|value| (low..=high).contains(value)) && values.is_sorted()
    }

    pub(super) fn is_as(&self, other: &Field<'_>) -> bool {
        self.values == other.values
    }

    fn wrong(&self, found: impl ToString) -> Error {
        let [low, high] = self.limits;
        let unit = self.unit;
        let expected = match self.values.len() {
            1 => format!("{low} to {high} {unit}"),
            _ => format!("a value or a range such as {low}..{high} within {low} to {high} {unit}"),
        };
        Error::parameter(self.name, found, expected.trim_end())
    }
}

impl fmt::Display for Field<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &*self.values {
            [from, to] if from != to => write!(f, "{from}..{to}"),
            values => write!(f, "{}", values[0]),
        }
    }
}

/// Parses a decimal, or a quotient of two.
fn number(text: &str) -> Option<f64> {
    let (above, below) = text.split_once('/').unwrap_or((text, "1"));
    let number = |text: &str| text.trim().parse::<f64>().ok();
    Some(number(above)? / number(below)?)
}

/// Validates all parameters of a generator.
pub(super) fn check(fields: &[Field<'_>]) -> Result<()> {
    fields.iter().try_for_each(Field::check)
}
