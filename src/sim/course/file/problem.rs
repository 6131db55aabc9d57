//! Errors of course files, with serde's messages in this crate's form.

use std::borrow::Cow;
use std::fmt::Display;
use std::path::Path;

use serde::Deserialize;
use serde_json::Deserializer;
use serde_json::error::Category;

use crate::error::{Error, Result};
use crate::sim::course::LARGEST_M;

/// The most characters of an invalid value that are shown.
const SHOWN: usize = 80;

/// A part of a file: the whole file, or one surface.
#[derive(Clone, Copy)]
pub(super) struct Part<'a> {
    /// The file's name, for messages.
    pub(super) path: &'a Path,
    /// The name of the part: `course file` or `surface`.
    pub(super) what: &'static str,
    /// The surface's index.
    pub(super) surface: Option<usize>,
}

impl Part<'_> {
    /// Parses the part from its text.
    pub(super) fn read<'de, T: Deserialize<'de>>(&self, text: &'de [u8]) -> Result<T> {
        // Serde would also read a struct from an array of its values.
        if let Some(first @ (b'[' | b'"')) = text.trim_ascii_start().first().copied() {
            let found = if first == b'[' {
                Cow::from("an array")
            } else {
                String::from_utf8_lossy(text.trim_ascii())
            };
            return Err(self.wrong(self.what, found, "an object in braces"));
        }
        let mut json = Deserializer::from_slice(text);
        let value = serde_path_to_error::deserialize(&mut json).map_err(|error| {
            let member = error.path().to_string();
            self.problem(&member, error.inner())
        })?;
        json.end().map_err(|error| self.problem("", &error))?;
        Ok(value)
    }

    /// An error about a member.
    pub(super) fn wrong(
        &self,
        member: impl Into<Cow<'static, str>>,
        found: impl Display,
        expected: impl Display,
    ) -> Error {
        let place = self.surface.map_or(String::new(), |surface| format!(" in surface {surface}"));
        Error::format(self.path, member, shortened(&found.to_string()) + &place, expected)
    }

    /// Turns an error about a value into one that also names the file.
    pub(super) fn in_file(&self, error: Error) -> Error {
        match error {
            Error::Parameter { name, value, expected } => self.wrong(name, value, expected),
            other => other,
        }
    }

    /// The error of a member, from serde's message: an invalid type or value, an unknown member, a missing or a
    /// repeated one.
    fn problem(&self, member: &str, error: &serde_json::Error) -> Error {
        let text = error.to_string();
        if error.classify() != Category::Data {
            return self.wrong(self.what, format_args!("broken: {}", self.placed(&text)), "JSON");
        }
        let text = text.rfind(" at line ").map_or(&*text, |end| &text[..end]);
        let named = |prefix: &str| Some(text.strip_prefix(prefix)?.trim_matches('`').to_owned());
        if let Some(name) = named("missing field ") {
            return self.wrong(name, "missing", "exactly one");
        }
        if let Some(name) = named("duplicate field ") {
            return self.wrong(name, "given twice", "exactly one");
        }
        let (found, expected) = text.split_once(", expected ").unwrap_or((text, "something else"));
        let expected = plain(expected);
        if let Some(name) = found.strip_prefix("unknown field ") {
            return self.wrong("member", format_args!("{:?}", name.trim_matches('`')), expected);
        }
        let member = if member == "." { self.what.to_owned() } else { member.to_owned() };
        if let Some(name) = found.strip_prefix("unknown variant ") {
            return self.wrong(member, format_args!("{:?}", name.trim_matches('`')), expected);
        }
        let found = match found.split_once(": ") {
            Some(("invalid type" | "invalid value", value)) => shown(value).to_owned(),
            _ => found.replace("invalid length ", "of length "),
        };
        self.wrong(member, found, expected)
    }

    /// The message, with line and column only for the whole file: those of a surface do not count from the beginning of
    /// the file.
    fn placed<'t>(&self, text: &'t str) -> &'t str {
        match (self.surface, text.rfind(" at line ")) {
            (Some(_), Some(end)) => &text[..end],
            _ => text,
        }
    }
}

/// A value, from serde's description of it, such as "integer `3`".
fn shown(value: &str) -> &str {
    match value {
        "map" => "an object",
        "sequence" => "an array",
        _ => match value.split_once('`') {
            Some((_, number)) => number.trim_end_matches('`'),
            None => value.strip_prefix("string ").unwrap_or(value),
        },
    }
}

/// The expectation, from serde's description of it.
fn plain(expected: &str) -> String {
    match expected {
        "u64" => "a whole number from 0 to 2^64 - 1".to_owned(),
        "f64" => format!("a number within ±{LARGEST_M}"),
        "a string" => "a text".to_owned(),
        "a sequence" => "an array in brackets".to_owned(),
        other => other.trim_start_matches("one of ").replace('`', ""),
    }
}

fn shortened(text: &str) -> String {
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}
