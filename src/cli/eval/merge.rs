use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;

use super::maps::Maps;
use super::output::Output;
use super::sets::results_in;
use crate::cli::Outcome;
use crate::error::{Error, Result};
use crate::eval::{PairResult, RunSpec};
use crate::journal::Results;

/// Merge the results of several folders, and summarize them together.
///
/// They must be of one version. A result found in several folders must be the same in all of them, but for the time.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  viewsphere eval merge part_1 part_2 -o results/
  viewsphere eval merge results/ -o results/ --baseline farneback:default")]
pub(super) struct Merge {
    /// Folders that `viewsphere eval -o` wrote
    #[arg(required = true, value_name = "FOLDER")]
    inputs: Vec<PathBuf>,
    /// Folder to write into, created if missing. Results already there are replaced
    #[arg(short, long, value_name = "FOLDER")]
    output: PathBuf,
    /// Run to which the others are compared [default: that of the first row]
    #[arg(long, value_name = "RUN")]
    baseline: Option<RunSpec>,
    /// Print the tables as JSON
    #[arg(long)]
    json: bool,
}

impl Merge {
    pub(super) fn run(&self) -> Result<Outcome> {
        let mut merged: Option<Results<PairResult>> = None;
        for path in self.inputs.iter().map(|folder| results_in(folder)) {
            let results = Results::read(&path)?;
            match &mut merged {
                Some(merged) => merged.merge(&path, results)?,
                None => merged = Some(results),
            }
        }
        let merged = merged.ok_or_else(|| Error::parameter("number of folders", 0, "at least 1"))?;
        let json = self.json.then_some(Path::new(super::STDOUT));
        let baseline = self.baseline.as_ref().map(RunSpec::label);
        let output =
            Output { folder: Some(&self.output), json, csv: None, html: None, baseline, table: None };
        output.check()?;
        output.check_baseline(&merged)?;
        fs::create_dir_all(&self.output).map_err(|source| Error::io(&self.output, source))?;
        let mut maps = Maps::beside(&self.output);
        let same = |folder: &Path| folder.canonicalize().ok() == self.output.canonicalize().ok();
        self.inputs.iter().filter(|folder| !same(folder)).try_for_each(|folder| maps.copy_from(folder))?;
        merged.write(results_in(&self.output))?;
        output.finish(&merged, &maps)
    }
}
