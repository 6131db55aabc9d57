//! The frames in flight: waiting, being computed, or done.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use super::job::Job;

/// A frame in flight.
pub(super) struct InFlight<P> {
    pub(super) frame: u64,
    /// Frames of different epochs are not paired.
    pub(super) epoch: u64,
    pub(super) slot: usize,
    pub(super) submitted: Instant,
    /// When [`Error::Timeout`](crate::Error::Timeout) is due.
    pub(super) due: Option<Instant>,
    /// Whether its inputs replace the values that the previous frame has left.
    pub(super) replaces: bool,
    /// The caller's payload.
    pub(super) payload: P,
    pub(super) state: State,
    /// The first frame of the pair; for a frame that still waits, this frame.
    pub(super) previous: u64,
    /// The last frame that was started before this one.
    pub(super) before: Option<Last>,
    /// It was given up: no one will wait for it.
    pub(super) given_up: bool,
}

/// The state of a frame.
#[derive(Clone, Copy)]
pub(super) enum State {
    Waiting,
    Started(Job),
    Done(Job),
}

/// The last frame whose computation was started.
#[derive(Clone, Copy)]
pub(super) struct Last {
    pub(super) frame: u64,
    pub(super) epoch: u64,
    pub(super) parity: usize,
    /// Whether the values that it leaves for the next frame are in the buffers.
    pub(super) carried: bool,
}

/// All frames in flight, oldest first, and the slots that are free.
pub(super) struct InFlightList<P> {
    pub(super) list: VecDeque<InFlight<P>>,
    free: Vec<usize>,
    slots: usize,
}

impl<P> InFlightList<P> {
    pub(super) fn new(slots: usize) -> Self {
        Self { list: VecDeque::with_capacity(slots), free: (0..slots).collect(), slots }
    }

    pub(super) fn clear(&mut self) {
        self.list.clear();
        self.free.clear();
        self.free.extend(0..self.slots);
    }

    pub(super) fn free(&mut self) -> Option<usize> {
        self.free.pop()
    }

    /// Frees a slot that no frame uses.
    pub(super) fn put_back(&mut self, slot: usize) {
        self.free.push(slot);
    }

    pub(super) fn place(&self, frame: u64) -> Option<usize> {
        self.list.iter().position(|entry| entry.frame == frame && !entry.given_up)
    }

    /// Removes a frame and frees its slot.
    pub(super) fn remove(&mut self, place: usize) -> Option<InFlight<P>> {
        let entry = self.list.remove(place)?;
        self.free.push(entry.slot);
        Some(entry)
    }

    /// The oldest frame that is being computed.
    pub(super) fn started(&self) -> Option<(usize, usize, Job)> {
        self.list.iter().enumerate().find_map(|(i, entry)| match entry.state {
            State::Started(job) => Some((i, entry.slot, job)),
            _ => None,
        })
    }

    /// The oldest frame that waits, if fewer than `limit` are being computed.
    pub(super) fn startable(&mut self, limit: usize) -> Option<&mut InFlight<P>> {
        let started = self.list.iter().filter(|entry| matches!(entry.state, State::Started(_))).count();
        if started >= limit {
            return None;
        }
        self.list.iter_mut().find(|entry| matches!(entry.state, State::Waiting))
    }

    /// The frame that is dropped for a newer one: the oldest that is done and not taken, or else the oldest that waits
    /// to be computed.
    pub(super) fn oldest_waiting(&self) -> Option<usize> {
        let done = self.list.iter().position(|entry| matches!(entry.state, State::Done(_)));
        done.or_else(|| self.list.iter().position(|entry| matches!(entry.state, State::Waiting)))
    }
}

impl<P> InFlight<P> {
    /// The computation of it after this frame.
    pub(super) fn job(&self, last: Option<Last>) -> Job {
        let previous = last.filter(|last| last.epoch == self.epoch);
        Job {
            parity: last.map_or(0, |last| 1 - last.parity),
            pair: previous.is_some(),
            carried: previous.is_some_and(|last| last.carried),
            replaced: self.replaces,
        }
    }
}

/// A frame's deadline; `None` if it is beyond the clock's range.
pub(super) fn due(from: Instant, deadline: Option<Duration>) -> Option<Instant> {
    from.checked_add(deadline?)
}
