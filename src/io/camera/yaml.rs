//! The subset of YAML in camera files: nested keys, lists, numbers and words.
//!
//! A parser of our own, because the files are not quite YAML: OpenCV writes `%YAML:1.0`, which no YAML version
//! allows, and tags of its own, at which ordinary parsers stop; and because a general parser would be larger than
//! everything else here. What the parser does not understand is skipped, and reported as missing on request.

use std::collections::BTreeMap;
use std::path::Path;

use crate::error::{Error, Result};
use crate::frame::Size;

/// The deepest nesting that is read; deeper keys are not needed.
const MAX_DEPTH: usize = 4;

/// The values of a file by their keys, in lower case and joined by `/`. Lists are flattened.
pub(super) struct Yaml<'a> {
    pub(super) path: &'a Path,
    values: BTreeMap<String, Vec<String>>,
}

impl<'a> Yaml<'a> {
    pub(super) fn parse(path: &'a Path, text: &str) -> Result<Self> {
        let mut values = BTreeMap::new();
        // The enclosing keys of the line, with their indents.
        let mut around: Vec<(usize, String)> = Vec::new();
        let mut lines = text.trim_start_matches('\u{feff}').lines();
        let mut begun = false;
        while let Some(line) = lines.next() {
            if line.starts_with('%') {
                continue;
            }
            if line.trim_end() == "---" || line.trim_end() == "..." {
                if begun {
                    break;
                }
                continue;
            }
            let line = without_comment(line);
            let content = line.trim();
            let indent = line.len() - line.trim_start().len();
            let is_item = content == "-" || content.starts_with("- ");
            if content.is_empty() {
                continue;
            }
            begun = true;
            // Items may be indented as little as their key.
            while around.last().is_some_and(|(of, _)| *of > indent || (*of == indent && !is_item)) {
                around.pop();
            }
            let value = if is_item {
                let value = content.trim_start_matches(['-', ' ']);
                // The sign belongs to the number.
                let start = content.len() - value.len();
                let signed = start > 0 && content.as_bytes()[start - 1] == b'-';
                if signed { &content[start - 1..] } else { value }
            } else {
                let Some((key, value)) = split_key(content) else { continue };
                around.push((indent, unquoted(key).to_lowercase()));
                value
            };
            if around.is_empty() || around.len() > MAX_DEPTH {
                continue;
            }
            let key = around.iter().map(|(_, key)| key.as_str()).collect::<Vec<_>>().join("/");
            let mut list = without_tags(value).to_owned();
            while open_brackets(&list) {
                let Some(more) = lines.next() else {
                    return Err(Error::format(path, "a list", format_args!("never closed: {key}"), "a ]"));
                };
                list.push(' ');
                list.push_str(without_comment(more).trim());
            }
            if !is_item && values.contains_key(&key) {
                return Err(Error::format(path, "a key", format_args!("repeated: {key}"), "once"));
            }
            values.entry(key).or_insert_with(Vec::new).extend(scalars(&list));
        }
        Ok(Self { path, values })
    }

    /// The values within a key.
    pub(super) fn within(&self, key: &str) -> Yaml<'a> {
        let prefix = format!("{key}/");
        let inside = |(name, values): (&String, &Vec<String>)| {
            Some((name.strip_prefix(&prefix)?.to_owned(), values.clone()))
        };
        Yaml { path: self.path, values: self.values.iter().filter_map(inside).collect() }
    }

    /// The outermost keys.
    pub(super) fn keys(&self) -> Vec<&str> {
        let mut keys: Vec<&str> = self.values.keys().filter_map(|key| key.split('/').next()).collect();
        keys.dedup();
        keys
    }

    pub(super) fn has(&self, key: &str) -> bool {
        self.values.contains_key(key)
    }

    /// The word at a key, empty if it is missing.
    pub(super) fn word(&self, key: &str) -> &str {
        self.values.get(key).and_then(|values| values.first()).map_or("", String::as_str)
    }

    /// The first of several names that has a value, else the first of all.
    pub(super) fn name(&self, names: &[&'static str]) -> &'static str {
        names.iter().copied().find(|name| self.has(name)).unwrap_or(names[0])
    }

    pub(super) fn numbers(&self, key: &'static str) -> Result<Vec<f64>> {
        let Some(values) = self.values.get(key) else {
            return Err(Error::format(self.path, key, "missing", "a list of numbers"));
        };
        let number = |text: &String| match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(Error::format(self.path, key, shortened(text), "a finite number")),
        };
        values.iter().map(number).collect()
    }

    /// Exactly N numbers.
    pub(super) fn array<const N: usize>(&self, key: &'static str) -> Result<[f64; N]> {
        let numbers = self.numbers(key)?;
        <[f64; N]>::try_from(numbers).map_err(|numbers| {
            let found = if numbers.is_empty() { "empty".to_owned() } else { format!("{numbers:?}") };
            Error::format(
                self.path,
                key,
                shortened(&found),
                format_args!("{N} number{}", if N == 1 { "" } else { "s" }),
            )
        })
    }

    /// The image size, from one key with two numbers or from two keys.
    pub(super) fn size(&self, keys: &[&'static str]) -> Result<Size> {
        let numbers = match keys {
            [both] => self.array::<2>(both)?,
            [width, height, ..] => [self.array::<1>(width)?[0], self.array::<1>(height)?[0]],
            [] => [0.0; 2],
        };
        let side = |value: f64| if value.fract() == 0.0 { value as u32 } else { 0 };
        let [width, height] = numbers;
        Size::new(side(width), side(height)).validate().map_err(|_| {
            let expected = format!("1×1 to {0}×{0}", Size::MAX_SIDE);
            Error::format(self.path, "size", format_args!("{width}×{height}"), expected)
        })
    }
}

fn shortened(text: &str) -> String {
    const MOST: usize = 60;
    match text.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

/// The line up to a `#` that starts a comment.
fn without_comment(line: &str) -> &str {
    let mut quote = None;
    let mut before = ' ';
    for (at, c) in line.char_indices() {
        match quote {
            Some(open) if c == open => quote = None,
            Some(_) => {}
            None if c == '"' || c == '\'' => quote = Some(c),
            None if c == '#' && before.is_whitespace() => return &line[..at],
            None => {}
        }
        before = c;
    }
    line
}

/// The key and value of `key: value` or `key:`.
fn split_key(content: &str) -> Option<(&str, &str)> {
    let (key, value) = match content.strip_suffix(':') {
        Some(key) if !content.contains(": ") => (key, ""),
        // OpenCV writes lists of numbers without a space after the colon.
        _ => content.split_once(": ").or_else(|| content.split_once(":["))?,
    };
    let value = if content[key.len()..].starts_with(":[") { &content[key.len() + 1..] } else { value };
    Some((key.trim(), value.trim()))
}

/// The value without preceding tags (`!!opencv-matrix`) and anchors (`&x`).
fn without_tags(mut value: &str) -> &str {
    while value.starts_with(['!', '&']) {
        value = value.split_once(char::is_whitespace).map_or("", |(_, rest)| rest.trim_start());
    }
    value
}

fn open_brackets(list: &str) -> bool {
    list.starts_with(['[', '{']) && {
        let count = |brackets: [char; 2]| list.matches(brackets).count();
        count(['[', '{']) > count([']', '}'])
    }
}

fn scalars(list: &str) -> Vec<String> {
    let parts = list.split([',', '[', ']']).map(|part| unquoted(part.trim()));
    if list.starts_with('[') {
        parts.filter(|part| !part.is_empty()).map(str::to_owned).collect()
    } else if list.is_empty() {
        Vec::new()
    } else {
        vec![unquoted(list).to_owned()]
    }
}

fn unquoted(text: &str) -> &str {
    let inside = |quote| text.strip_prefix(quote)?.strip_suffix(quote);
    inside('"').or_else(|| inside('\'')).unwrap_or(text)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Yaml<'_> {
        Yaml::parse(Path::new("a.yaml"), text).unwrap()
    }

    #[test]
    fn lists_are_flattened_however_they_are_written() {
        for text in [
            "a:\n  b: [1, -2.5e+00, .5, 3.]",
            "a:\n  b: [ 1, -2.5,\n     0.5, # a comment\n  3 ]\n",
            "a:\n  b:\n  - 1\n  - -2.5\n  - 0.5\n  - 3",
            "a:\n  b:\n    - [1, -2.5]\n    - [0.5, 3]\n",
            "a:\n  b:\n    - - 1\n      - -2.5\n    - - 0.5\n      - 3\n",
            "\u{feff}%YAML:1.0\n---\nA: !!map\n   'B': !!opencv-matrix [1,-2.5,0.5,3]\n",
        ] {
            assert_eq!(parse(text).numbers("a/b").unwrap(), [1.0, -2.5, 0.5, 3.0], "{text}");
        }
    }

    #[test]
    fn keys_end_with_their_indent() {
        let yaml = parse("a:\n  b: 1\n  c:\n    d: x # y\ne: \"z # z\"\n---\nf: 1\n");
        assert_eq!(yaml.keys(), ["a", "e"]);
        assert_eq!((yaml.word("a/c/d"), yaml.word("e"), yaml.word("f")), ("x", "z # z", ""));
        assert_eq!(yaml.within("a").array::<1>("b").unwrap(), [1.0]);
    }

    #[test]
    fn what_is_wrong_is_named() {
        let text = |result: Result<Vec<f64>>| result.unwrap_err().to_string();
        let yaml = parse("a: [1, x]\nb: .nan\nc: nan\n");
        assert_eq!(text(yaml.numbers("a")), "a.yaml: a is x, expected a finite number");
        assert_eq!(text(yaml.numbers("b")), "a.yaml: b is .nan, expected a finite number");
        assert_eq!(text(yaml.numbers("c")), "a.yaml: c is nan, expected a finite number");
        assert_eq!(text(yaml.numbers("d")), "a.yaml: d is missing, expected a list of numbers");
        let error = |text| Yaml::parse(Path::new("a.yaml"), text).err().unwrap().to_string();
        assert_eq!(error("a: [1,\n2"), "a.yaml: a list is never closed: a, expected a ]");
        assert_eq!(error("a: 1\na: 2"), "a.yaml: a key is repeated: a, expected once");
    }
}
