//! What is wrong with a file, in this crate's words.

use std::borrow::Cow;
use std::fmt::Display;
use std::path::Path;

use serde::Deserialize;
use serde_json::Deserializer;
use serde_json::error::Category;

use crate::error::{Error, Result};
use crate::sim::course::LARGEST_M;

/// Characters of a wrong value that are shown.
const SHOWN: usize = 80;

/// A part of a file: all of it, or a surface.
#[derive(Clone, Copy)]
pub(super) struct Part<'a> {
    /// The file's name, for messages.
    pub(super) path: &'a Path,
    /// What it is: `course file` or `surface`.
    pub(super) what: &'static str,
    /// The number of the surface.
    pub(super) surface: Option<usize>,
}

impl Part<'_> {
    /// Reads the part from its text.
    pub(super) fn read<'de, T: Deserialize<'de>>(&self, text: &'de [u8]) -> Result<T> {
        // A struct of serde is read from a list of its values too.
        if let Some(first @ (b'[' | b'"')) = text.trim_ascii_start().first().copied() {
            let found =
                if first == b'[' { Cow::from("a list") } else { String::from_utf8_lossy(text.trim_ascii()) };
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

    /// An error about a value, as one about the file that it is from.
    pub(super) fn in_file(&self, error: Error) -> Error {
        match error {
            Error::Parameter { name, value, expected } => self.wrong(name, value, expected),
            other => other,
        }
    }

    /// What serde says of a member: an invalid type or value and what was expected; or that there is no such member, none or
    /// two of them.
    fn problem(&self, member: &str, error: &serde_json::Error) -> Error {
        let text = error.to_string();
        if error.classify() != Category::Data {
            return self.wrong(self.what, format_args!("broken: {}", self.placed(&text)), "JSON");
        }
        let text = text.rfind(" at line ").map_or(&*text, |end| &text[..end]);
        let named = |prefix: &str| Some(text.strip_prefix(prefix)?.trim_matches('`').to_owned());
        if let Some(name) = named("missing field ") {
            return self.wrong(name, "missing", "it once");
        }
        if let Some(name) = named("duplicate field ") {
            return self.wrong(name, "there twice", "it once");
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

    /// A message with its line and column, where these are the file's.
    fn placed<'t>(&self, text: &'t str) -> &'t str {
        match (self.surface, text.rfind(" at line ")) {
            (Some(_), Some(end)) => &text[..end],
            _ => text,
        }
    }
}

/// A value from serde's words for it, such as "integer `3`".
fn shown(value: &str) -> &str {
    match value {
        "map" => "an object",
        "sequence" => "a list",
        _ => match value.split_once('`') {
            Some((_, number)) => number.trim_end_matches('`'),
            None => value.strip_prefix("string ").unwrap_or(value),
        },
    }
}

/// What was expected, from serde's words for it.
fn plain(expected: &str) -> String {
    match expected {
        "u64" => "a whole number from 0 to 2^64 - 1".to_owned(),
        "f64" => format!("a number within ±{LARGEST_M}"),
        "a string" => "a text".to_owned(),
        "a sequence" => "a list in brackets".to_owned(),
        other => other.trim_start_matches("one of ").replace('`', ""),
    }
}

fn shortened(text: &str) -> String {
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}
