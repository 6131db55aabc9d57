//! The parameters of a generator as a list, from which follow their check and how they are read and shown.

use std::fmt;

use crate::error::{Error, Result};

/// A parameter under its name in text. It has one value, or the two ends of the range that each value is drawn from.
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
        let [low, high] = self.limits;
        let sound = self.values.iter().all(|value| (low..=high).contains(value)) && self.values.is_sorted();
        if sound { Ok(()) } else { Err(self.wrong(self)) }
    }

    /// Reads a value, such as `0.02` or `1/64`, or a range, such as `-20..20`.
    pub(super) fn read(&mut self, text: &str) -> Result<()> {
        let wrong = || self.wrong(text);
        if self.values.len() == 1 {
            self.values[0] = number(text).ok_or_else(wrong)?;
        } else {
            let (from, to) = text.split_once("..").unwrap_or((text, text));
            let ends = [number(from).ok_or_else(wrong)?, number(to).ok_or_else(wrong)?];
            self.values.copy_from_slice(&ends);
        }
        self.check()
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

/// A decimal, or a quotient of two.
fn number(text: &str) -> Option<f64> {
    let (above, below) = text.split_once('/').unwrap_or((text, "1"));
    let number = |text: &str| text.trim().parse::<f64>().ok();
    Some(number(above)? / number(below)?)
}

/// Checks all parameters of a generator.
pub(super) fn check(fields: &[Field<'_>]) -> Result<()> {
    fields.iter().try_for_each(Field::check)
}
