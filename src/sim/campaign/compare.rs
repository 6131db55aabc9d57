use std::collections::BTreeMap;

use super::statistics::{mcnemar, mean, paired_interval};
use super::{Ended, JobResult, PART_NAMES};
use crate::error::{Error, Result};
use crate::sim::CourseKind;
use crate::sim::flight::{Outcome, Summary};

/// Which results of a campaign to compare: those whose settings have these values.
///
/// As text `NAME=VALUE`, where the name is one of [`PART_NAMES`]: `policy=arc`, `world=forest:density=1/64`.
#[derive(Clone, Debug, PartialEq)]
pub struct Only {
    name: &'static str,
    value: String,
}

impl std::str::FromStr for Only {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || {
            let expected = format!("NAME=VALUE with one of {}", PART_NAMES.join(", "));
            Error::parameter("part of a setting", format_args!("{text:?}"), expected)
        };
        let (name, value) = text.split_once('=').ok_or_else(wrong)?;
        let name = *PART_NAMES.iter().find(|known| **known == name.trim()).ok_or_else(wrong)?;
        let value = match (name, value.trim().parse::<f64>()) {
            ("world", _) => value.parse::<CourseKind>()?.to_string(),
            (_, Ok(number)) => number.to_string(),
            _ => value.trim().to_owned(),
        };
        Ok(Self { name, value })
    }
}

/// Two settings flown with the same seeds. What is undefined is `None`.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Comparison {
    /// What both settings have in common: the parts that differ between rows, as in a job's key; `all` for all rows together.
    pub setting: String,
    /// The number of seeds flown with both.
    pub pairs: usize,
    /// Flights of each that reached the goal.
    pub reached: [usize; 2],
    /// Seeds with which only the first, and only the second, reached the goal.
    pub only: [usize; 2],
    /// The second's success rate minus the first's, −1 to 1.
    pub difference: Option<f64>,
    /// Its 95 % confidence interval ([`paired_interval`]).
    pub interval: [f64; 2],
    /// The probability of a split at least as uneven as `only` if both settings were equally good ([`mcnemar`]).
    pub p: f64,
    /// The second's least clearance minus the first's, metres: the mean over the seeds.
    pub clearance_difference_m: Option<f64>,
    /// The standard error of that mean, metres; `None` for fewer than two seeds.
    pub clearance_error_m: Option<f64>,
}

/// Compares two lists of results flight by flight: those that have the same seed and, apart from the parts that `only` names,
/// the same setting. There is a row for each such setting, and one for all of them if there are several.
///
/// Flights that failed with an error, and those without a counterpart, are left out.
///
/// # Errors
/// [`Error::Parameter`] if several flights of one list would be compared with the same one of the other.
pub fn compare(results: [&[&JobResult]; 2], only: [&[Only]; 2]) -> Result<Vec<Comparison>> {
    let is_named = |name: &str| only.iter().copied().flatten().any(|only| only.name == name);
    let flown = |which: usize| {
        let chosen = results[which].iter().filter(|result| {
            let parts = result.job.setting.parts();
            only[which]
                .iter()
                .all(|only| parts.iter().any(|(name, value)| *name == only.name && *value == only.value))
        });
        let keyed = chosen.filter_map(|result| match &result.ended {
            Ended::Flown(summary) => {
                let parts = result.job.setting.parts();
                let shared =
                    parts.iter().filter(|(name, _)| !is_named(name)).map(|(_, value)| value.as_str());
                Some(((shared.collect::<Vec<_>>().join("/"), result.job.seed), summary))
            }
            Ended::Failed(_) => None,
        });
        let mut flown = BTreeMap::new();
        for (key, summary) in keyed {
            if flown.insert(key.clone(), summary).is_some() {
                let found = format!("several for {} with seed {}", key.0, key.1);
                let expected = format!("one of each: choose it by {}", ["--first", "--second"][which]);
                return Err(Error::parameter("number of flights to compare", found, expected));
            }
        }
        Ok(flown)
    };
    let [first, second] = [flown(0)?, flown(1)?];
    let mut pairs: BTreeMap<&str, Vec<[&Summary; 2]>> = BTreeMap::new();
    for (key, summary) in &first {
        if let Some(other) = second.get(key) {
            pairs.entry(&key.0).or_default().push([*summary, *other]);
        }
    }
    let mut rows: Vec<Comparison> =
        pairs.iter().map(|(setting, pairs)| Comparison::of(setting, pairs)).collect();
    if rows.len() > 1 {
        rows.push(Comparison::of("all", &pairs.into_values().flatten().collect::<Vec<_>>()));
    }
    Ok(rows)
}

impl Comparison {
    fn of(setting: &str, pairs: &[[&Summary; 2]]) -> Self {
        let count = |wanted: [bool; 2]| {
            let ended = |pair: &[&Summary; 2]| pair.map(|summary| summary.outcome == Outcome::Reached);
            pairs.iter().filter(|pair| ended(pair) == wanted).count()
        };
        let [both, first, second] = [[true, true], [true, false], [false, true]].map(count);
        let neither = pairs.len() - both - first - second;
        let gains_m: Vec<f64> =
            pairs.iter().map(|[first, second]| second.least_clearance_m - first.least_clearance_m).collect();
        let gain_m = mean(&gains_m);
        let squares: Vec<f64> =
            gain_m.map_or(Vec::new(), |mean| gains_m.iter().map(|gain| (gain - mean).powi(2)).collect());
        let count = pairs.len() as f64;
        Self {
            setting: setting.to_owned(),
            pairs: pairs.len(),
            reached: [both + first, both + second],
            only: [first, second],
            difference: (!pairs.is_empty()).then(|| (second as f64 - first as f64) / count),
            interval: paired_interval([both, first, second, neither]),
            p: mcnemar([first, second]),
            clearance_difference_m: gain_m,
            clearance_error_m: (pairs.len() > 1)
                .then(|| (squares.iter().sum::<f64>() / (count - 1.0) / count).sqrt()),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::super::testing::{failed, flown};
    use super::*;
    use crate::steer::Policy;

    fn refs(results: &[JobResult]) -> Vec<&JobResult> {
        results.iter().collect()
    }

    #[test]
    fn flights_of_the_same_seed_are_compared() {
        let first = [
            flown("wall", 0, Outcome::Reached, 1.0),
            flown("wall", 1, Outcome::Crashed, 0.5),
            flown("wall", 2, Outcome::Reached, 3.0),
            flown("wall", 9, Outcome::Reached, 3.0),
            failed("city", 0),
        ];
        let second = [
            flown("wall", 2, Outcome::Reached, 4.0),
            flown("wall", 1, Outcome::Reached, 1.5),
            flown("wall", 0, Outcome::TimedOut, 2.0),
            flown("city", 0, Outcome::Reached, 2.0),
        ];
        let rows = compare([&refs(&first), &refs(&second)], [&[], &[]]).unwrap();
        assert_eq!(rows.len(), 1);
        let row = &rows[0];
        assert_eq!(row.setting, "wall/depth/arc/nearness/12/320x240/1/none");
        assert_eq!((row.pairs, row.reached, row.only), (3, [2, 2], [1, 1]));
        assert_eq!((row.difference, row.p), (Some(0.0), 1.0));
        assert_eq!((row.clearance_difference_m, row.clearance_error_m), (Some(1.0), Some(0.0)));
        let [there, back] = [[&first[..], &second[..]], [&second[..], &first[..]]]
            .map(|[a, b]| compare([&refs(a), &refs(b)], [&[], &[]]).unwrap());
        assert_eq!(
            there[0].interval,
            back[0].interval.map(|end| -end).into_iter().rev().collect::<Vec<_>>()[..]
        );
        assert_eq!(compare([&refs(&first[..1]), &refs(&second[..1])], [&[], &[]]).unwrap(), []);
    }

    #[test]
    fn parts_of_a_setting_choose_what_is_compared() {
        let with = |policy: Policy, mut result: JobResult| {
            result.job.setting.policy = policy;
            result
        };
        let all = [
            with(Policy::Arc, flown("wall", 0, Outcome::Reached, 1.0)),
            with(Policy::None, flown("wall", 0, Outcome::Crashed, 0.5)),
            with(Policy::Arc, flown("forest:density=1/64", 0, Outcome::Reached, 1.0)),
            with(Policy::None, flown("forest:density=1/64", 0, Outcome::Reached, 0.5)),
        ];
        let only = ["policy=none", "policy=arc"].map(|text| [text.parse::<Only>().unwrap()]);
        let rows = compare([&refs(&all), &refs(&all)], [&only[0], &only[1]]).unwrap();
        let reached = rows.iter().map(|row| (row.pairs, row.reached)).collect::<Vec<_>>();
        assert_eq!(reached, [(1, [1, 1]), (1, [0, 1]), (2, [1, 2])]);
        assert_eq!(rows[2].setting, "all");
        let walls = ["world=wall".parse::<Only>().unwrap(), "speed_m_s=12.0".parse().unwrap()];
        assert_eq!(compare([&refs(&all), &refs(&all)], [&walls, &walls]).unwrap().len(), 3);
        // Without the world, flights of both worlds would meet the same counterpart.
        let error = compare([&refs(&all), &refs(&all)], [&walls, &[]]).unwrap_err().to_string();
        assert!(error.contains("several for depth/arc/") && error.contains("--second"), "{error}");
        for wrong in ["policy", "speed=12", "world=moon"] {
            assert!(wrong.parse::<Only>().is_err(), "{wrong}");
        }
    }
}
