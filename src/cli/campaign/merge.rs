use std::fs;
use std::path::PathBuf;

use clap::Args;

use super::RESULTS;
use crate::cli::paths::are_apart;
use crate::cli::place::Place;
use crate::cli::{Outcome, input};
use crate::error::{Error, Result};
use crate::sim::campaign::Results;

/// Merge the results of several folders, and summarize them together.
///
/// They must be of one version and configuration. A flight found in several folders must have ended alike in all of
/// them.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  viewsphere campaign merge part_1 part_2 -o campaign/")]
pub(super) struct Merge {
    /// Folders that `viewsphere campaign` wrote
    #[arg(required = true, value_name = "FOLDER")]
    inputs: Vec<PathBuf>,
    /// Folder to write into, created if missing. Results already there are replaced
    #[arg(short, long, value_name = "FOLDER")]
    output: PathBuf,
    /// Print the table as JSON
    #[arg(long)]
    json: bool,
}

impl Merge {
    pub(super) fn run(&self) -> Result<Outcome> {
        let paths: Vec<PathBuf> = self.inputs.iter().map(|folder| folder.join(RESULTS)).collect();
        let output = self.output.join(RESULTS);
        let result = Place::File(output.clone());
        are_apart(&[("-o", Some(&result))], paths.iter().map(PathBuf::as_path))?;
        let mut merged: Option<Results> = None;
        for path in &paths {
            let results = Results::read(path)?;
            match &mut merged {
                Some(merged) => merged.merge(path, results)?,
                None => merged = Some(results),
            }
        }
        let none = || Error::parameter("number of folders", 0, "at least 1");
        let merged = merged.ok_or_else(none)?;
        input::folder(&self.output)?;
        super::spare(&self.output)?;
        fs::create_dir_all(&self.output).map_err(|source| Error::io(&self.output, source))?;
        merged.write(output)?;
        super::finish(&merged, &self.output, self.json)
    }
}
