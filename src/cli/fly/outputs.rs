//! The files of a flight, and its summary as text.

use std::fs::{self, File};
use std::io::{BufRead, BufReader};
use std::path::Path;

use super::log::End;
use super::measured::PICTURE;
use super::recorder::Recorder;
use super::setup::SetupArgs;
use super::timing::Timing;
use super::{cues, log, measured, shown};
use crate::backend::Backend;
use crate::cli::{paths, print};
use crate::error::Result;
use crate::io::{remove, write_bytes};
use crate::report::flight::FlightReport;
use crate::sim::flight::{Flight, Summary};

const LOG: &str = "flight.jsonl";
const TIMING: &str = "timing.json";
const PAGE: &str = "report.html";
pub(super) const VIDEO: &str = "flight.y4m";
/// All files of a flight.
pub(super) const FILES: [&str; 5] = [LOG, TIMING, PAGE, VIDEO, PICTURE];

/// Checks that files to be replaced in the folder belong to an earlier flight.
pub(super) fn spare(folder: &Path) -> Result<()> {
    let begins = |line: String| line.starts_with("{\"viewsphere\":");
    let log = File::open(folder.join(LOG)).map(BufReader::new);
    let is_own = log.is_ok_and(|log| log.lines().next().is_some_and(|line| line.is_ok_and(begins)));
    paths::of_an_earlier_run(folder, &FILES, is_own, "the flight.jsonl of an earlier flight")
}

/// A completed flight.
pub(super) struct Flown<'a> {
    pub(super) flight: &'a Flight,
    pub(super) recorder: &'a Recorder,
    pub(super) summary: &'a Summary,
    /// The backends that rendered the images and computed the flow; `None` for a sensor without images.
    pub(super) names: Option<[String; 2]>,
}

impl Flown<'_> {
    /// Writes all files but the video, which was written during the flight, and returns the summary as text.
    pub(super) fn write(&self, folder: &Path, setup: &SetupArgs) -> Result<String> {
        let Recorder { records, costs, picture, .. } = self.recorder;
        let timing = costs.timing(self.names.clone());
        let page = FlightReport {
            course: self.flight.course(),
            config: self.flight.config(),
            backend: &self.computed_on(),
            records,
            summary: self.summary,
            costs: costs.frames(),
        };
        let texts = [self.log(setup)?, print::one_line(&timing)? + "\n", page.html()];
        for (name, text) in [LOG, TIMING, PAGE].into_iter().zip(texts) {
            write_bytes(folder.join(name), text.as_bytes())?;
        }
        // An image left by an earlier flight would be mistaken for this one's.
        remove(folder.join(PICTURE))?;
        let picture = picture.as_ref().map(|picture| picture.write(folder)).transpose()?;
        let told = self.text(folder, &timing);
        let measured = measured::text(self.summary.measured.as_ref(), picture);
        Ok(std::iter::once(told).chain(measured).collect::<Vec<_>>().join("\n"))
    }

    /// The log as JSON lines.
    fn log(&self, setup: &SetupArgs) -> Result<String> {
        let mut lines = vec![log::header(self.flight, setup, self.names.as_ref())?];
        for record in &self.recorder.records {
            lines.push(log::frame(record)?);
        }
        lines.push(print::one_line(&End::from(self.summary))?);
        Ok(lines.join("\n") + "\n")
    }

    fn text(&self, folder: &Path, timing: &Timing) -> String {
        let Self { summary, recorder, .. } = self;
        let reasons = recorder.records.iter().filter_map(|record| record.invalid.as_deref());
        let video = fs::metadata(folder.join(VIDEO))
            .map_or(String::new(), |file| format!(", and a video of {:.0} MB", 1e-6 * file.len() as f64));
        let touches = match (self.flight.config().fly_on, summary.touches) {
            (false, _) => String::new(),
            (true, 1) => ", 1 touch".to_owned(),
            (true, count) => format!(", {count} touches"),
        };
        format!(
            "outcome    {} after {:.1} s and {:.0} m{touches}\n\
             clearance  least {:.2} m, 5th percentile {:.2} m\n\
             path       {:.1} m flown, {:.1} % of it towards the goal\n\
             control    roll rate {:.1} °/s (root mean square)\n\
             cues       {}\n\
             speed      {}\n\
             log        in {}{video}",
            summary.outcome,
            summary.time_s,
            shown(summary.progress_m),
            summary.least_clearance_m,
            summary.low_clearance_m,
            summary.path_m,
            100.0 * summary.efficiency(),
            summary.roll_rate_rad_s.to_degrees(),
            cues::text(summary.invalid, reasons),
            timing.text(),
            folder.display(),
        )
    }

    /// The backends as text. Without images only the CPU computes.
    fn computed_on(&self) -> String {
        match &self.names {
            None => Backend::Cpu.name(),
            Some([renderer, flow]) if renderer == flow => flow.clone(),
            Some([renderer, flow]) => format!("{flow}, images on {renderer}"),
        }
    }
}
