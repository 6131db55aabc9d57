use std::fmt::Display;
use std::path::Path;

use serde_json::{Map, Value};

use crate::error::{Error, Result};
use crate::sim::course::LARGEST_M;

/// Characters of a wrong value that are shown.
const SHOWN: usize = 80;

/// The members of a JSON object, which are taken one by one: what is left at the end is not known.
pub(super) struct Members<'a> {
    path: &'a Path,
    /// For messages: which of several objects it is.
    place: String,
    map: Map<String, Value>,
}

impl<'a> Members<'a> {
    pub(super) fn new(path: &'a Path, what: &'static str, place: String, value: Value) -> Result<Self> {
        match value {
            Value::Object(map) => Ok(Self { path, place, map }),
            other => {
                Err(Error::format(path, what, shortened(&other.to_string()) + &place, "an object in braces"))
            }
        }
    }

    /// An error about a member.
    pub(super) fn wrong(&self, key: &'static str, found: impl Display, expected: impl Display) -> Error {
        let found = shortened(&found.to_string()) + &self.place;
        Error::format(self.path, key, found, expected)
    }

    /// An error about a value, as one about the file that it is from.
    pub(super) fn in_file(&self, error: Error) -> Error {
        match error {
            Error::Parameter { name, value, expected } => self.wrong(name, value, expected),
            other => other,
        }
    }

    /// Says of what follows where it is.
    pub(super) fn place(&mut self, place: String) {
        self.place = place;
    }

    pub(super) fn has(&self, key: &str) -> bool {
        self.map.contains_key(key)
    }

    pub(super) fn number(&mut self, key: &'static str) -> Result<f64> {
        let expected = format!("a number within ±{LARGEST_M}");
        let value = self.take(key, &expected)?;
        number(&value).ok_or_else(|| self.wrong(key, &value, expected))
    }

    pub(super) fn numbers<const N: usize>(&mut self, key: &'static str) -> Result<[f64; N]> {
        let expected = format!("{N} numbers in brackets, within ±{LARGEST_M}");
        let value = self.take(key, &expected)?;
        numbers(&value).ok_or_else(|| self.wrong(key, &value, expected))
    }

    /// A list of lists of as many numbers.
    pub(super) fn rows<const N: usize>(&mut self, key: &'static str) -> Result<Vec<[f64; N]>> {
        let expected = format!("a list of lists of {N} numbers within ±{LARGEST_M}");
        let value = self.take(key, &expected)?;
        let rows = value.as_array().and_then(|rows| rows.iter().map(numbers).collect());
        rows.ok_or_else(|| self.wrong(key, &value, expected))
    }

    pub(super) fn whole(&mut self, key: &'static str) -> Result<u64> {
        let expected = "a whole number from 0 to 2^64 - 1";
        let value = self.take(key, expected)?;
        value.as_u64().ok_or_else(|| self.wrong(key, &value, expected))
    }

    pub(super) fn text(&mut self, key: &'static str, expected: &str) -> Result<String> {
        match self.take(key, expected)? {
            Value::String(text) => Ok(text),
            other => Err(self.wrong(key, other, expected)),
        }
    }

    pub(super) fn list(&mut self, key: &'static str) -> Result<Vec<Value>> {
        match self.take(key, "a list in brackets")? {
            Value::Array(list) => Ok(list),
            other => Err(self.wrong(key, other, "a list in brackets")),
        }
    }

    /// Checks that nothing is left.
    pub(super) fn end(&self, known: &str) -> Result<()> {
        match self.map.keys().next() {
            Some(key) => Err(self.wrong("member", format_args!("{key:?}"), known)),
            None => Ok(()),
        }
    }

    fn take(&mut self, key: &'static str, expected: &str) -> Result<Value> {
        self.map.remove(key).ok_or_else(|| self.wrong(key, "missing", expected))
    }
}

fn number(value: &Value) -> Option<f64> {
    value.as_f64().filter(|number| number.abs() <= LARGEST_M)
}

fn numbers<const N: usize>(value: &Value) -> Option<[f64; N]> {
    let list: Option<Vec<f64>> = value.as_array()?.iter().map(number).collect();
    list?.try_into().ok()
}

fn shortened(text: &str) -> String {
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}
