//! `viewsphere eval`: the errors of flow against the ground truth, of a single field or of algorithms on data sets.

mod backends;
mod columns;
mod json;
mod literature;
mod maps;
mod merge;
mod output;
mod page;
mod select;
mod sets;
mod single;
mod sink;
mod text;

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};

use self::backends::BackendList;
use self::literature::NamedTable;
use self::merge::Merge;
use self::output::Output;
use self::select::Choice;
pub(super) use self::single::FlowErrorFigures;
use self::single::Single;
use super::Outcome;
use super::args::whole_within;
use crate::error::{Error, Result};
use crate::eval::RunSpec;
use crate::eval::data_set::Kind;
use crate::journal::Shard;

/// Standard output.
const STDOUT: &str = "-";

/// Compare flow with the ground truth: a field, or algorithms on data sets.
///
/// A field: `--truth FILE ESTIMATE`. The extension tells the format: .flo (Middlebury), .png (KITTI), .npy (float32,
/// height × width × 2). Pixels unknown in the ground truth are left out; those unknown in the estimate lower the density. If
/// no pixel is left to compare, that is an error.
///
/// Data sets: `--data FOLDER`. Middlebury, KITTI 2012 and 2015, MPI Sintel, Yosemite, sets of `viewsphere simulate` and
/// folders with two images and a .flo are found in the folder, or in folders inside it. Each algorithm and preset runs on each
/// pair and backend. The tables tell the mean endpoint and angular error (AEE, AAE) with standard deviation, the share of
/// pixels off by over 1 and 3 px (R1, R3), the time per pair, and the geometric mean of ratios to a baseline; the error by
/// classes of pixels (by displacement, distance from motion edges, texture, occlusion, depth); and how well the confidence
/// tells bad pixels, whose error is over 0.5 px: the area under the ROC (AUC), the share of bad pixels missed at 10 % false
/// alarms, the error of the best 60 %. Figures are over the pixels of all pairs; the sky, where the depth is known to be
/// infinite, is a class of its own, and counts in the confidence.
///
/// With -o results are kept in a folder: results.jsonl, one object per pair and run, appended as soon as it is known; maps/,
/// the images of the page; at the end table.csv, table.json and report.html. Called again it resumes: what is done is skipped,
/// what failed is tried again. A pair that cannot be read fails alone.
#[derive(Args, Debug)]
#[command(
    args_conflicts_with_subcommands = true,
    after_help = "\
Examples:
  viewsphere eval --truth gt.flo estimate.flo
  viewsphere eval --truth kitti/000000_10.png estimate.flo --mask valid.png --json
  viewsphere eval --data middlebury/
  viewsphere eval --data data/ --algorithm farneback,farneback-tv --preset accurate,fine --html report.html
  viewsphere eval --data sintel/ --run farneback-tv:best,farneback --baseline farneback:default -o results/
  viewsphere eval --data set/ --pairs 3..52:8 --run farneback-tv:fine:alpha=1.5,farneback-tv:fine --repeats 0
  viewsphere eval --data yosemite/ --table yosemite
  viewsphere eval --data kitti/ --shard $SLURM_ARRAY_TASK_ID/10 -o part_$SLURM_ARRAY_TASK_ID
  viewsphere eval merge part_* -o results/

Exit codes: 0 done; 2 an error, also that of a single pair; 130 stopped by a signal."
)]
pub(super) struct Eval {
    #[command(subcommand)]
    command: Option<Command>,
    /// The ground truth of a single flow field
    #[arg(long, value_name = "FILE", conflicts_with = "data")]
    truth: Option<PathBuf>,
    /// The flow field to evaluate
    #[arg(requires = "truth")]
    estimate: Option<PathBuf>,
    /// Count only pixels where this image is brighter than mid-gray, or where this .npy plane is above 0.5
    #[arg(long, value_name = "FILE", requires = "truth")]
    mask: Option<PathBuf>,
    /// Print the results as JSON, or write them to this .json file
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = STDOUT)]
    json: Option<PathBuf>,
    #[command(flatten)]
    data: DataArgs,
}

/// The flags of data sets.
#[derive(Args, Debug)]
#[command(next_help_heading = "Data sets")]
struct DataArgs {
    /// Folder of a data set, or of several; can be repeated
    #[arg(long, value_name = "FOLDER", num_args = 1..)]
    data: Vec<PathBuf>,
    /// Look only for this kind of data set: middlebury, kitti, sintel, yosemite, simulated, pair
    #[arg(long, value_name = "KIND", requires = "data")]
    kind: Option<Kind>,
    /// Pairs to take: NAME or SET/NAME, in which * stands for any text, or FIRST..LAST[:STEP] by number [default: all]
    #[arg(long, value_name = "PAIR,...", value_delimiter = ',', requires = "data")]
    pairs: Vec<Choice>,
    /// Algorithms [default: all]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', requires = "data")]
    algorithm: Vec<String>,
    /// Presets; all stands for all of an algorithm [default: default]. Without --algorithm, every algorithm that has one of
    /// them is run
    #[arg(long, value_name = "PRESET,...", value_delimiter = ',', requires = "data")]
    preset: Vec<String>,
    /// Algorithms with presets and parameters, such as farneback-tv:fine:alpha=1.5, in place of or beside the two above
    #[arg(
        long,
        value_name = "NAME[:PRESET][:PARAMETER=VALUE],...",
        value_delimiter = ',',
        requires = "data"
    )]
    run: Vec<RunSpec>,
    /// Print this table, of all presets unless some are named
    #[arg(long, value_name = "NAME", requires = "data", conflicts_with = "kind")]
    table: Option<NamedTable>,
    /// Run to which the others are compared [default: that of the first row]
    #[arg(long, value_name = "RUN")]
    baseline: Option<RunSpec>,
    /// Timed repetitions of each pair, after one that is not timed; 0 times nothing
    #[arg(long, value_name = "N", default_value_t = 3, allow_negative_numbers = true, value_parser = whole_within(0_u32, 1000), requires = "data")]
    repeats: u32,
    /// Run only part I of N of the pairs, I from 1 to N; `eval merge` combines the parts, empty ones included
    #[arg(long, value_name = "I/N", default_value_t = Shard::ALL, requires = "data")]
    shard: Shard,
    /// Folder to keep the results in, created if missing. Files of an earlier eval are replaced, other files of these names are
    /// not
    #[arg(short, long, value_name = "FOLDER", requires = "data")]
    output: Option<PathBuf>,
    /// Write all rows as comma-separated values to this .csv file
    #[arg(long, value_name = "FILE", requires = "data")]
    csv: Option<PathBuf>,
    /// Write a self-contained page with error maps to this .html file
    #[arg(long, value_name = "FILE", requires = "data")]
    html: Option<PathBuf>,
    /// Pairs of each data set whose error maps are on the page
    #[arg(long, value_name = "N", default_value_t = 6, allow_negative_numbers = true, value_parser = whole_within(0_usize, 1000), requires = "data")]
    maps: usize,
    /// Print no progress and no notes
    #[arg(long, requires = "data")]
    quiet: bool,
    #[command(flatten)]
    backend: BackendList,
}

#[derive(Subcommand, Debug)]
enum Command {
    Merge(Merge),
}

impl Eval {
    pub(super) fn run(&self) -> Result<Outcome> {
        match (&self.command, &self.truth) {
            (Some(Command::Merge(merge)), _) => merge.run(),
            (None, Some(truth)) => {
                self.refuse_flags_of_data_sets()?;
                self.single(truth)
            }
            (None, None) if self.data.data.is_empty() => {
                let expected = "--truth FILE ESTIMATE, --data FOLDER, or merge; see viewsphere eval --help";
                Err(Error::parameter("what to evaluate", "missing", expected))
            }
            (None, None) => {
                let single = [("--mask", &self.mask), ("flow field to evaluate", &self.estimate)];
                match single.into_iter().find_map(|(name, path)| Some((name, path.as_ref()?))) {
                    None => sets::run(&self.data, &self.output()),
                    Some((name, path)) => {
                        Err(Error::parameter(name, path.display(), "--truth FILE, or neither with --data"))
                    }
                }
            }
        }
    }

    /// With a single flow field the flags of data sets would do nothing.
    fn refuse_flags_of_data_sets(&self) -> Result<()> {
        let DataArgs {
            run, algorithm, preset, pairs, kind, baseline, output, csv, html, table, shard, ..
        } = &self.data;
        let flags = [
            ("--run", !run.is_empty()),
            ("--algorithm", !algorithm.is_empty()),
            ("--preset", !preset.is_empty()),
            ("--pairs", !pairs.is_empty()),
            ("--kind", kind.is_some()),
            ("--baseline", baseline.is_some()),
            ("--output", output.is_some()),
            ("--csv", csv.is_some()),
            ("--html", html.is_some()),
            ("--table", table.is_some()),
            ("--shard", *shard != Shard::ALL),
        ];
        match flags.into_iter().find(|(_, is_given)| *is_given) {
            None => Ok(()),
            Some((flag, _)) => {
                Err(Error::parameter(flag, "given", "--data FOLDER, or no such flag with --truth"))
            }
        }
    }

    fn single(&self, truth: &Path) -> Result<Outcome> {
        // `--json ESTIMATE` is the estimate, as `--json` needs no value.
        let (estimate, json) = match (self.estimate.as_deref(), self.json.as_deref()) {
            (None, Some(path)) if path != Path::new(STDOUT) => (Some(path), Some(Path::new(STDOUT))),
            given => given,
        };
        let missing = || Error::parameter("flow field to evaluate", "missing", "its file after --truth FILE");
        let mask = self.mask.as_deref();
        Single { truth, estimate: estimate.ok_or_else(missing)?, mask, json }.run()
    }

    fn output(&self) -> Output<'_> {
        let DataArgs { output, csv, html, baseline, table, .. } = &self.data;
        Output {
            folder: output.as_deref(),
            json: self.json.as_deref(),
            csv: csv.as_deref(),
            html: html.as_deref(),
            baseline: baseline.as_ref().map(RunSpec::label),
            table: *table,
        }
    }
}
