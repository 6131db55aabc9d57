use std::fmt;
use std::str::FromStr;

use crate::error::{Error, Result};

/// A part of a list of jobs: `number` of `of`, counted from 1. As text `2/4`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    number: usize,
    of: usize,
}

impl Shard {
    /// All jobs.
    pub const ALL: Self = Self { number: 1, of: 1 };

    /// The shard's part of the jobs: every job is in exactly one shard.
    pub fn part<T>(self, jobs: Vec<T>) -> Vec<T> {
        jobs.into_iter().skip(self.number - 1).step_by(self.of).collect()
    }
}

impl FromStr for Shard {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || Error::parameter("shard", format_args!("{text:?}"), "I/N with I from 1 to N");
        let (number, of) = text.split_once('/').ok_or_else(wrong)?;
        let [number, of] = [number, of].map(|part| part.trim().parse::<usize>().ok());
        match (number, of) {
            (Some(number), Some(of)) if (1..=of).contains(&number) => Ok(Self { number, of }),
            _ => Err(wrong()),
        }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn every_job_is_in_one_part() {
        for of in [1, 2, 3, 7, 30] {
            let parts =
                (1..=of).map(|i| format!("{i}/{of}").parse::<Shard>().unwrap().part((0..20).collect()));
            let mut all: Vec<u32> = parts.flatten().collect();
            all.sort_unstable();
            assert_eq!(all, (0..20).collect::<Vec<_>>());
        }
    }

    #[test]
    fn what_is_no_shard_is_an_error() {
        for text in ["", "1", "0/2", "3/2", "1/0", "a/b", "-1/2", "1/2/3"] {
            let error = text.parse::<Shard>().unwrap_err().to_string();
            assert!(error.contains("I/N"), "{error}");
        }
        assert_eq!("1/1".parse::<Shard>().unwrap(), Shard::ALL);
        assert_eq!("2/4".parse::<Shard>().unwrap().to_string(), "2/4");
    }
}
