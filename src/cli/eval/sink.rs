//! Where results go: the journal, the images of the page, and the progress on standard error.

use std::collections::HashMap;
use std::path::PathBuf;

use super::DataArgs;
use super::backends::Opened as OpenedBackend;
use super::columns::{ERRORS, cell};
use super::maps::{Maps, Shown};
use super::output::{Output, RESULTS, configuration};
use super::sets::Task;
use crate::cli::print;
use crate::cli::progress::Progress;
use crate::error::{Error, Result};
use crate::eval::data_set::LoadedPair;
use crate::eval::{Ended, Job, PairResult, Table, gray_levels};
use crate::frame::{FlowField, Image, PixelFormat};
use crate::io::picture;
use crate::journal::{Entry, Journal, Opened, Results};
use crate::report::{colour_wheel, error_map, thinned};
use crate::text::counted;

/// The widest image, in pixels; larger ones are thinned out.
const WIDEST: u32 = 640;
/// The quality of JPEG.
const QUALITY: u8 = 85;

/// Everything that results go to.
pub(super) struct Sink {
    path: PathBuf,
    journal: Option<Journal<PairResult>>,
    pub(super) results: Results<PairResult>,
    pub(super) maps: Maps,
    pub(super) progress: Progress,
    quiet: bool,
    done: usize,
    count: usize,
}

impl Sink {
    pub(super) fn open(args: &DataArgs, output: &Output<'_>) -> Result<Self> {
        let configuration = configuration(args.repeats > 0)?;
        let (path, journal, results, maps) = match output.folder {
            Some(folder) => {
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
            progress: Progress::new(None, "evaluations", true),
            quiet: args.quiet,
            done: 0,
            count: 0,
        })
    }

    /// Checks that results already present are of the same files and of the same adapters.
    pub(super) fn check(&self, tasks: &[Task], backends: &[OpenedBackend]) -> Result<()> {
        for on in backends.iter().filter(|on| on.kind() == "gpu") {
            let name = on.backend.name();
            let done =
                self.results.all().filter(|result| result.job.backend == "gpu" && !result.is_failure());
            if let Some(other) = done.map(|result| &result.adapter).find(|adapter| **adapter != name) {
                let expected = format!("{name}, the adapter of this run; or another folder");
                return Err(Error::format(&self.path, "adapter of its results", other, expected));
            }
        }
        let done = self.results.all().filter(|result| !result.is_failure());
        let by_pair: HashMap<(&str, &str), &PairResult> =
            done.map(|result| ((&*result.job.set, &*result.job.pair), result)).collect();
        for task in tasks {
            let Some(result) = by_pair.get(&(&*task.set, &*task.files.name)) else { continue };
            // A file that is missing now fails the runs that are left, not those that are done.
            let Ok(found) = task.files.digest() else { continue };
            if found != result.input {
                let what = format!("digest of the files of {}/{}", task.set, task.files.name);
                let expected = format!("{found}, that of {}; or another folder", task.files.flow.display());
                return Err(Error::format(&self.path, what, &result.input, expected));
            }
        }
        Ok(())
    }

    pub(super) fn begin(&mut self, count: usize, all: usize, pairs: usize) {
        self.count = count;
        if !self.quiet {
            let already = if count < all { format!(", {} already done", all - count) } else { String::new() };
            print::note(format_args!(
                "{} on {}{already}",
                counted(all, "evaluation"),
                counted(pairs, "pair")
            ));
            // Without a terminal each result is a line, so that there are none in between.
            let bar = Progress::new(Some(count as u64), "evaluations", false);
            if bar.is_bar() {
                self.progress = bar;
            }
        }
    }

    /// Keeps a result, and tells it.
    pub(super) fn add(&mut self, result: PairResult) -> Result<()> {
        if let Some(journal) = &mut self.journal {
            journal.add(&result)?;
        }
        self.done += 1;
        let Job { set, pair, run, backend } = &result.job;
        let name = format!("{set}/{pair} {run} on {backend}");
        match &result.ended {
            // A failure is told in any case.
            Ended::Failed(reason) => self.progress.aside(|| print::note(format_args!("{name}: {reason}"))),
            Ended::Scored { .. } if self.quiet => (),
            Ended::Scored { .. } if self.progress.is_bar() => self.progress.tell(name),
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
        self.progress.inc();
        self.results.add(&self.path, result)
    }

    /// Keeps the images of a pair that are the same for all runs.
    pub(super) fn show(&mut self, task: &Task, pair: &LoadedPair) -> Result<()> {
        let (set, name) = (&task.set, &task.files.name);
        if task.has_maps && self.maps.are_wanted() && !self.maps.has(set, name, Shown::Truth) {
            let (truth, _) = colour_wheel(&pair.truth.flow, None)?;
            self.maps.put(set, name, Shown::FirstFrame, jpeg(&pair.frames[0])?)?;
            self.maps.put(set, name, Shown::Truth, jpeg(&truth)?)?;
        }
        Ok(())
    }

    /// Keeps the error map of a run.
    pub(super) fn map(&mut self, task: &Task, job: &Job, pair: &LoadedPair, flow: &FlowField) -> Result<()> {
        if task.has_maps && self.maps.are_wanted() {
            let map = error_map(&pair.truth.flow, flow)?;
            self.maps.put(
                &task.set,
                &task.files.name,
                Shown::Error(job),
                picture::encode_png(&thinned(&map, WIDEST))?,
            )?;
        }
        Ok(())
    }

    /// Writes the results in their order, and closes the journal.
    pub(super) fn close(self) -> Result<(Results<PairResult>, Maps)> {
        let Self { path, journal, results, maps, .. } = self;
        if journal.is_some() {
            drop(journal);
            results.write(&path)?;
        }
        Ok((results, maps))
    }
}

/// An image as JPEG, not wider than [`WIDEST`]. One with alpha or 16 bits becomes gray.
fn jpeg(image: &Image) -> Result<Vec<u8>> {
    let small = thinned(image, WIDEST);
    let small = match small.format {
        PixelFormat::Gray8 | PixelFormat::Rgb8 => small,
        PixelFormat::Gray16 | PixelFormat::Rgba8 => {
            let levels = gray_levels(&small.frame()?);
            let data = levels.into_iter().map(|level| level.round() as u8).collect();
            Image { size: small.size, format: PixelFormat::Gray8, data }
        }
    };
    picture::encode_jpeg(&small, QUALITY)
}
