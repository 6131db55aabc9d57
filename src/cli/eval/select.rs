//! The choice of pairs.

use std::str::FromStr;

use crate::error::{Error, Result};
use crate::eval::data_set::{DataSet, PairFiles};

/// Pairs chosen by name or by number.
#[derive(Clone, Debug)]
pub(super) enum Choice {
    /// A name, `SET/NAME` or `NAME`, in which `*` stands for any text.
    Name(String),
    /// The numbers of first frames, the last one excluded, and the text that names them.
    Numbers { first: u64, last: u64, step: u64, text: String },
}

impl FromStr for Choice {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let Some((first, rest)) = text.split_once("..") else {
            return match text.trim() {
                "" => Err(Error::parameter("pairs", "\"\"", "a name, or FIRST..LAST[:STEP]")),
                name => Ok(Self::Name(name.to_owned())),
            };
        };
        let (last, step) = rest.split_once(':').unwrap_or((rest, "1"));
        let wrong = || {
            let expected = "FIRST..LAST[:STEP], LAST above FIRST and STEP above 0";
            Error::parameter("pairs", format_args!("{text:?}"), expected)
        };
        let number = |text: &str| text.trim().parse::<u64>().map_err(|_| wrong());
        let (first, last, step) = (number(first)?, number(last)?, number(step)?);
        let text = text.trim().to_owned();
        if first < last && step > 0 { Ok(Self::Numbers { first, last, step, text }) } else { Err(wrong()) }
    }
}

impl Choice {
    fn takes(&self, set: &str, pair: &PairFiles) -> bool {
        match self {
            Self::Name(name) => matches(name, &pair.name) || matches(name, &format!("{set}/{}", pair.name)),
            Self::Numbers { first, last, step, .. } => pair.number.is_some_and(|number| {
                (*first..*last).contains(&number) && (number - first).is_multiple_of(*step)
            }),
        }
    }

    /// The choice as it was given.
    fn text(&self) -> &str {
        match self {
            Self::Name(text) | Self::Numbers { text, .. } => text,
        }
    }
}

/// Keeps the chosen pairs; all without a choice. Sets without pairs are left out.
///
/// # Errors
/// [`Error::Parameter`] for a choice that takes no pair.
pub(super) fn select(sets: &mut Vec<DataSet>, choices: &[Choice]) -> Result<()> {
    for choice in choices {
        let any = |set: &DataSet| set.pairs.iter().any(|pair| choice.takes(&set.name, pair));
        if !sets.iter().any(any) {
            let first = sets.iter().find_map(|set| Some(format!("{}/{}", set.name, set.pairs.first()?.name)));
            let expected = format!("pairs of the data sets, such as {}", first.unwrap_or_default());
            return Err(Error::parameter("--pairs", choice.text(), expected));
        }
    }
    if !choices.is_empty() {
        for set in sets.iter_mut() {
            set.pairs.retain(|pair| choices.iter().any(|choice| choice.takes(&set.name, pair)));
        }
    }
    sets.retain(|set| !set.pairs.is_empty());
    Ok(())
}

/// Whether a text matches a pattern, in which `*` stands for any text.
fn matches(pattern: &str, text: &str) -> bool {
    let Some((start, rest)) = pattern.split_once('*') else { return pattern == text };
    let Some(text) = text.strip_prefix(start) else { return false };
    (0..=text.len()).any(|at| text.is_char_boundary(at) && matches(rest, &text[at..]))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::eval::data_set::Kind;

    fn chosen(choices: &[&str]) -> Result<String> {
        let pair = |number: u64| PairFiles {
            name: format!("{number:03}"),
            number: Some(number),
            ..PairFiles::default()
        };
        let set = |name: &str| DataSet {
            name: name.to_owned(),
            kind: Kind::Simulated,
            pairs: (0..20).map(pair).collect(),
        };
        let mut sets = vec![set("a"), set("b")];
        let choices = choices.iter().map(|text| text.parse()).collect::<Result<Vec<Choice>>>()?;
        select(&mut sets, &choices)?;
        let names = |set: &DataSet| {
            set.pairs.iter().map(|pair| format!("{}{}", set.name, pair.name)).collect::<Vec<_>>()
        };
        Ok(sets.iter().flat_map(names).collect::<Vec<_>>().join(" "))
    }

    #[test]
    fn by_name_and_by_number() {
        assert_eq!(chosen(&[]).unwrap().len(), 40 * 5 - 1);
        assert_eq!(chosen(&["a/003", "004"]).unwrap(), "a003 a004 b004");
        assert_eq!(chosen(&["3..20:8"]).unwrap(), "a003 a011 a019 b003 b011 b019");
        assert_eq!(chosen(&["b/*7"]).unwrap(), "b007 b017");
        assert_eq!(chosen(&["18..20", "a/*00"]).unwrap(), "a000 a018 a019 b018 b019");
    }

    #[test]
    fn what_takes_nothing_is_an_error() {
        for (choice, words) in [
            ("x", "--pairs is x, expected pairs of the data sets, such as a/000"),
            ("30..40", "--pairs is 30..40, expected"),
            ("30..40:2", "--pairs is 30..40:2, expected"),
            ("4..4", "LAST above FIRST"),
            ("0..4:0", "STEP above 0"),
            ("a..b", "FIRST..LAST"),
            ("", "a name"),
        ] {
            let error = chosen(&["001", choice]).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
    }
}
