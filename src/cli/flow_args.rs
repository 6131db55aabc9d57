//! The flags of every command that computes flow: the algorithm, a preset, and the parameters of all algorithms,
//! generated from the estimators' own lists.

use std::sync::LazyLock;

use clap::builder::PossibleValue;
use clap::parser::ValueSource;
use clap::{Arg, ArgMatches, Args, Command, FromArgMatches};

use super::args::named_by_flags;
use crate::error::{Error, Result};
use crate::flow::{Algorithm, Choice, Parameter};

const HEADING: &str = "Flow parameters";
const DEFAULT_PRESET: &str = "default";

/// The algorithm and its parameters as given.
#[derive(Clone, Debug)]
pub(super) struct FlowArgs {
    algorithm: String,
    preset: String,
    /// Whether the algorithm or the preset was given on the command line.
    is_chosen: bool,
    /// The names and values of the parameters given.
    parameters: Vec<(&'static str, String)>,
}

/// A parameter, with the algorithms that have it and its default in each.
struct Shared {
    parameter: Parameter,
    of: Vec<(&'static str, String)>,
}

/// The flags by the names of parameters. The flags' texts live as long as the program.
static FLAGS: LazyLock<Vec<(&'static str, &'static str)>> = LazyLock::new(|| {
    let names = shared().into_iter().map(|shared| shared.parameter.name);
    let all = names.chain(["preset", "algorithm"]);
    all.map(|name| (name, &*format!("--{}", flag(name)).leak())).collect()
});

impl FlowArgs {
    /// The algorithm with its parameters, validated.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a preset or a parameter that the algorithm does not have, and for values out of range.
    pub(super) fn algorithm(&self) -> Result<Algorithm> {
        let algorithm = Algorithm::named(&self.algorithm, &self.preset);
        self.with_parameters(algorithm.map_err(|error| named_by_flags(error, &FLAGS))?)
    }

    /// The same for a command whose default is `own`: its parameters, unless an algorithm or a preset is given.
    ///
    /// # Errors
    /// As [`FlowArgs::algorithm`].
    pub(super) fn algorithm_or(&self, own: &Algorithm) -> Result<Algorithm> {
        if self.is_chosen { self.algorithm() } else { self.with_parameters(own.clone()) }
    }

    fn with_parameters(&self, mut algorithm: Algorithm) -> Result<Algorithm> {
        for (name, value) in &self.parameters {
            if algorithm.get(name).is_none() {
                let names: Vec<String> =
                    algorithm.parameters().iter().map(|parameter| flag(parameter.name)).collect();
                let found = format_args!("--{}", flag(name));
                let expected = format_args!("one of {}'s: --{}", algorithm.name(), names.join(", --"));
                return Err(Error::parameter("flow parameter", found, expected));
            }
            algorithm.set(name, value).map_err(|error| named_by_flags(error, &FLAGS))?;
        }
        algorithm.validate().map_err(|error| named_by_flags(error, &FLAGS))?;
        Ok(algorithm)
    }
}

impl FromArgMatches for FlowArgs {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let text = |id: &str| matches.get_one::<String>(id).cloned();
        let given = |shared: Shared| text(shared.parameter.name).map(|value| (shared.parameter.name, value));
        let is_given = |id: &str| matches.value_source(id) == Some(ValueSource::CommandLine);
        Ok(Self {
            is_chosen: is_given("algorithm") || is_given("preset"),
            algorithm: text("algorithm").unwrap_or_default(),
            preset: text("preset").unwrap_or_default(),
            parameters: shared().into_iter().filter_map(given).collect(),
        })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl Args for FlowArgs {
    fn augment_args(command: Command) -> Command {
        let preset = |(name, meanings): (&'static str, Vec<Meaning<'_>>)| {
            PossibleValue::new(name).help(told(&meanings))
        };
        let presets: Vec<PossibleValue> = presets().into_iter().map(preset).collect();
        let command = command
            .next_help_heading(HEADING)
            .arg(
                Arg::new("algorithm")
                    .long("algorithm")
                    .value_name("NAME")
                    .value_parser(values(Algorithm::ALL))
                    .default_value(Algorithm::ALL[0].0)
                    .help("Algorithm that estimates the flow"),
            )
            .arg(
                Arg::new("preset")
                    .long("preset")
                    .value_name("PRESET")
                    .value_parser(presets)
                    .default_value(DEFAULT_PRESET)
                    .help(
                        "Set of parameters of the algorithm; the flags below override single ones, and their defaults are \
                         those of the preset default",
                    ),
            );
        shared().into_iter().fold(command, |command, shared| command.arg(shared.arg()))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl Shared {
    fn arg(self) -> Arg {
        let Self { parameter, of } = self;
        let mut by_value: Vec<(&str, Vec<&str>)> = Vec::new();
        of.iter().for_each(|(algorithm, value)| add(&mut by_value, algorithm, value));
        let defaults = match by_value.as_slice() {
            [(value, _)] => (*value).to_owned(),
            several => {
                let each = several.iter().map(|(value, of)| format!("{value} of {}", listed(of)));
                each.collect::<Vec<_>>().join("; ")
            }
        };
        let only = match of.len() == Algorithm::ALL.len() {
            true => String::new(),
            false => format!(", of {}", listed(&of.iter().map(|(name, _)| *name).collect::<Vec<_>>())),
        };
        // Estimators may mean different things by a name.
        let mut meanings: Vec<Meaning<'_>> = Vec::new();
        for (algorithm, _) in &of {
            let known = Algorithm::named(algorithm, DEFAULT_PRESET)
                .ok()
                .and_then(|algorithm| help(&algorithm, parameter.name));
            add(&mut meanings, algorithm, known.unwrap_or(parameter.help));
        }
        let help = match meanings.as_slice() {
            [(help, _)] => format!("{help}{only}"),
            several => told(several),
        };
        let arg = Arg::new(parameter.name)
            .long(flag(parameter.name))
            .value_name(parameter.value_name)
            .allow_negative_numbers(true)
            .help(format!("{help} [default: {defaults}]"));
        match parameter.choices {
            [] => arg.value_parser(move |text: &str| legible(parameter.name, text)),
            choices => arg.value_parser(values(choices)).allow_negative_numbers(false),
        }
    }
}

/// Accepts `text` if it parses as a value of the parameter. Ranges are checked once the algorithm is known.
fn legible(name: &str, text: &str) -> Result<String> {
    match algorithms().find(|algorithm| algorithm.get(name).is_some()) {
        Some(mut algorithm) => {
            let set = algorithm.set(name, text).map_err(|error| named_by_flags(error, &FLAGS));
            set.map(|()| text.to_owned())
        }
        None => Ok(text.to_owned()),
    }
}

/// What an algorithm's parameter means.
fn help(algorithm: &Algorithm, name: &str) -> Option<&'static str> {
    algorithm.parameters().iter().find(|parameter| parameter.name == name).map(|parameter| parameter.help)
}

/// The flag of a parameter, without its dashes.
fn flag(name: &str) -> String {
    name.replace('_', "-")
}

fn values(choices: &[Choice]) -> Vec<PossibleValue> {
    choices.iter().map(|(name, help)| PossibleValue::new(*name).help(*help)).collect()
}

/// Every algorithm with its default parameters.
fn algorithms() -> impl Iterator<Item = Algorithm> {
    Algorithm::ALL.iter().filter_map(|(name, _)| Algorithm::named(name, DEFAULT_PRESET).ok())
}

/// The parameters of all algorithms, each once.
fn shared() -> Vec<Shared> {
    let mut all: Vec<Shared> = Vec::new();
    for algorithm in algorithms() {
        for parameter in algorithm.parameters() {
            let of = (algorithm.name(), algorithm.get(parameter.name).unwrap_or_default());
            match all.iter_mut().find(|shared| shared.parameter.name == parameter.name) {
                Some(shared) => shared.of.push(of),
                None => all.push(Shared { parameter: *parameter, of: vec![of] }),
            }
        }
    }
    all
}

/// What a name means, and the algorithms with which it does.
type Meaning<'a> = (&'a str, Vec<&'a str>);

/// Adds an algorithm to those with a meaning.
fn add<'a>(meanings: &mut Vec<Meaning<'a>>, algorithm: &'a str, own: &'a str) {
    match meanings.iter_mut().find(|(meaning, _)| *meaning == own) {
        Some((_, algorithms)) => algorithms.push(algorithm),
        None => meanings.push((own, vec![algorithm])),
    }
}

/// The meanings as text, each with its algorithms.
fn told(meanings: &[Meaning<'_>]) -> String {
    let each = meanings.iter().map(|(meaning, algorithms)| format!("{}: {meaning}", listed(algorithms)));
    each.collect::<Vec<_>>().join(". ")
}

/// Names as a list in a sentence.
fn listed(names: &[&str]) -> String {
    match names {
        [first @ .., last] if !first.is_empty() => format!("{} and {last}", first.join(", ")),
        _ => names.concat(),
    }
}

/// The presets of all algorithms, each once, with their meanings.
fn presets() -> Vec<(&'static str, Vec<Meaning<'static>>)> {
    let mut all: Vec<(&'static str, Vec<Meaning<'static>>)> = Vec::new();
    for algorithm in algorithms() {
        for (name, help) in algorithm.presets() {
            if !all.iter().any(|(known, _)| known == name) {
                all.push((name, Vec::new()));
            }
            let of_name = all.iter_mut().find(|(known, _)| known == name);
            of_name.into_iter().for_each(|(_, meanings)| add(meanings, algorithm.name(), help));
        }
    }
    all
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn parsed(args: &[&str]) -> FlowArgs {
        let command = FlowArgs::augment_args(Command::new("flow"));
        let matches = command.try_get_matches_from([&["flow"], args].concat()).unwrap();
        FlowArgs::from_arg_matches(&matches).unwrap()
    }

    #[test]
    fn the_help_tells_the_default_of_every_parameter() {
        let command = FlowArgs::augment_args(Command::new("flow"));
        for algorithm in algorithms() {
            for Parameter { name, .. } in algorithm.parameters() {
                let argument = command.get_arguments().find(|argument| argument.get_id() == name).unwrap();
                let help = argument.get_help().unwrap().to_string();
                let defaults = help.rsplit_once("[default: ").unwrap().1;
                assert!(defaults.contains(&algorithm.get(name).unwrap()), "{name}: {help}");
            }
        }
    }

    #[test]
    fn every_parameter_can_be_read_and_set_by_name() {
        for algorithm in algorithms() {
            for Parameter { name, .. } in algorithm.parameters() {
                let mut copy = algorithm.clone();
                copy.set(name, &algorithm.get(name).unwrap()).unwrap();
                assert_eq!(copy, algorithm, "{name}");
                assert!(copy.set(name, "neither number nor name").is_err(), "{name}");
            }
        }
    }

    #[test]
    fn a_preset_is_begun_with_and_single_parameters_replace_its_own() {
        let algorithm = parsed(&["--preset", "accurate", "--poly-n", "7"]).algorithm().unwrap();
        assert_eq!(algorithm.get("poly_n").unwrap(), "7");
        assert_eq!(algorithm.get("iterations").unwrap(), "10");
        let error = parsed(&["--levels", "99"]).algorithm().unwrap_err();
        assert_eq!(error.to_string(), "--levels is 99, expected 0 to 32");
        let error = parsed(&["--pyr-scale", "9"]).algorithm().unwrap_err();
        assert_eq!(error.to_string(), "--pyr-scale is 9, expected a number above 0 and below 1");
        let error = parsed(&["--preset", "best"]).algorithm().unwrap_err().to_string();
        let words = "--preset is \"best\" with farneback, expected fast, ";
        assert!(
            error.starts_with(words) && error.ends_with(", or the algorithm farneback-tv, which has it"),
            "{error}"
        );
    }

    #[test]
    fn the_help_tells_every_algorithms_presets() {
        let told: Vec<(&str, String)> =
            presets().iter().map(|(name, meanings)| (*name, told(meanings))).collect();
        for algorithm in algorithms() {
            for (name, help) in algorithm.presets() {
                let (_, text) = told.iter().find(|(known, _)| known == name).unwrap();
                let own = text.split(". ").find(|part| part.contains(algorithm.name())).unwrap();
                assert!(own.ends_with(help), "{name}: {text}");
            }
        }
    }
}
