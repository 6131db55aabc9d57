use std::path::PathBuf;

use clap::Args;

use super::RESULTS;
use crate::cli::{Outcome, print};
use crate::error::{Error, Result};
use crate::sim::campaign::{Comparison, Only, Results, compare};

/// Compare two settings flown with the same seeds, pair by pair.
///
/// The settings are those of two folders, or of one with --first and --second. A flight is compared with the one of the
/// same seed whose setting is the same but for what --first and --second name. A row per setting shows how many of the
/// pairs each reached, how many only the first and only the second reached, the difference of the success rates, second
/// minus first, with its 95 % interval (Newcombe 1998, paired, method 10), the p value of the exact test of McNemar, and
/// the mean difference of the least clearance with its standard error.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  viewsphere campaign compare before/ after/
  viewsphere campaign compare campaign/ --first policy=heading --second policy=arc
  viewsphere campaign compare campaign/ --first speed_m_s=12 --second speed_m_s=15 --json

Exit codes: 0 done; 2 an error, also if no flight has a counterpart.")]
pub(super) struct Compare {
    /// Folder that `viewsphere campaign` wrote
    #[arg(value_name = "FIRST")]
    first_folder: PathBuf,
    /// Folder of the second setting [default: the same]
    #[arg(value_name = "SECOND")]
    second_folder: Option<PathBuf>,
    /// Compare only those of the first folder's flights whose settings have these values. NAME is world, sensor, policy,
    /// danger, speed_m_s, size, latency_frames or faults
    #[arg(long, value_name = "NAME=VALUE,...", value_delimiter = ',')]
    first: Vec<Only>,
    /// The same for the second
    #[arg(long, value_name = "NAME=VALUE,...", value_delimiter = ',')]
    second: Vec<Only>,
    /// Print the rows as JSON
    #[arg(long)]
    json: bool,
}

impl Compare {
    pub(super) fn run(&self) -> Result<Outcome> {
        if self.second_folder.is_none() && self.first == self.second {
            let expected = "a second folder, or --first and --second that differ, such as policy=arc";
            return Err(Error::parameter("SECOND", "missing", expected));
        }
        let read = |folder: &PathBuf| Results::read(folder.join(RESULTS));
        let first = read(&self.first_folder)?;
        let second = read(self.second_folder.as_ref().unwrap_or(&self.first_folder))?;
        let rows = compare([&first.sorted(), &second.sorted()], [&self.first, &self.second])?;
        if rows.is_empty() {
            let found = format!("{} and {}", first.sorted().len(), second.sorted().len());
            return Err(Error::parameter(
                "results",
                found,
                "at least one flight with a counterpart of the same seed",
            ));
        }
        if self.json { print::json(&rows) } else { print::text(&text(&rows)) }?;
        Ok(Outcome::Done)
    }
}

fn text(rows: &[Comparison]) -> String {
    let signed = |value: Option<f64>, digits: usize| {
        value.map_or_else(|| "–".to_owned(), |value| format!("{value:+.digits$}"))
    };
    let heads = [
        "setting",
        "pairs",
        "first",
        "second",
        "only first",
        "only second",
        "difference",
        "95 %",
        "p",
        "clearance, m",
    ];
    let mut lines = vec![heads.map(str::to_owned).to_vec()];
    lines.extend(rows.iter().map(|row| {
        let [low, high] = row.interval;
        let error = row.clearance_error_m.map_or(String::new(), |error| format!(" ± {error:.2}"));
        vec![
            row.setting.clone(),
            row.pairs.to_string(),
            row.reached[0].to_string(),
            row.reached[1].to_string(),
            row.only[0].to_string(),
            row.only[1].to_string(),
            signed(row.difference, 3),
            format!("{low:+.3} to {high:+.3}"),
            format!("{:.3}", row.p),
            format!("{}{error}", signed(row.clearance_difference_m, 2)),
        ]
    }));
    print::table(&lines)
}
