use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use crate::error::{Error, Result};
use crate::frame::Image;

/// A frame, its number in the source, and its time.
#[derive(Clone, Debug)]
pub struct TimedFrame {
    /// The image.
    pub image: Image,
    /// The frame's number in its source, from 0.
    pub number: u64,
    /// The middle of its exposure, in seconds of the camera's clock.
    pub time_s: f64,
    /// When it became available.
    pub arrived: Instant,
}

/// An empty image, for a source to fill.
impl Default for TimedFrame {
    fn default() -> Self {
        Self { image: Image::default(), number: 0, time_s: 0.0, arrived: Instant::now() }
    }
}

/// A slot for one waiting frame between two threads. A frame that arrives while another one waits replaces it, and the
/// replaced one counts as dropped.
///
/// Frames are swapped in and out, so that in steady state their memory is reused.
#[derive(Debug, Default)]
pub struct LatestFrame {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct State {
    frame: TimedFrame,
    waiting: bool,
    dropped: u64,
    ended: bool,
    error: Option<Error>,
}

impl LatestFrame {
    fn state(&self) -> MutexGuard<'_, State> {
        // Nothing in here can panic half-way.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Puts a frame into the slot, in place of one that may still wait there. Afterwards `frame` is an older frame,
    /// whose memory can be reused.
    pub fn put(&self, frame: &mut TimedFrame) {
        let mut state = self.state();
        std::mem::swap(&mut state.frame, frame);
        if std::mem::replace(&mut state.waiting, true) {
            state.dropped += 1;
        }
        self.changed.notify_one();
    }

    /// Ends the frames, with an error if they ended with one. A waiting frame can still be taken.
    pub fn end(&self, end: Result<()>) {
        let mut state = self.state();
        (state.ended, state.error) = (true, end.err());
        self.changed.notify_all();
    }

    /// Waits for a frame that has not been taken yet. It is swapped with `frame`, whose memory is reused. Returns false
    /// after the last frame.
    ///
    /// # Errors
    /// The error given to [`LatestFrame::end`], once.
    pub fn take(&self, frame: &mut TimedFrame) -> Result<bool> {
        let mut state = self.state();
        loop {
            if std::mem::take(&mut state.waiting) {
                std::mem::swap(&mut state.frame, frame);
                return Ok(true);
            }
            if state.ended {
                return state.error.take().map_or(Ok(false), Err);
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// The number of frames that were replaced before they were taken.
    pub fn dropped(&self) -> u64 {
        self.state().dropped
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_is_kept_and_the_last_comes_before_the_end() {
        let latest = LatestFrame::default();
        for number in 0..5 {
            latest.put(&mut TimedFrame { number, ..TimedFrame::default() });
        }
        latest.end(Err(Error::Ticket { ticket: 7 }));
        let mut taken = TimedFrame::default();
        assert!(latest.take(&mut taken).unwrap());
        assert_eq!((taken.number, latest.dropped()), (4, 4));
        assert!(matches!(latest.take(&mut taken), Err(Error::Ticket { ticket: 7 })));
        assert!(!latest.take(&mut taken).unwrap());
    }
}
