//! Progress of long work on standard error.

use std::cell::{Cell, RefCell};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use super::print;

/// The time between two lines where there is no terminal: a log stays short, and shows that work goes on.
const BETWEEN: Duration = Duration::from_secs(10);

/// Shows the progress of long work: as a bar on a terminal, otherwise as a line every ten seconds.
pub(super) struct Progress {
    bar: ProgressBar,
    /// Where there is no terminal; `None` if nothing is to be said.
    lines: Option<Lines>,
}

/// The lines that are printed from time to time.
struct Lines {
    unit: &'static str,
    total: Option<u64>,
    done: Cell<u64>,
    about: RefCell<String>,
    last: Cell<Instant>,
}

impl Progress {
    /// Progress over this many units, or over an unknown number. `quiet` says nothing.
    pub(super) fn new(total: Option<u64>, unit: &'static str, quiet: bool) -> Self {
        if quiet {
            return Self { bar: ProgressBar::hidden(), lines: None };
        }
        let bar = match total {
            Some(total) => ProgressBar::new(total)
                .with_style(style(&format!("{{bar:40}} {{pos}}/{{len}} {unit}, {{eta}} left{{msg}}"))),
            None => ProgressBar::new_spinner()
                .with_style(style(&format!("{{spinner}} {{pos}} {unit}, {{per_sec}}{{msg}}"))),
        };
        let lines = bar.is_hidden().then(|| Lines {
            unit,
            total,
            done: Cell::new(0),
            about: RefCell::default(),
            last: Cell::new(Instant::now()),
        });
        Self { bar, lines }
    }

    /// The same for a sequence of images; nothing is said of up to `brief` of them.
    pub(super) fn of_sequence(total: Option<u64>, unit: &'static str, brief: u64, quiet: bool) -> Self {
        Self::new(total, unit, quiet || total.is_some_and(|total| total <= brief))
    }

    /// Whether there is a bar.
    pub(super) fn is_bar(&self) -> bool {
        !self.bar.is_hidden()
    }

    /// What stands behind the numbers from now on.
    pub(super) fn tell(&self, about: String) {
        match &self.lines {
            Some(lines) => {
                lines.about.replace(about);
            }
            None => self.bar.set_message(format!(", {about}")),
        }
    }

    /// Counts one unit as done.
    pub(super) fn inc(&self) {
        self.bar.inc(1);
        self.say(Instant::now());
    }

    /// Sets the number of units done.
    pub(super) fn set(&self, done: u64) {
        self.bar.set_position(done);
        self.say(Instant::now());
    }

    /// Prints other lines without disturbing the bar.
    pub(super) fn aside(&self, print: impl FnOnce()) {
        self.bar.suspend(print);
    }

    /// Removes the bar.
    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }

    fn say(&self, now: Instant) {
        if let Some(line) = self.lines.as_ref().and_then(|lines| lines.due(self.bar.position(), now)) {
            print::note(line);
        }
    }
}

impl Lines {
    /// The line, if it is time for one and something was done since the last.
    fn due(&self, done: u64, now: Instant) -> Option<String> {
        if done == self.done.get() || now.saturating_duration_since(self.last.get()) < BETWEEN {
            return None;
        }
        self.done.set(done);
        self.last.set(now);
        let total = self.total.map_or_else(String::new, |total| format!("/{total}"));
        let about = self.about.borrow();
        let separator = if about.is_empty() { "" } else { ", " };
        Some(format!("{done}{total} {}{separator}{about}", self.unit))
    }
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_sparse() {
        let start = Instant::now();
        let lines = Lines {
            unit: "frames",
            total: Some(90),
            done: Cell::new(0),
            about: RefCell::default(),
            last: Cell::new(start),
        };
        let at = |seconds: u64| start + Duration::from_secs(seconds);
        assert_eq!(lines.due(5, at(9)), None);
        assert_eq!(lines.due(6, at(10)), Some("6/90 frames".to_owned()));
        assert_eq!(lines.due(7, at(19)), None);
        lines.about.replace("3 failed".to_owned());
        assert_eq!(lines.due(8, at(25)), Some("8/90 frames, 3 failed".to_owned()));
        // Nothing was done since.
        assert_eq!(lines.due(8, at(60)), None);
    }
}
