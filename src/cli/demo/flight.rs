//! The demo's flight.

use indicatif::{ProgressBar, ProgressStyle};

use crate::backend::Backend;
use crate::cli::fly::timing::{Costs, Timing};
use crate::cli::print;
use crate::error::Result;
use crate::report::DemoFlight;
use crate::report::flight::FlightFilm;
use crate::sim::Course;
use crate::sim::flight::{FRAME_S, Flight, FlightConfig, FlightFrame, Outcome, Record};

/// The approximate number of frames in the page's film.
const STILLS: u64 = 150;
/// The frames that are timed to decide whether an adapter is fast enough, after the first ones, in which it warms up.
const TRIED: usize = 12;
const WARM_UP: usize = 2;
/// The longest median frame time allowed to an adapter that computes on the CPU, milliseconds: with more, a flight of
/// ten seconds would take over twelve.
const MOST_MS: f64 = 40.0;

/// The flight to fly.
pub(super) struct Plan<'a> {
    pub(super) course: &'a Course,
    pub(super) config: &'a FlightConfig,
    pub(super) frames: u64,
    pub(super) quiet: bool,
}

/// A flight, possibly cut short.
pub(super) struct Flown {
    pub(super) adapter: String,
    pub(super) why: Option<String>,
    pub(super) records: Vec<Record>,
    pub(super) outcome: Option<Outcome>,
    costs: Costs,
    names: [String; 2],
    film: FlightFilm,
}

/// The result of an attempt to fly on an adapter.
enum Tried {
    Flown(Box<Flown>),
    /// The adapter is too slow: the median frame time, milliseconds.
    TooSlow(f64),
}

impl Plan<'_> {
    /// Flies on a backend, whose name as text is `adapter`. If it may be `replaced` and is a software adapter that is
    /// too slow, the CPU backend flies instead.
    pub(super) fn fly(&self, backend: &Backend, adapter: &str, replaced: bool) -> Result<Flown> {
        let software = matches!(backend, Backend::Gpu(gpu) if gpu.adapter().software);
        let most_ms = (replaced && software).then_some(MOST_MS);
        let frame_ms = match self.attempt(backend, adapter, most_ms)? {
            Tried::Flown(flown) => return Ok(*flown),
            Tried::TooSlow(frame_ms) => frame_ms,
        };
        let why = format!(
            "The flight was computed by the CPU backend: {adapter} took {frame_ms:.0} ms per frame, more than the \
             {MOST_MS:.0} ms that the demo allows to an adapter that itself computes on the CPU."
        );
        if !self.quiet {
            print::note(&why);
        }
        let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        let adapter = format!("the CPU backend, {cores} threads");
        Ok(match self.attempt(&Backend::Cpu, &adapter, None)? {
            Tried::Flown(flown) => Flown { why: Some(why), ..*flown },
            Tried::TooSlow(_) => unreachable!("nothing is too slow without a limit"),
        })
    }

    fn attempt(&self, backend: &Backend, adapter: &str, most_ms: Option<f64>) -> Result<Tried> {
        let mut flight = Flight::new([backend.clone(), backend.clone()], self.course, self.config)?;
        let mut flown = Flown {
            adapter: adapter.to_owned(),
            why: None,
            records: Vec::new(),
            outcome: None,
            costs: Costs::default(),
            names: [backend.name(), backend.name()],
            film: FlightFilm::new(&flight, self.frames.div_ceil(STILLS))?,
        };
        let bar = if self.quiet { ProgressBar::hidden() } else { progress(self.frames) };
        while flown.outcome.is_none() && (flown.records.len() as u64) < self.frames {
            let ended = flight.step(|seen| {
                self.say(&bar, seen);
                flown.records.push(seen.record.clone());
                flown.film.add(seen)
            })?;
            flown.costs.add(flight.cost());
            flown.outcome = ended.map(|summary| summary.outcome);
            if flown.records.len() == WARM_UP + TRIED
                && let Some(frame_ms) = most_ms.and_then(|most_ms| too_slow(&flown.costs, most_ms))
            {
                bar.finish_and_clear();
                return Ok(Tried::TooSlow(frame_ms));
            }
        }
        bar.finish_and_clear();
        Ok(Tried::Flown(Box::new(flown)))
    }

    /// Reports progress: with a bar on a terminal, otherwise with a line for every other second of flight.
    fn say(&self, bar: &ProgressBar, seen: &FlightFrame<'_>) {
        let record = seen.record;
        if !bar.is_hidden() {
            bar.set_position(record.frame + 1);
        } else if !self.quiet && record.frame.is_multiple_of(60) {
            let all_s = self.frames as f64 * FRAME_S;
            print::note(format_args!("flying: {:.0} of {all_s:.0} s", record.time_s));
        }
    }
}

impl Flown {
    pub(super) fn report<'a>(&'a self, course: &'a Course, config: &'a FlightConfig) -> DemoFlight<'a> {
        DemoFlight {
            course,
            config,
            adapter: &self.adapter,
            why: self.why.as_deref(),
            records: &self.records,
            costs: self.costs.frames(),
            outcome: self.outcome,
            film: &self.film,
        }
    }

    pub(super) fn timing(&self) -> Timing {
        self.costs.timing(Some(self.names.clone()))
    }

    pub(super) fn time_s(&self) -> f64 {
        self.records.len() as f64 * FRAME_S
    }

    pub(super) fn least_clearance_m(&self) -> f64 {
        self.records.iter().map(|record| record.clearance_m).fold(f64::INFINITY, f64::min)
    }
}

/// The median frame time in milliseconds, if it exceeds the limit.
fn too_slow(costs: &Costs, most_ms: f64) -> Option<f64> {
    let tried = costs.frames().iter().skip(WARM_UP);
    let mut times_ms: Vec<f64> = tried.map(|cost| 1e3 * cost.total().as_secs_f64()).collect();
    times_ms.sort_by(f64::total_cmp);
    times_ms.get(times_ms.len() / 2).copied().filter(|time_ms| !(*time_ms <= most_ms))
}

/// A bar over the frames, on standard error if that is a terminal.
fn progress(frames: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("flying {bar:40} {pos}/{len} frames, {elapsed}");
    ProgressBar::new(frames).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::sim::flight::Cost;

    #[test]
    fn only_an_adapter_that_is_slow_when_warm_is_too_slow() {
        let costs = |first_ms: u64, then_ms: u64| {
            let mut costs = Costs::default();
            for i in 0..WARM_UP + TRIED {
                let ms = if i < WARM_UP { first_ms } else { then_ms };
                costs.add(Cost { pipeline: Duration::from_millis(ms), ..Cost::default() });
            }
            costs
        };
        assert_eq!(too_slow(&costs(900, 40), 40.0), None);
        assert_eq!(too_slow(&costs(1, 41), 40.0), Some(41.0));
    }
}
