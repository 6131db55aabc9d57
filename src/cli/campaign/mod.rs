//! `viewsphere campaign`: many simulated flights, and their statistics.

mod compare;
mod merge;
mod report;

use std::num::NonZero;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::{Args, Subcommand};

use self::compare::Compare;
use self::merge::Merge;
use super::args::{named_by_flags, whole_within};
use super::backend::BackendArgs;
use super::fly::setup::SetupArgs;
use super::progress::Progress;
use super::{Outcome, input, paths, print};
use crate::backend::Backend;
use crate::error::{Error, Result};
use crate::frame::Size;
use crate::journal::{Configuration, Opened, Shard};
use crate::sim::CourseKind;
use crate::sim::campaign::{Campaign as Plan, Ended, Faults, Journal, Results, fly_all};
use crate::sim::flight::{self, MAX_LATENCY_FRAMES, Sensor};
use crate::steer::{Danger, Policy};
use crate::text::counted;

/// The results file.
const RESULTS: &str = "results.jsonl";

/// Fly every combination of worlds, sensors, policies and so on with many seeds, and count how often the goal is
/// reached.
///
/// Files in the folder: results.jsonl, one object per flight, appended as soon as the flight has ended; and at the
/// end table.csv, table.json and report.html (one self-contained page), with a row per combination: flights; how many
/// reached the goal, crashed, left the altitude band or timed out; the success rate with its 95 % confidence interval
/// (Wilson 1927); the least clearance of a flight, mean and 5th percentile; the path efficiency of the flights that
/// reached the goal; touches, with --fly-on all of a flight, and the distance flown per touch; AvoidBench's progress,
/// optimality (path length over that of the shortest way, minus 1), goal speed and energy; courses without a way at the
/// altitude of the start; the roll rate (root mean square); the share of time without a cue; the offset from the centre
/// line where the world has one.
///
/// A campaign can be stopped at any time. Called again, it resumes, retries the flights that failed with an error,
/// and flies what was added to the lists. Results of another version, configuration or adapter are refused; only
/// merge combines those of several adapters, and the table then names them. The table covers all results in the
/// folder. The same flights give the same files, however many are flown concurrently.
#[derive(Args, Debug)]
#[command(
    args_conflicts_with_subcommands = true,
    after_help = "\
Examples:
  viewsphere campaign --worlds wall,corridor,city --policies arc,balance --seeds 0..100 -o campaign/
  viewsphere campaign --worlds forest:density=1/100,forest:density=1/64 --sensors depth,flow,noisy-flow,images
  viewsphere campaign --worlds city --faults none,black:2..3,dropped=0.2+gyro-bias=5:4
  viewsphere campaign --worlds forest --seeds 0..1000 --shard $SLURM_ARRAY_TASK_ID/10 -o part_$SLURM_ARRAY_TASK_ID
  viewsphere campaign merge part_* -o campaign/
  viewsphere campaign --worlds forest:density=1/40 --seeds 0..30 --fly-on -o touches/
  viewsphere campaign --worlds forest --seeds 0..30 --steer memory_s=2 -o longer/
  viewsphere campaign compare campaign/ longer/

Exit codes: 0 done, however the flights ended; 2 an error, also that of a flight; 130 stopped by a signal."
)]
pub(super) struct Campaign {
    #[command(subcommand)]
    command: Option<Command>,
    /// Worlds, as `viewsphere fly` takes them
    #[arg(long, value_name = "WORLD,...", value_delimiter = ',', default_value = "forest")]
    worlds: Vec<CourseKind>,
    /// What the vehicle steers by: depth, flow, noisy-flow, images
    #[arg(long, value_name = "SENSOR,...", value_delimiter = ',', default_values_t = [Sensor::default()])]
    sensors: Vec<Sensor>,
    /// Steering policies: none, balance, potential, heading, arc
    #[arg(long, value_name = "POLICY,...", value_delimiter = ',', default_values_t = [Policy::default()])]
    policies: Vec<Policy>,
    /// Measures of danger: divergence, nearness, blend
    #[arg(long, value_name = "DANGER,...", value_delimiter = ',', default_values_t = [Danger::default()])]
    dangers: Vec<Danger>,
    /// Airspeeds, m/s: the airframe can hold its altitude at 7.7 to 25; with --body turn 0.1 to 1000
    #[arg(
        long,
        value_name = "M_S,...",
        value_delimiter = ',',
        allow_negative_numbers = true,
        default_value = "12"
    )]
    speeds: Vec<f64>,
    /// Image sizes
    #[arg(long, value_name = "WxH,...", value_delimiter = ',', default_value = "320x240")]
    sizes: Vec<Size>,
    /// Frames from an exposure until its command takes effect, at most 30
    #[arg(
        long,
        value_name = "N,...",
        value_delimiter = ',',
        allow_negative_numbers = true,
        value_parser = whole_within(0, MAX_LATENCY_FRAMES),
        default_value = "1"
    )]
    latencies: Vec<u32>,
    /// Faults, as `viewsphere fly` takes them: none, one fault, or several joined by +. dropped alone means
    /// dropped=0.2, gyro-bias alone gyro-bias=5
    #[arg(long, value_name = "FAULT[+FAULT]...,...", value_delimiter = ',', default_value = "none")]
    faults: Vec<Faults>,
    /// Seeds of the worlds: FIRST..LAST, without LAST, or a single one
    #[arg(long, value_name = "FIRST..LAST", allow_hyphen_values = true, default_value = "0..10")]
    seeds: Seeds,
    /// Folder to write into, created if missing. Files of an earlier campaign are replaced, other files of these names are
    /// not
    #[arg(short, long, value_name = "FOLDER", default_value = "campaign")]
    output: PathBuf,
    /// Flights to fly concurrently, at most 4096 [default: the number of cores]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole_within(NonZero::<usize>::MIN, MAX_JOBS))]
    jobs: Option<NonZero<usize>>,
    /// Fly only part I of N, I from 1 to N; `campaign merge` combines the parts
    #[arg(long, value_name = "I/N", default_value_t = Shard::ALL)]
    shard: Shard,
    /// Print no progress and no notes
    #[arg(long)]
    quiet: bool,
    /// Print the table as JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    setup: SetupArgs,
    #[command(flatten)]
    backend: BackendArgs,
}

#[derive(Subcommand, Debug)]
enum Command {
    Compare(Compare),
    Merge(Merge),
}

#[derive(Clone, Debug)]
struct Seeds(Range<u64>);

impl FromStr for Seeds {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || {
            Error::parameter(
                "seeds",
                format_args!("{text:?}"),
                format_args!("FIRST..LAST, LAST above FIRST, or a single one, each from 0 to {}", u64::MAX),
            )
        };
        let number = |text: &str| text.trim().parse::<u64>().map_err(|_| wrong());
        let seeds = match text.split_once("..") {
            Some((first, last)) => number(first)?..number(last)?,
            None => number(text).and_then(|seed| Ok(seed..seed.checked_add(1).ok_or_else(wrong)?))?,
        };
        if seeds.is_empty() { Err(wrong()) } else { Ok(Self(seeds)) }
    }
}

impl Campaign {
    pub(super) fn run(&self) -> Result<Outcome> {
        match &self.command {
            Some(Command::Compare(compare)) => compare.run(),
            Some(Command::Merge(merge)) => merge.run(),
            None => self.fly(),
        }
    }

    fn fly(&self) -> Result<Outcome> {
        self.backend.check()?;
        let cores = || std::thread::available_parallelism().unwrap_or(NonZero::<usize>::MIN);
        let at_a_time = self.jobs.unwrap_or_else(cores);
        let plan = self.plan()?;
        let backend = match self.sensors.contains(&Sensor::Images) {
            true => self.backend.open(self.quiet)?,
            false => Backend::Cpu,
        };
        let flags = [("speed_m_s", "--speeds"), ("size", "--sizes")];
        plan.validate(&backend).map_err(|error| named_by_flags(error, &flags))?;
        input::folder(&self.output)?;
        spare(&self.output)?;
        let path = self.output.join(RESULTS);
        let configuration = Configuration::new(&plan.base, self.setup.text())?;
        let Opened { mut journal, mut results, repaired } = Journal::open(&path, &configuration)?;
        if repaired {
            print::note(format_args!("{}: dropped an incomplete last line", path.display()));
        }
        if self.sensors.contains(&Sensor::Images) {
            results.check_adapter(&path, &backend.name())?;
        }
        let jobs = plan.jobs();
        let count = jobs.len();
        let mut jobs = self.shard.part(jobs);
        let all = jobs.len();
        if all == 0 && !self.quiet {
            print::empty_shard(self.shard, counted(count, "flight"));
        }
        jobs.retain(|job| !results.has_flown(&job.key()));
        // Seed by seed, so that an interrupted campaign covers every setting and the time left is known early.
        jobs.sort_by_key(|job| job.seed);
        if !self.quiet {
            print::note(format_args!("{}, {} already done", counted(all, "flight"), all - jobs.len()));
        }
        let progress = Progress::new(Some(jobs.len() as u64), "flights", self.quiet);
        let open = || Ok([self.backend.open_like(&backend)?, self.backend.open_like(&backend)?]);
        let mut tally = Tally::default();
        let flown = fly_all(&jobs, &plan.base, at_a_time, &open, |result| {
            journal.add(&result)?;
            tally.add(&result.ended);
            progress.tell(tally.text());
            progress.inc();
            results.add(&path, result)
        });
        progress.finish();
        drop(journal);
        flown?;
        results.write(&path)?;
        finish(&results, &self.output, self.json)
    }

    fn plan(&self) -> Result<Plan> {
        Ok(Plan {
            base: self.setup.config()?,
            worlds: self.worlds.clone(),
            sensors: self.sensors.clone(),
            policies: self.policies.clone(),
            dangers: self.dangers.clone(),
            speeds_m_s: self.speeds.clone(),
            sizes: self.sizes.clone(),
            latencies_frames: self.latencies.clone(),
            faults: self.faults.clone(),
            seeds: self.seeds.0.clone(),
        })
    }
}

/// The most concurrent flights: more threads than any machine can use.
const MAX_JOBS: NonZero<usize> = NonZero::new(4096).unwrap();

/// How the flights of this run ended.
#[derive(Default)]
struct Tally {
    reached: usize,
    not_reached: usize,
    failed: usize,
}

impl Tally {
    fn add(&mut self, ended: &Ended) {
        match ended {
            Ended::Flown(summary) if summary.outcome == flight::Outcome::Reached => self.reached += 1,
            Ended::Flown(_) => self.not_reached += 1,
            Ended::Failed(_) => self.failed += 1,
        }
    }

    fn text(&self) -> String {
        let Self { reached, not_reached, failed } = self;
        let failed = if *failed > 0 { format!(", {failed} failed") } else { String::new() };
        format!("{reached} reached the goal, {not_reached} did not{failed}")
    }
}

/// Checks that tables to be replaced in the folder belong to an earlier campaign.
fn spare(folder: &Path) -> Result<()> {
    let is_own = folder.join(RESULTS).is_file();
    paths::of_an_earlier_run(folder, &report::FILES, is_own, "the results.jsonl of an earlier campaign")
}

/// Writes and prints the table. A failed flight is an error, returned after everything is written.
fn finish(results: &Results, folder: &Path, json: bool) -> Result<Outcome> {
    let table = results.table();
    report::write(folder, &table)?;
    if json {
        print::json(&table)?;
    } else {
        print::text(&report::text(&table))?;
    }
    let mut failed = results.sorted().into_iter().filter_map(|result| match &result.ended {
        Ended::Failed(reason) => Some((result.job.key(), reason)),
        Ended::Flown(_) => None,
    });
    match failed.next() {
        None => Ok(Outcome::Done),
        Some((key, reason)) => {
            let expected = format!("none; the first is {key}: {reason}");
            Err(Error::parameter("number of flights that failed", failed.count() + 1, expected))
        }
    }
}
