//! The frames in flight: which waits, which is being computed, which is done.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use super::job::Job;

/// A frame in flight.
pub(super) struct Flight<P> {
    pub(super) frame: u64,
    /// Frames of different epochs are not paired.
    pub(super) epoch: u64,
    pub(super) slot: usize,
    pub(super) submitted: Instant,
    /// When [`Error::Timeout`](crate::Error::Timeout) is due.
    pub(super) due: Option<Instant>,
    /// Whether what came with it replaces what the previous frame has left.
    pub(super) replaces: bool,
    /// What the caller keeps with it.
    pub(super) payload: P,
    pub(super) state: State,
    /// The first frame of the pair; of a frame that still waits, this one.
    pub(super) previous: u64,
    /// What was the last frame started before this one.
    pub(super) before: Option<Last>,
    /// Nobody will ask for it.
    pub(super) given_up: bool,
}

/// How far a frame is.
#[derive(Clone, Copy)]
pub(super) enum State {
    Waiting,
    Started(Job),
    Done(Job),
}

/// The last frame whose computing began.
#[derive(Clone, Copy)]
pub(super) struct Last {
    pub(super) frame: u64,
    pub(super) epoch: u64,
    pub(super) parity: usize,
    /// Whether what it leaves for the next frame stands in the buffers.
    pub(super) carried: bool,
}

/// All frames in flight, oldest first, and the slots that are free.
pub(super) struct Flights<P> {
    pub(super) list: VecDeque<Flight<P>>,
    free: Vec<usize>,
    slots: usize,
}

impl<P> Flights<P> {
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

    /// Frees a slot that no frame has come to.
    pub(super) fn put_back(&mut self, slot: usize) {
        self.free.push(slot);
    }

    pub(super) fn place(&self, frame: u64) -> Option<usize> {
        self.list.iter().position(|flight| flight.frame == frame && !flight.given_up)
    }

    /// Takes a frame out and frees its slot.
    pub(super) fn remove(&mut self, place: usize) -> Option<Flight<P>> {
        let flight = self.list.remove(place)?;
        self.free.push(flight.slot);
        Some(flight)
    }

    /// The oldest frame that is being computed.
    pub(super) fn started(&self) -> Option<(usize, usize, Job)> {
        self.list.iter().enumerate().find_map(|(i, flight)| match flight.state {
            State::Started(job) => Some((i, flight.slot, job)),
            _ => None,
        })
    }

    /// The oldest frame that waits, if fewer than `limit` are being computed.
    pub(super) fn startable(&mut self, limit: usize) -> Option<&mut Flight<P>> {
        let started = self.list.iter().filter(|flight| matches!(flight.state, State::Started(_))).count();
        if started >= limit {
            return None;
        }
        self.list.iter_mut().find(|flight| matches!(flight.state, State::Waiting))
    }

    /// The frame that is dropped for a newer one: the oldest that waits to be fetched, or else to be computed.
    pub(super) fn oldest_waiting(&self) -> Option<usize> {
        let done = self.list.iter().position(|flight| matches!(flight.state, State::Done(_)));
        done.or_else(|| self.list.iter().position(|flight| matches!(flight.state, State::Waiting)))
    }
}

impl<P> Flight<P> {
    /// What is to be computed of it after this frame.
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

/// When a frame is due; never, if that is beyond what the clock can tell.
pub(super) fn due(from: Instant, deadline: Option<Duration>) -> Option<Instant> {
    from.checked_add(deadline?)
}
