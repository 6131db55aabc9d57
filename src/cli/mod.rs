//! The command line: one module per subcommand. The work is done by the library's modules, which embedders call
//! directly.
//!
//! Results go to standard output, everything else to standard error. An error is one line, and the exit code is 2; a
//! check that was asked for and failed gives 1.

mod args;
mod backend;
mod bench;
mod cache;
mod campaign;
mod crosscheck;
mod demo;
mod devices;
mod environment;
mod eval;
mod flow;
mod flow_args;
mod fly;
mod input;
mod paths;
mod place;
mod print;
mod progress;
mod run;
mod simulate;
mod track;
mod undistort;

use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};

use crate::error::Result;
use crate::io::discard_and_exit;

/// The exit code of a program stopped by SIGINT, as shells report it.
const INTERRUPTED: i32 = 130;

/// Dense optical flow on the GPU and the CPU, with a stated bound between them.
#[derive(Parser, Debug)]
#[command(
    name = "viewsphere",
    version,
    about,
    after_help = "\
Examples:
  viewsphere demo                                    flow, time to contact and steering on one page
  viewsphere flow a.png b.png -o flow.flo            the flow between two images
  ffmpeg -i in.mp4 -pix_fmt yuv420p -f yuv4mpegpipe - | viewsphere flow - -o flows/
  viewsphere run flight.y4m --camera cam.yaml --gyro gyro.csv    what will be hit, where and when
  viewsphere track 'frames/%04d.png' -o tracks.csv    corners and their tracks over a sequence
  viewsphere simulate --world city --seed 3 -o set/    a simulated flight with exact ground truth
  viewsphere undistort --camera cam.yaml in.jpg -o out.png
  viewsphere fly --world forest --seed 7             through a simulated world, steered by what the view says
  viewsphere campaign --worlds wall,city --seeds 0..100    how often the goal is reached
  viewsphere eval --data middlebury/                 the errors of every algorithm
  viewsphere devices                                 the GPU adapters and the CPU

A result replaces a file of its name. Files whose names a command chooses itself, in a folder given with -o, replace only those of
an earlier run of that command."
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand, Debug)]
enum Command {
    Flow(Box<flow::Flow>),
    Run(Box<run::Run>),
    Track(Box<track::TrackCommand>),
    Fly(Box<fly::Fly>),
    Campaign(Box<campaign::Campaign>),
    Simulate(Box<simulate::Simulate>),
    Undistort(Box<undistort::Undistort>),
    Crosscheck(Box<crosscheck::Crosscheck>),
    Eval(Box<eval::Eval>),
    Bench(Box<bench::Bench>),
    Devices(devices::Devices),
    Demo(Box<demo::Demo>),
}

/// Whether a check that was asked for holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Outcome {
    Done,
    CheckFailed,
}

/// Runs the program with the process's arguments. Must be called before any thread starts.
pub fn main() -> ExitCode {
    environment::prepare();
    // Without a handler a signal still stops the program, and the next run that writes the same file removes what is
    // left.
    let _ = ctrlc::set_handler(|| discard_and_exit(INTERRUPTED));
    let parsed = command().try_get_matches().and_then(|given| Cli::from_arg_matches(&given));
    let cli = match parsed {
        Ok(cli) => cli,
        Err(error) => return usage(&error),
    };
    match cli.command.run() {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::CheckFailed) => ExitCode::from(1),
        Err(error) => {
            print::note(error);
            ExitCode::from(2)
        }
    }
}

impl Command {
    fn run(&self) -> Result<Outcome> {
        match self {
            Self::Flow(command) => command.run(),
            Self::Run(command) => command.run(),
            Self::Track(command) => command.run(),
            Self::Fly(command) => command.run(),
            Self::Campaign(command) => command.run(),
            Self::Simulate(command) => command.run(),
            Self::Undistort(command) => command.run(),
            Self::Crosscheck(command) => command.run(),
            Self::Eval(command) => command.run(),
            Self::Bench(command) => command.run(),
            Self::Devices(command) => command.run(),
            Self::Demo(command) => command.run(),
        }
    }
}

/// The exit codes of commands that do not document their own.
const EXIT_CODES: &str = "Exit codes: 0 done, 1 a check failed, 2 an error, reported in one line on standard error; 130 stopped by a signal.";

/// The program's arguments. Every command's help ends with its exit codes.
fn command() -> clap::Command {
    let told = |command: clap::Command| {
        let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
        if help.contains("Exit codes:") {
            command
        } else {
            command.after_help(format!("{help}\n\n{EXIT_CODES}"))
        }
    };
    told(Cli::command()).mut_subcommands(move |command| told(command).mut_subcommands(told))
}

/// Prints the help asked for, or what is wrong with the arguments, on one line.
fn usage(error: &clap::Error) -> ExitCode {
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
            // A help text that cannot be printed leaves nothing to report to.
            let _ = error.print();
            ExitCode::SUCCESS
        }
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            print::note(format_args!("the subcommand is missing; see {} --help", asked()));
            ExitCode::from(2)
        }
        _ => {
            let text = error.to_string();
            let problem = text.split("\n\nUsage:").next().unwrap_or(&text);
            let problem = problem.split("\n\nFor more").next().unwrap_or(problem);
            let problem = problem.trim_start_matches("error: ");
            print::note(format_args!(
                "{}; see {} --help",
                negative(problem).unwrap_or(problem.into()),
                asked()
            ));
            ExitCode::from(2)
        }
    }
}

/// The message for a negative number where no number can stand, which clap takes for a flag: no flag begins with a
/// digit.
fn negative(problem: &str) -> Option<String> {
    let line = problem.lines().next()?;
    let number = line.strip_prefix("unexpected argument '-")?;
    let is_number = number.starts_with(|c: char| c.is_ascii_digit());
    is_number.then(|| format!("{line}, a negative number is not expected here"))
}

/// The command whose help matches the process's arguments, such as `viewsphere campaign merge`.
fn asked() -> String {
    let (mut command, mut name) = (command(), "viewsphere".to_owned());
    for argument in std::env::args_os().skip(1) {
        let Some(found) = argument.to_str().and_then(|argument| command.find_subcommand(argument)) else {
            break;
        };
        name = format!("{name} {}", found.get_name());
        command = found.clone();
    }
    name
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_help_of_every_command_tells_its_exit_codes_once() {
        fn check(command: &clap::Command) {
            let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
            assert_eq!(help.matches("Exit codes: 0 ").count(), 1, "{}: {help}", command.get_name());
            command.get_subcommands().for_each(check);
        }
        let command = command();
        check(&command);
        command.debug_assert();
    }
}
