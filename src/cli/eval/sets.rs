//! Runs algorithms on the pairs of data sets.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use indicatif::{ProgressBar, ProgressStyle};

use super::DataArgs;
use super::backends::Opened as OpenedBackend;
use super::columns::{ERRORS, cell};
use super::maps::{Maps, Shown};
use super::output::{Output, RESULTS, configuration};
use super::select::select;
use crate::cli::{Outcome, input, print};
use crate::error::{Error, Result};
use crate::eval::data_set::{self, DataSet, LoadedPair, PairFiles};
use crate::eval::{Classes, Ended, Job, PairResult, RunSpec, Score, Table, estimate};
use crate::frame::{FlowField, Image};
use crate::io::picture;
use crate::journal::{Entry, Journal, Opened, Results};
use crate::report::{colour_wheel, error_map, thinned};
use crate::text::counted;

/// The widest error map, in pixels; larger ones are thinned out.
const WIDEST: u32 = 640;

/// A pair, with the name of its set.
struct Task {
    set: String,
    files: PairFiles,
    /// Whether it has error maps on the page.
    has_maps: bool,
}

/// Everything that results go to.
struct Sink {
    path: PathBuf,
    journal: Option<Journal<PairResult>>,
    results: Results<PairResult>,
    maps: Maps,
    bar: ProgressBar,
    quiet: bool,
    done: usize,
    count: usize,
}

pub(super) fn run(args: &DataArgs, output: &Output<'_>) -> Result<Outcome> {
    let runs = runs(args)?;
    output.check()?;
    let tasks = args.shard.part(tasks(args)?);
    let mut backends = args.backend.open(args.quiet)?;
    let mut sink = Sink::open(args, output)?;
    sink.check(&tasks, &backends)?;
    let pending: Vec<Vec<(usize, &RunSpec)>> = (tasks.iter())
        .map(|task| {
            let all = (0..backends.len()).flat_map(|on| runs.iter().map(move |run| (on, run)));
            all.filter(|(on, run)| sink.results.get(&job(task, run, &backends[*on]).key()).is_none())
                .collect()
        })
        .collect();
    let all = tasks.len() * runs.len() * backends.len();
    sink.begin(pending.iter().map(Vec::len).sum(), all, tasks.len());
    let ran = (tasks.iter().zip(&pending))
        .filter(|(_, pending)| !pending.is_empty())
        .try_for_each(|(task, pending)| evaluate(task, pending, &mut backends, args.repeats, &mut sink));
    sink.bar.finish_and_clear();
    ran?;
    let Sink { path, journal, results, maps, .. } = sink;
    drop(journal);
    if output.folder.is_some() {
        results.write(&path)?;
    }
    output.finish(&results, &maps)
}

/// The runs that the flags ask for.
fn runs(args: &DataArgs) -> Result<Vec<RunSpec>> {
    let mut runs = args.run.clone();
    if !(args.algorithm.is_empty() && args.preset.is_empty()) || runs.is_empty() {
        let all: Vec<String> =
            RunSpec::defaults().iter().map(|run| run.algorithm().name().to_owned()).collect();
        let algorithms = if args.algorithm.is_empty() { &all } else { &args.algorithm };
        let default = ["default".to_owned()];
        let presets = if args.preset.is_empty() { &default[..] } else { &args.preset };
        runs.extend(RunSpec::combinations(algorithms, presets)?);
    }
    let mut seen = BTreeSet::new();
    runs.retain(|run| seen.insert(run.label().to_owned()));
    if let Some(baseline) = args.baseline.as_ref().filter(|baseline| !seen.contains(baseline.label())) {
        let known: Vec<&str> = runs.iter().map(RunSpec::label).collect();
        return Err(Error::parameter(
            "--baseline",
            baseline,
            format!("one of the runs: {}", known.join(", ")),
        ));
    }
    Ok(runs)
}

/// The pairs of all data sets.
fn tasks(args: &DataArgs) -> Result<Vec<Task>> {
    let mut sets: Vec<DataSet> = Vec::new();
    for folder in &args.data {
        sets.extend(data_set::find(folder, args.kind)?);
    }
    select(&mut sets, &args.pairs)?;
    let mut names = BTreeSet::new();
    if let Some(twice) = sets.iter().find(|set| !names.insert(&set.name)) {
        let expected = "one data set of each name, as results are kept by name; rename a folder";
        return Err(Error::parameter("--data", format_args!("two data sets named {}", twice.name), expected));
    }
    if !args.quiet {
        for set in &sets {
            print::note(format_args!("{}: {}, {}", set.name, set.kind, counted(set.pairs.len(), "pair")));
        }
    }
    let task = |set: &str, (i, files): (usize, PairFiles)| Task {
        set: set.to_owned(),
        files,
        has_maps: i < args.maps,
    };
    Ok(sets
        .into_iter()
        .flat_map(|set| {
            set.pairs.into_iter().enumerate().map(move |pair| task(&set.name, pair)).collect::<Vec<_>>()
        })
        .collect())
}

fn job(task: &Task, run: &RunSpec, on: &OpenedBackend) -> Job {
    Job {
        set: task.set.clone(),
        pair: task.files.name.clone(),
        run: run.label().to_owned(),
        backend: on.kind().to_owned(),
    }
}

/// Evaluates the runs on a pair. A pair that cannot be read, and a run that fails, is a result.
fn evaluate(
    task: &Task,
    pending: &[(usize, &RunSpec)],
    backends: &mut [OpenedBackend],
    repeats: u32,
    sink: &mut Sink,
) -> Result<()> {
    let input = task.files.digest().unwrap_or_default();
    let loaded = task.files.load().and_then(|pair| {
        let classes = Classes::new(&pair.frames[0].frame()?, &pair.truth)?;
        Ok((pair, classes))
    });
    if let Ok((pair, _)) = &loaded {
        sink.show(task, pair)?;
    }
    for &(on, run) in pending {
        let job = job(task, run, &backends[on]);
        let adapter = backends[on].backend.name();
        let ended = match &loaded {
            Err(error) => Ended::Failed(error.to_string()),
            Ok((pair, classes)) => match score(&backends[on], run, pair, classes, repeats) {
                Ok((ended, flow)) => {
                    sink.map(task, &job, pair, &flow)?;
                    ended
                }
                Err(error) => {
                    backends[on].renew();
                    Ended::Failed(error.to_string())
                }
            },
        };
        sink.add(PairResult { job, input: input.clone(), adapter, ended })?;
    }
    Ok(())
}

fn score(
    on: &OpenedBackend,
    run: &RunSpec,
    pair: &LoadedPair,
    classes: &Classes,
    repeats: u32,
) -> Result<(Ended, FlowField)> {
    let frames = [pair.frames[0].frame()?, pair.frames[1].frame()?];
    let found = estimate(&on.backend, run.algorithm(), [&frames[0], &frames[1]], repeats)?;
    let score = Score::new(&pair.truth, classes, &found.flow, Some(&found.confidence))?;
    Ok((Ended::Scored { score, time: found.time }, found.flow))
}

impl Sink {
    fn open(args: &DataArgs, output: &Output<'_>) -> Result<Self> {
        let configuration = configuration(args.repeats > 0)?;
        let (path, journal, results, maps) = match output.folder {
            Some(folder) => {
                input::folder(folder)?;
                let path = folder.join(RESULTS);
                let Opened { journal, results, repaired } = Journal::open(&path, &configuration)?;
                if repaired {
                    print::note(format_args!("{}: dropped an incomplete last line", path.display()));
                }
                (path, Some(journal), results, Maps::beside(folder))
            }
            None => {
                let maps =
                    if output.html.is_some() { Maps::Memory(Default::default()) } else { Maps::Nowhere };
                (PathBuf::from("results"), None, Results::new(configuration), maps)
            }
        };
        Ok(Self {
            path,
            journal,
            results,
            maps,
            bar: ProgressBar::hidden(),
            quiet: args.quiet,
            done: 0,
            count: 0,
        })
    }

    /// Checks that results already present are of the same files and of the same adapters.
    fn check(&self, tasks: &[Task], backends: &[OpenedBackend]) -> Result<()> {
        for on in backends.iter().filter(|on| on.kind() == "gpu") {
            let name = on.backend.name();
            let done =
                self.results.all().filter(|result| result.job.backend == "gpu" && !result.is_failure());
            if let Some(other) = done.map(|result| &result.adapter).find(|adapter| **adapter != name) {
                let expected = format!("{name}, the adapter of this run; or another folder");
                return Err(Error::format(&self.path, "adapter of its results", other, expected));
            }
        }
        for task in tasks {
            let is_own =
                |result: &&PairResult| result.job.set == task.set && result.job.pair == task.files.name;
            let Some(result) = self.results.all().filter(|result| !result.is_failure()).find(is_own) else {
                continue;
            };
            let found = task.files.digest()?;
            if found != result.input {
                let what = format!("digest of the files of {}/{}", task.set, task.files.name);
                let expected = format!("{found}, that of {}; or another folder", task.files.flow.display());
                return Err(Error::format(&self.path, what, &result.input, expected));
            }
        }
        Ok(())
    }

    fn begin(&mut self, count: usize, all: usize, pairs: usize) {
        self.count = count;
        if !self.quiet {
            let already = if count < all { format!(", {} already done", all - count) } else { String::new() };
            print::note(format_args!(
                "{} on {}{already}",
                counted(all, "evaluation"),
                counted(pairs, "pair")
            ));
            let style = ProgressStyle::with_template("{bar:40} {pos}/{len}, {eta} left, {msg}");
            self.bar = ProgressBar::new(count as u64)
                .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        }
    }

    /// Keeps a result, and tells it.
    fn add(&mut self, result: PairResult) -> Result<()> {
        if let Some(journal) = &mut self.journal {
            journal.add(&result)?;
        }
        self.done += 1;
        let Job { set, pair, run, backend } = &result.job;
        let name = format!("{set}/{pair} {run} on {backend}");
        match &result.ended {
            // A failure is told in any case.
            Ended::Failed(reason) => self.bar.suspend(|| print::note(format_args!("{name}: {reason}"))),
            Ended::Scored { .. } if self.quiet => (),
            Ended::Scored { .. } if !self.bar.is_hidden() => self.bar.set_message(name),
            Ended::Scored { .. } => {
                let table = Table::of(&[&result], None);
                let figures = table.pairs.first().map(|row| {
                    let time = row.time.map_or_else(String::new, |time| format!(", {:.1} ms", time.wall_ms));
                    format!("AEE {} px, AAE {}°{time}", cell(row, &ERRORS[0]), cell(row, &ERRORS[2]))
                });
                let (done, count) = (self.done, self.count);
                print::note(format_args!("{done}/{count} {name}: {}", figures.unwrap_or_default()));
            }
        }
        self.bar.inc(1);
        self.results.add(&self.path, result)
    }

    /// Keeps the images of a pair that are the same for all runs.
    fn show(&mut self, task: &Task, pair: &LoadedPair) -> Result<()> {
        let (set, name) = (&task.set, &task.files.name);
        if task.has_maps && self.maps.are_wanted() && !self.maps.has(set, name, Shown::Truth) {
            let (truth, _) = colour_wheel(&pair.truth.flow, None)?;
            self.maps.put(set, name, Shown::FirstFrame, png(&pair.frames[0])?)?;
            self.maps.put(set, name, Shown::Truth, png(&truth)?)?;
        }
        Ok(())
    }

    /// Keeps the error map of a run.
    fn map(&mut self, task: &Task, job: &Job, pair: &LoadedPair, flow: &FlowField) -> Result<()> {
        if task.has_maps && self.maps.are_wanted() {
            let map = error_map(&pair.truth.flow, flow)?;
            self.maps.put(&task.set, &task.files.name, Shown::Error(job), png(&map)?)?;
        }
        Ok(())
    }
}

/// An image as PNG, not wider than [`WIDEST`].
fn png(image: &Image) -> Result<Vec<u8>> {
    picture::encode_png(&thinned(image, WIDEST))
}

/// The path of the results in a folder.
pub(super) fn results_in(folder: &Path) -> PathBuf {
    folder.join(RESULTS)
}
