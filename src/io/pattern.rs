//! The patterns of [`super::sequence`], independent of files.

use std::path::Path;

use crate::error::{Error, Result};

/// A file name with one number in it, as `printf` writes it.
#[derive(Debug)]
pub(super) struct Numbered {
    before: String,
    after: String,
    width: usize,
    zeros: bool,
}

impl Numbered {
    /// Parses `name`, the last part of `path`, which errors name.
    pub(super) fn parse(path: &Path, name: &str) -> Result<Self> {
        let wrong =
            || Error::format(path, "pattern", name, "one number such as %d or %04d (and %% for a percent)");
        let (mut texts, mut number) = ([String::new(), String::new()], None);
        let mut rest = name;
        while let Some((text, after)) = rest.split_once('%') {
            let text_slot = &mut texts[usize::from(number.is_some())];
            text_slot.push_str(text);
            if let Some(after) = after.strip_prefix('%') {
                text_slot.push('%');
                rest = after;
                continue;
            }
            let (flags, after) = after.split_once('d').ok_or_else(wrong)?;
            let width = match flags {
                "" => 0,
                // No file system has names that long; a large width would only cost memory.
                _ => flags.parse().ok().filter(|width| (1..256).contains(width)).ok_or_else(wrong)?,
            };
            if !flags.bytes().all(|b| b.is_ascii_digit()) || number.is_some() {
                return Err(wrong());
            }
            number = Some((width, flags.starts_with('0')));
            rest = after;
        }
        texts[usize::from(number.is_some())].push_str(rest);
        let (width, zeros) = number.ok_or_else(wrong)?;
        let [before, after] = texts;
        Ok(Self { before, after, width, zeros })
    }

    /// The number in a name, if the pattern would have written it that way.
    pub(super) fn number(&self, name: &str) -> Option<u64> {
        let text = name.strip_prefix(self.before.as_str())?.strip_suffix(self.after.as_str())?;
        let number: u64 = text.trim_start_matches(' ').parse().ok()?;
        let width = self.width;
        let written = if self.zeros { format!("{number:0width$}") } else { format!("{number:width$}") };
        (text == written).then_some(number)
    }
}

/// Whether a pattern of `*` (any text), `?` (one character) and plain characters matches a whole name.
pub(super) fn glob_matches(pattern: &str, name: &str) -> bool {
    if name.starts_with('.') && !pattern.starts_with('.') {
        return false;
    }
    let (pattern, name): (Vec<char>, Vec<char>) = (pattern.chars().collect(), name.chars().collect());
    let (mut p, mut n) = (0, 0);
    // Only the last star can need to match more: this bounds the work by pattern × name.
    let mut last_star = None;
    while n < name.len() {
        match pattern.get(p) {
            Some('*') => {
                last_star = Some((p, n));
                p += 1;
            }
            Some(&c) if c == '?' || c == name[n] => {
                p += 1;
                n += 1;
            }
            _ => {
                let Some((star, taken)) = last_star else { return false };
                last_star = Some((star, taken + 1));
                p = star + 1;
                n = taken + 1;
            }
        }
    }
    pattern[p..].iter().all(|&c| c == '*')
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn number(pattern: &str, name: &str) -> Option<u64> {
        Numbered::parse(Path::new(pattern), pattern).unwrap().number(name)
    }

    #[test]
    fn numbers_are_read_as_printf_writes_them() {
        assert_eq!(number("f%d.png", "f12.png"), Some(12));
        assert_eq!(number("f%d.png", "f012.png"), None);
        assert_eq!(number("f%04d.png", "f0012.png"), Some(12));
        assert_eq!(number("f%04d.png", "f12.png"), None);
        assert_eq!(number("f%04d.png", "f123456.png"), Some(123_456));
        assert_eq!(number("%3d", "  7"), Some(7));
        assert_eq!(number("%3d", "007"), None);
        assert_eq!(number("100%%_%d%%", "100%_5%"), Some(5));
        assert_eq!(number("%d", "-5"), None);
        assert_eq!(number("%d", "+5"), None);
        assert_eq!(number("%d", "99999999999999999999999"), None);
    }

    #[test]
    fn patterns_that_are_not_one_number_are_refused() {
        for pattern in ["%s", "%", "%d%d", "%x4d", "%%", "%-4d", "%+4d", "%999999999d", "%0d%", "%0d"] {
            assert!(Numbered::parse(Path::new(pattern), pattern).is_err(), "{pattern}");
        }
    }

    #[test]
    fn globs_match_whole_names() {
        for (pattern, name) in
            [("*", ""), ("*", "a"), ("a*c", "abcc"), ("?", "é"), ("*.p?g", "a.b.png"), ("a**b", "ab")]
        {
            assert!(glob_matches(pattern, name), "{pattern} {name}");
        }
        for (pattern, name) in
            [("a", "ab"), ("?", ""), ("*.png", "a.pngx"), ("*a", "ab"), ("*", ".a"), ("a*bc", "abcb")]
        {
            assert!(!glob_matches(pattern, name), "{pattern} {name}");
        }
    }
}
