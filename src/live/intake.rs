use std::sync::{Arc, Weak};
use std::thread;
use std::time::{Duration, Instant};

use super::{FrameTimes, LatestFrame, TimedFrame};
use crate::error::{Error, Result};
use crate::frame::Image;

/// Longer than any recording: the longest wait for a frame, whatever its time says.
const LONGEST_WAIT: Duration = Duration::from_secs(24 * 3600);

/// A source of frames.
pub trait FrameSource {
    /// Reads the next frame into `image`, whose memory may be reused. Returns false after the last frame.
    ///
    /// # Errors
    /// Any error that prevents the source from reading its next frame. It is not called again after that.
    fn next_frame(&mut self, image: &mut Image) -> Result<bool>;
}

#[cfg(feature = "io")]
impl FrameSource for crate::io::Frames {
    fn next_frame(&mut self, image: &mut Image) -> Result<bool> {
        crate::io::Frames::next_frame(self, image)
    }
}

/// A source of frames with times.
#[derive(Debug)]
pub struct TimedFrames<S> {
    source: S,
    times: FrameTimes,
    frames: u64,
}

impl<S: FrameSource> TimedFrames<S> {
    /// The frames of `source`, the first of which is number 0 of `times`.
    pub fn new(source: S, times: FrameTimes) -> Self {
        Self { source, times, frames: 0 }
    }

    /// The source.
    pub fn source(&self) -> &S {
        &self.source
    }

    /// The frames' times.
    pub fn times(&self) -> &FrameTimes {
        &self.times
    }

    /// Reads the next frame. Returns false after the last one.
    ///
    /// # Errors
    /// The source's errors, and [`Error::Format`] if there are more or fewer frames than times in a list.
    pub fn next_frame(&mut self, frame: &mut TimedFrame) -> Result<bool> {
        if !self.source.next_frame(&mut frame.image)? {
            self.times.check_end(self.frames)?;
            return Ok(false);
        }
        (frame.number, frame.time_s) = (self.frames, self.times.of(self.frames)?);
        frame.arrived = Instant::now();
        self.frames += 1;
        Ok(true)
    }
}

/// When a source's frames become available.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// As soon as they are read: the source is a live one.
    Source,
    /// At their times, as from a live camera: the source is a recording. The first frame becomes available at the call
    /// of [`Intake::latest`].
    Times,
}

/// An intake of frames with times: every frame in turn, or the newest one.
#[derive(Debug)]
pub struct Intake<S>(Kind<S>);

#[derive(Debug)]
enum Kind<S> {
    Each(TimedFrames<S>),
    Latest(Arc<LatestFrame>),
}

impl<S: FrameSource> Intake<S> {
    /// Each frame in turn, read when it is asked for. None is dropped.
    pub fn each(frames: TimedFrames<S>) -> Self {
        Self(Kind::Each(frames))
    }

    /// Gets the next frame. Returns false after the last one. `frame` may be an earlier frame, whose memory is reused.
    ///
    /// # Errors
    /// As [`TimedFrames::next_frame`]; [`Error::Io`] if the source panicked on its thread.
    pub fn next_frame(&mut self, frame: &mut TimedFrame) -> Result<bool> {
        match &mut self.0 {
            Kind::Each(frames) => frames.next_frame(frame),
            Kind::Latest(latest) => latest.take(frame),
        }
    }

    /// The number of frames that were replaced by newer ones before they were requested.
    pub fn dropped(&self) -> u64 {
        match &self.0 {
            Kind::Each(_) => 0,
            Kind::Latest(latest) => latest.dropped(),
        }
    }
}

impl<S: FrameSource + Send + 'static> Intake<S> {
    /// The newest frame: a thread reads the frames, and frames that are not requested in time are dropped. `first` is
    /// the frame that was read before, from which [`Pace::Times`] counts.
    ///
    /// The thread ends with its source, or with the first frame that it has read after the intake is dropped.
    pub fn latest(mut frames: TimedFrames<S>, first: &TimedFrame, pace: Pace) -> Self {
        let latest = Arc::new(LatestFrame::default());
        let reading = Reading(Arc::downgrade(&latest));
        let (begin, from_s) = (Instant::now(), first.time_s);
        // Never joined: it may still wait for a frame of a stream when the rest of the program is done.
        thread::spawn(move || {
            let mut frame = TimedFrame::default();
            let end = loop {
                match frames.next_frame(&mut frame) {
                    Ok(true) => {}
                    Ok(false) => break Ok(()),
                    Err(error) => break Err(error),
                }
                if pace == Pace::Times {
                    frame.arrived = wait_until(begin, frame.time_s - from_s);
                }
                let Some(latest) = reading.0.upgrade() else { return };
                latest.put(&mut frame);
            };
            reading.end(end);
        });
        Self(Kind::Latest(latest))
    }
}

/// The reading thread's handle of the newest frame.
struct Reading(Weak<LatestFrame>);

impl Reading {
    fn end(&self, end: Result<()>) {
        if let Some(latest) = self.0.upgrade() {
            latest.end(end);
        }
    }
}

impl Drop for Reading {
    fn drop(&mut self) {
        // Otherwise a thread that waits for a frame would wait forever.
        if thread::panicking() {
            self.end(Err(Error::io("frame source", std::io::Error::other("its thread panicked"))));
        }
    }
}

/// Sleeps until this many seconds after the start.
fn wait_until(begin: Instant, after_s: f64) -> Instant {
    let after = Duration::try_from_secs_f64(after_s.max(0.0)).unwrap_or(LONGEST_WAIT).min(LONGEST_WAIT);
    let due = begin.checked_add(after).unwrap_or(begin);
    thread::sleep(due.saturating_duration_since(Instant::now()));
    due
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::live::FrameRate;
    use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};

    /// Gives a frame per message, fails or panics at a message that says so, and reports when it is dropped.
    struct Fed(Receiver<&'static str>, #[allow(dead_code, reason = "dropped with it")] Sender<()>);

    impl FrameSource for Fed {
        fn next_frame(&mut self, _: &mut Image) -> Result<bool> {
            match self.0.recv() {
                Ok("fail") => Err(Error::Ticket { ticket: 1 }),
                Ok("panic") => panic!("as it was told"),
                Ok(_) => Ok(true),
                Err(_) => Ok(false),
            }
        }
    }

    fn fed() -> (Sender<&'static str>, Receiver<()>, TimedFrames<Fed>) {
        let ((feed, fed), (alive, dropped)) = (channel(), channel());
        let times = FrameTimes::even(FrameRate::DEFAULT, 1.0);
        (feed, dropped, TimedFrames::new(Fed(fed, alive), times))
    }

    #[test]
    fn each_frame_comes_in_turn_with_its_time() {
        let (feed, _, frames) = fed();
        let (mut intake, mut frame) = (Intake::each(frames), TimedFrame::default());
        for number in 0..3 {
            feed.send("frame").unwrap();
            assert!(intake.next_frame(&mut frame).unwrap());
            assert_eq!((frame.number, frame.time_s), (number, 1.0 + number as f64 / 30.0));
        }
        drop(feed);
        assert!(!intake.next_frame(&mut frame).unwrap());
        assert_eq!(intake.dropped(), 0);
    }

    #[test]
    fn the_thread_tells_how_its_source_ends() {
        for (last, error) in [("fail", Some("ticket")), ("panic", Some("io")), ("end", None)] {
            let (feed, _, frames) = fed();
            let mut intake = Intake::latest(frames, &TimedFrame::default(), Pace::Source);
            let mut frame = TimedFrame::default();
            feed.send("frame").unwrap();
            assert!(intake.next_frame(&mut frame).unwrap());
            if last != "end" {
                feed.send(last).unwrap();
            }
            drop(feed);
            match error {
                Some(code) => assert_eq!(intake.next_frame(&mut frame).unwrap_err().code(), code),
                None => assert!(!intake.next_frame(&mut frame).unwrap()),
            }
        }
    }

    #[test]
    fn the_thread_ends_after_the_intake() {
        let (feed, dropped, frames) = fed();
        drop(Intake::latest(frames, &TimedFrame::default(), Pace::Source));
        feed.send("frame").unwrap();
        // The source is dropped although it has not ended.
        assert_eq!(dropped.recv_timeout(Duration::from_secs(60)), Err(RecvTimeoutError::Disconnected));
        drop(feed);
    }

    #[test]
    fn what_is_due_in_the_past_is_not_waited_for() {
        let begin = Instant::now();
        for after_s in [-1.0, f64::NAN, 0.0] {
            assert_eq!(wait_until(begin, after_s), begin);
        }
    }
}
