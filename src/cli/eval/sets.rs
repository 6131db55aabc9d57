//! Runs algorithms on the pairs of data sets.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::DataArgs;
use super::backends::Opened as OpenedBackend;
use super::literature::NamedTable;
use super::output::{Output, RESULTS};
use super::select::select;
use super::sink::Sink;
use crate::benchmark::pair_time;
use crate::cli::args::named_by_flags;
use crate::cli::{Outcome, print};
use crate::error::{Error, Result};
use crate::eval::data_set::{self, DataSet, LoadedPair, PairFiles};
use crate::eval::{Classes, Ended, Job, PairResult, RunSpec, Score, estimate};
use crate::frame::FlowField;
use crate::text::counted;

/// A pair, with the name of its set.
pub(super) struct Task {
    pub(super) set: String,
    pub(super) files: PairFiles,
    /// Whether it has error maps on the page.
    pub(super) has_maps: bool,
}

pub(super) fn run(args: &DataArgs, output: &Output<'_>) -> Result<Outcome> {
    let runs = runs(args)?;
    if let Some(run) = runs.iter().find(|run| run.algorithm().has_memory() && !args.quiet) {
        print::note(print::alone(run.label()));
    }
    output.check()?;
    let tasks = tasks(args)?;
    let count = tasks.len();
    let tasks = args.shard.part(tasks);
    if tasks.is_empty() && !args.quiet {
        print::empty_shard(args.shard, counted(count, "pair"));
    }
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
    sink.progress.finish();
    ran?;
    let (results, maps) = sink.close()?;
    output.finish(&results, &maps)
}

/// The runs that the flags ask for.
fn runs(args: &DataArgs) -> Result<Vec<RunSpec>> {
    let mut runs = args.run.clone();
    if !(args.algorithm.is_empty() && args.preset.is_empty()) || runs.is_empty() {
        let default = [if args.table.is_some() { "all" } else { "default" }.to_owned()];
        let presets = if args.preset.is_empty() { &default[..] } else { &args.preset };
        let found = match args.algorithm.is_empty() {
            true => RunSpec::with_presets(presets),
            false => RunSpec::combinations(&args.algorithm, presets),
        };
        let flags = [("algorithm", "--algorithm"), ("preset", "--preset")];
        runs.extend(found.map_err(|error| named_by_flags(error, &flags))?);
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
    let kind = args.table.map(NamedTable::kind).or(args.kind);
    for folder in &args.data {
        sets.extend(data_set::find(folder, kind)?);
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
    let frames = [&frames[0], &frames[1]];
    let found = estimate(&on.backend, run.algorithm(), frames)?;
    let score = Score::new(&pair.truth, classes, &found.flow, Some(&found.confidence))?;
    let time = match repeats {
        0 => None,
        _ => Some(pair_time(&on.backend, run.algorithm(), frames, repeats)?),
    };
    Ok((Ended::Scored { score, time }, found.flow))
}

/// The path of the results in a folder.
pub(super) fn results_in(folder: &Path) -> PathBuf {
    folder.join(RESULTS)
}
