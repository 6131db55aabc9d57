//! Records a flight, and reports its progress.

use indicatif::{ProgressBar, ProgressStyle};

use super::measured::Picture;
use super::shown;
use super::timing::Costs;
use super::video::Video;
use crate::cli::print;
use crate::error::Result;
use crate::sim::Course;
use crate::sim::flight::{FRAME_S, Flight, FlightFrame, Record, Summary};

/// The records of a flight in progress.
pub(super) struct Recorder {
    pub(super) records: Vec<Record>,
    pub(super) costs: Costs,
    pub(super) picture: Option<Picture>,
    bar: ProgressBar,
    /// Whether to print a line per second if there is no bar.
    talks: bool,
}

impl Recorder {
    pub(super) fn new(course: &Course, picture: Option<Picture>, quiet: bool) -> Self {
        let bar = if quiet { ProgressBar::hidden() } else { progress(course) };
        Self { records: Vec::new(), costs: Costs::default(), picture, bar, talks: !quiet }
    }

    /// Flies to the end and records every frame.
    pub(super) fn fly(&mut self, flight: &mut Flight, mut video: Option<&mut Video<'_>>) -> Result<Summary> {
        loop {
            let ended = flight.step(|seen| {
                self.add(seen);
                video.as_mut().map_or(Ok(()), |video| video.add(seen))
            })?;
            self.costs.add(flight.cost());
            if let Some(summary) = ended {
                return Ok(summary);
            }
        }
    }

    /// Removes the bar.
    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }

    fn add(&mut self, seen: &FlightFrame<'_>) {
        self.records.push(seen.record.clone());
        if let Some(picture) = &mut self.picture {
            picture.add(seen);
        }
        if let Some(cue) = seen.cue {
            self.costs.add_latency(cue.latency);
        }
        self.say(seen.record);
    }

    /// Reports progress: with a bar on a terminal, otherwise with a line per second of flight.
    fn say(&self, record: &Record) {
        let state = match &record.invalid {
            Some(why) => format!("no cue: {why}"),
            None => match record.contact_s {
                Some(contact_s) => format!("contact in {contact_s:.1} s"),
                None => "no contact ahead".to_owned(),
            },
        };
        if !self.bar.is_hidden() {
            self.bar.set_position(record.progress_m.max(0.0) as u64);
            self.bar.set_message(state);
        } else if self.talks && (record.time_s % 1.0) < 0.5 * FRAME_S {
            print::note(format_args!(
                "{:.0} s, progress {:.0} m, clearance {:.1} m, bank {:+.0}°, {state}",
                record.time_s,
                shown(record.progress_m),
                record.clearance_m,
                shown(record.roll_pitch_yaw_rad[0].to_degrees()),
            ));
        }
    }
}

/// A bar over the course's length in metres, on standard error if that is a terminal.
fn progress(course: &Course) -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:40} {pos}/{len} m, {elapsed}, {msg}");
    ProgressBar::new(course.length_m.ceil() as u64)
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
