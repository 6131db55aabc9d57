//! An algorithm with its parameters, as text.

use std::collections::BTreeSet;
use std::fmt;
use std::str::FromStr;

use crate::error::{Error, Result};
use crate::flow::Algorithm;

/// The preset that every algorithm has.
const DEFAULT: &str = "default";

/// An algorithm to evaluate, named as on the command line: `farneback-tv`, `farneback-tv:fine`, or with parameters
/// `farneback-tv:fine:alpha=1.5`.
#[derive(Clone, Debug, PartialEq)]
pub struct RunSpec {
    label: String,
    algorithm: Algorithm,
}

impl RunSpec {
    /// An algorithm with a preset.
    ///
    /// # Errors
    /// As [`Algorithm::named`].
    pub fn new(algorithm: &str, preset: &str) -> Result<Self> {
        Ok(Self { label: format!("{algorithm}:{preset}"), algorithm: Algorithm::named(algorithm, preset)? })
    }

    /// The default of every algorithm.
    pub fn defaults() -> Vec<Self> {
        Algorithm::ALL.iter().filter_map(|(name, _)| Self::new(name, DEFAULT).ok()).collect()
    }

    /// These presets of every algorithm that has one of them, without those that equal an earlier one. A preset `all` stands
    /// for all presets.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a preset that no algorithm has.
    pub fn with_presets(presets: &[String]) -> Result<Vec<Self>> {
        let has_one = |name: &str| {
            presets.iter().any(|preset| preset == "all" || Algorithm::with_preset(preset).contains(&name))
        };
        let names = Algorithm::ALL.iter().map(|(name, _)| *name);
        match presets.iter().find(|preset| *preset != "all" && Algorithm::with_preset(preset).is_empty()) {
            Some(preset) => {
                Err(Error::parameter("preset", format!("{preset:?}"), "a preset of an algorithm"))
            }
            None => {
                let names: Vec<String> = names.filter(|name| has_one(name)).map(str::to_owned).collect();
                Self::combinations(&names, presets)
            }
        }
    }

    /// Every combination of these algorithms and presets that exists, without those that equal an earlier one. A preset
    /// `all` stands for all presets of an algorithm.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an unknown algorithm, one that has none of the presets, and a preset that none of them has.
    pub fn combinations(algorithms: &[String], presets: &[String]) -> Result<Vec<Self>> {
        let mut all: Vec<Self> = Vec::new();
        let mut unused: Vec<&String> = presets.iter().filter(|preset| *preset != "all").collect();
        for name in algorithms {
            let known: Vec<&str> =
                Algorithm::named(name, DEFAULT)?.presets().iter().map(|(preset, _)| *preset).collect();
            let is_asked = |preset: &str| presets.iter().any(|asked| asked == preset || asked == "all");
            let chosen: Vec<&str> = known.iter().copied().filter(|preset| is_asked(preset)).collect();
            if chosen.is_empty() {
                let found = format!("{} with {name}", presets.join(","));
                let expected = format!("at least one of {}", known.join(", "));
                return Err(Error::parameter("preset", found, expected));
            }
            unused.retain(|preset| !known.contains(&preset.as_str()));
            for preset in chosen {
                let run = Self::new(name, preset)?;
                if all.iter().all(|other| other.algorithm != run.algorithm) {
                    all.push(run);
                }
            }
        }
        match unused.first() {
            None => Ok(all),
            Some(preset) => {
                let expected = format!("a preset of {}", algorithms.join(" or "));
                Err(Error::parameter("preset", format!("{preset:?}"), expected))
            }
        }
    }

    /// The name, such as `farneback-tv:fine`.
    pub fn label(&self) -> &str {
        &self.label
    }

    /// The algorithm with its parameters.
    pub fn algorithm(&self) -> &Algorithm {
        &self.algorithm
    }
}

impl fmt::Display for RunSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.label)
    }
}

impl FromStr for RunSpec {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let mut parts = text.split(':');
        let name = parts.next().unwrap_or_default();
        let (mut preset, mut parameters) = (DEFAULT, Vec::new());
        for (i, part) in parts.enumerate() {
            match part.split_once('=') {
                Some(parameter) => parameters.push(parameter),
                None if i == 0 => preset = part,
                None => {
                    let expected = "NAME[:PRESET][:PARAMETER=VALUE]...";
                    return Err(Error::parameter("run", format_args!("{text:?}"), expected));
                }
            }
        }
        let mut run = Self::new(name, preset)?;
        let mut given = BTreeSet::new();
        for (name, value) in parameters {
            let name = name.replace('-', "_");
            run.algorithm.set(&name, value)?;
            if !given.insert(name) {
                return Err(Error::parameter("run", format_args!("{text:?}"), "each parameter once"));
            }
        }
        run.algorithm.validate()?;
        // One order and one way of writing numbers, so that equal runs have equal names.
        for parameter in run.algorithm.parameters().iter().filter(|known| given.contains(known.name)) {
            let value = run.algorithm.get(parameter.name).unwrap_or_default();
            run.label += &format!(":{}={value}", parameter.name);
        }
        Ok(run)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn labels(algorithms: &[&str], presets: &[&str]) -> Result<Vec<String>> {
        let owned = |list: &[&str]| list.iter().map(|text| (*text).to_owned()).collect::<Vec<_>>();
        let runs = RunSpec::combinations(&owned(algorithms), &owned(presets))?;
        Ok(runs.iter().map(RunSpec::to_string).collect())
    }

    #[test]
    fn a_name_a_preset_and_parameters() {
        let run: RunSpec = "farneback-tv:fine:alpha=1.5".parse().unwrap();
        assert_eq!(run.label(), "farneback-tv:fine:alpha=1.5");
        assert_eq!(run.algorithm().get("alpha").unwrap(), "1.5");
        assert_eq!(run.algorithm().get("spacing").unwrap(), "2");
        assert_eq!("farneback".parse::<RunSpec>().unwrap().label(), "farneback:default");
        assert_eq!("farneback:poly-n=7".parse::<RunSpec>().unwrap().label(), "farneback:default:poly_n=7");
        let other: RunSpec = "farneback:poly-n=07:levels=2".parse().unwrap();
        assert_eq!(other.label(), "farneback:default:levels=2:poly_n=7");
    }

    #[test]
    fn a_preset_without_an_algorithm_is_that_of_those_that_have_it() {
        let names = |presets: &[&str]| {
            let owned: Vec<String> = presets.iter().map(|preset| (*preset).to_owned()).collect();
            let runs = RunSpec::with_presets(&owned)?;
            Ok::<_, Error>(runs.iter().map(RunSpec::to_string).collect::<Vec<_>>())
        };
        assert_eq!(names(&["affine"]).unwrap(), ["farneback:affine"]);
        assert_eq!(names(&["best", "affine"]).unwrap(), ["farneback:affine", "farneback-tv:best"]);
        assert_eq!(names(&["default"]).unwrap().len(), Algorithm::ALL.len());
        assert!(names(&["all"]).unwrap().len() > Algorithm::ALL.len());
        let error = names(&["affine", "affineish"]).unwrap_err().to_string();
        assert_eq!(error, "preset is \"affineish\", expected a preset of an algorithm");
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (text, words) in [
            ("farneback-tvx", ["algorithm", "farneback-tvx"]),
            ("farneback:best", ["preset", "best"]),
            ("farneback:accurate:fast", ["run", "NAME[:PRESET]"]),
            ("farneback:poly_n=x", ["poly_n", "x"]),
            ("farneback:poly_m=5", ["parameter", "poly_m"]),
            ("farneback:poly_n=99", ["poly_n", "99"]),
            ("farneback:poly_n=5:poly-n=7", ["run", "each parameter once"]),
            ("", ["algorithm", "\"\""]),
        ] {
            let error = text.parse::<RunSpec>().unwrap_err().to_string();
            assert!(words.iter().all(|word| error.contains(word)), "{error}");
        }
    }

    #[test]
    fn combinations_are_those_that_exist() {
        let found = labels(&["farneback", "farneback-tv"], &["accurate", "fine"]).unwrap();
        assert_eq!(found, ["farneback:accurate", "farneback-tv:accurate", "farneback-tv:fine"]);
        let all = labels(&["farneback-tv"], &["all"]).unwrap();
        assert!(
            all.contains(&"farneback-tv:light".to_owned())
                && !all.contains(&"farneback-tv:default".to_owned())
        );
        assert!(labels(&["farneback"], &["fine"]).is_err());
        assert!(labels(&["farneback", "farneback-tv"], &["accurate", "finest"]).is_err());
        assert_eq!(RunSpec::defaults().len(), Algorithm::ALL.len());
    }
}
