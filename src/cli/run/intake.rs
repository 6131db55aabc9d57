//! Frames with their times, every one of them or the newest.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use super::times::{Rate, Times};
use crate::cli::flow::source::Source;
use crate::error::{Error, Result};
use crate::frame::Image;

/// Longer than any recording lasts: what a wild frame time asks for is not waited for any longer than this.
const LONGEST_WAIT: Duration = Duration::from_secs(24 * 3600);

/// A frame, its place in the source, and its time.
#[derive(Clone, Debug)]
pub(super) struct Taken {
    pub(super) image: Image,
    pub(super) number: u64,
    pub(super) time_s: f64,
    /// When it was there to be used.
    pub(super) there: Instant,
}

impl Default for Taken {
    fn default() -> Self {
        Self { image: Image::default(), number: 0, time_s: 0.0, there: Instant::now() }
    }
}

/// Reads frames and says when each was taken.
pub(super) struct Reader {
    source: Source,
    times: Times,
    frames: u64,
}

impl Reader {
    pub(super) fn new(source: Source, times: Times) -> Self {
        Self { source, times, frames: 0 }
    }

    /// What the last frame read is called.
    pub(super) fn name(&self) -> std::path::PathBuf {
        self.source.name()
    }

    /// Frames a second, or so many in the mean.
    pub(super) fn rate(&self) -> Rate {
        self.times.rate()
    }

    /// Reads the next frame. Returns false after the last one.
    pub(super) fn next(&mut self, taken: &mut Taken) -> Result<bool> {
        if !self.source.next(&mut taken.image)? {
            self.times.check_end(self.frames)?;
            return Ok(false);
        }
        (taken.number, taken.time_s) = (self.frames, self.times.of(self.frames)?);
        taken.there = Instant::now();
        self.frames += 1;
        Ok(true)
    }
}

/// Where the frames come from.
pub(super) enum Intake {
    /// Each in its turn.
    Each(Box<Reader>),
    /// The newest one: those that nobody had time for are dropped.
    Newest(Arc<Newest>),
}

impl Intake {
    /// Begins to read on a thread of its own. What is not `live` is delivered as its times say, counted from the frame
    /// that was read before, now.
    pub(super) fn newest(mut reader: Reader, first: &Taken, live: bool) -> Self {
        let newest = Arc::new(Newest::default());
        let (shared, begin, from_s) = (newest.clone(), Instant::now(), first.time_s);
        // Never joined: it may be waiting for a frame of a stream when everybody else is done.
        thread::spawn(move || {
            let mut taken = Taken::default();
            let end = loop {
                match reader.next(&mut taken) {
                    Ok(true) => {}
                    Ok(false) => break Ok(()),
                    Err(error) => break Err(error),
                }
                if !live {
                    taken.there = wait_until(begin, taken.time_s - from_s);
                }
                shared.put(&mut taken);
            };
            shared.end(end);
        });
        Self::Newest(newest)
    }

    /// The next frame. Returns false after the last one.
    pub(super) fn next(&mut self, taken: &mut Taken) -> Result<bool> {
        match self {
            Self::Each(reader) => reader.next(taken),
            Self::Newest(newest) => newest.take(taken),
        }
    }

    /// Frames that nobody had time for.
    pub(super) fn dropped(&self) -> u64 {
        match self {
            Self::Each(_) => 0,
            Self::Newest(newest) => newest.state().dropped,
        }
    }
}

/// Sleeps until so many seconds after the beginning.
fn wait_until(begin: Instant, after_s: f64) -> Instant {
    let after = Duration::try_from_secs_f64(after_s.max(0.0)).unwrap_or(LONGEST_WAIT).min(LONGEST_WAIT);
    let due = begin.checked_add(after).unwrap_or(begin);
    thread::sleep(due.saturating_duration_since(Instant::now()));
    due
}

/// A place for one waiting frame.
#[derive(Default)]
pub(super) struct Newest {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    frame: Taken,
    waiting: bool,
    dropped: u64,
    end: Option<Result<(), Error>>,
}

impl Newest {
    fn state(&self) -> MutexGuard<'_, State> {
        // Nothing in here can panic half-way.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Puts a frame in the place of one that may still wait there, and gets that one's memory back.
    fn put(&self, taken: &mut Taken) {
        let mut state = self.state();
        std::mem::swap(&mut state.frame, taken);
        if std::mem::replace(&mut state.waiting, true) {
            state.dropped += 1;
        }
        self.changed.notify_one();
    }

    fn end(&self, end: Result<()>) {
        self.state().end = Some(end);
        self.changed.notify_one();
    }

    fn take(&self, taken: &mut Taken) -> Result<bool> {
        let mut state = self.state();
        loop {
            if std::mem::take(&mut state.waiting) {
                std::mem::swap(&mut state.frame, taken);
                return Ok(true);
            }
            if let Some(end) = state.end.take() {
                return end.map(|()| false);
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_is_kept_and_the_last_comes_before_the_end() {
        let newest = Newest::default();
        for number in 0..5 {
            newest.put(&mut Taken { number, ..Taken::default() });
        }
        newest.end(Err(Error::Ticket { ticket: 7 }));
        let mut taken = Taken::default();
        assert!(newest.take(&mut taken).unwrap());
        assert_eq!((taken.number, newest.state().dropped), (4, 4));
        assert!(matches!(newest.take(&mut taken), Err(Error::Ticket { ticket: 7 })));
    }

    #[test]
    fn what_is_due_in_the_past_is_not_waited_for() {
        let begin = Instant::now();
        for after_s in [-1.0, f64::NAN, 0.0] {
            assert_eq!(wait_until(begin, after_s), begin);
        }
    }
}
