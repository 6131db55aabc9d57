//! The schedule: which frame is computed, waited for, dropped or handed over, and when.

use std::time::{Duration, Instant};

use super::in_flight::{self, InFlight, Last, State};
use super::{Done, Stream, Ticket};
use crate::error::{Error, Result};
use crate::plan::Given;

/// A finished frame whose outputs are still in its slot.
pub(super) struct Taken<P> {
    frame: u64,
    payload: P,
    previous: u64,
    slot: usize,
    pair: bool,
    latency: Duration,
}

impl<P> Stream<P> {
    /// The number of frames that may be computed concurrently. If the oldest may be dropped, one is held back to be
    /// dropped.
    fn room(&self) -> usize {
        match self.worker.is_gpu() {
            true => self.config.in_flight - usize::from(self.config.drop_oldest),
            false => 1,
        }
    }

    pub(super) fn enqueue(&mut self, given: &[Given<'_>], payload: P) -> Result<Ticket> {
        self.worker.check()?;
        self.refresh()?;
        let slot = match self.flights.free() {
            Some(slot) => slot,
            None => {
                self.make_room()?;
                self.flights.free().ok_or_else(|| self.busy())?
            }
        };
        let replaces = match self.worker.fill(&self.plan, slot, given) {
            Ok(replaces) => replaces,
            Err(error) => {
                self.flights.put_back(slot);
                return Err(error);
            }
        };
        let submitted = Instant::now();
        self.flights.list.push_back(InFlight {
            frame: self.next,
            epoch: self.epoch,
            slot,
            submitted,
            due: in_flight::due(submitted, self.config.deadline),
            replaces,
            payload,
            state: State::Waiting,
            previous: self.next,
            before: None,
            given_up: false,
        });
        let ticket = Ticket { stream: self.id, frame: self.next };
        self.next += 1;
        self.refresh()?;
        self.stats.submitted += 1;
        Ok(ticket)
    }

    fn busy(&self) -> Error {
        Error::Busy { in_flight: self.flights.list.len(), limit: self.config.in_flight }
    }

    fn make_room(&mut self) -> Result<()> {
        let oldest = self.flights.oldest_waiting().filter(|_| self.config.drop_oldest);
        let Some(entry) = oldest.and_then(|place| self.flights.remove(place)) else {
            return Err(self.busy());
        };
        if let State::Done(_) = entry.state {
            self.worker.release(entry.slot);
        }
        self.stats.dropped += 1;
        Ok(())
    }

    /// On the GPU, marks finished frames as done and starts waiting ones. On the CPU the waiting calls do both.
    fn refresh(&mut self) -> Result<()> {
        if !self.worker.is_gpu() {
            return Ok(());
        }
        while let Some((place, slot, job)) = self.flights.started() {
            if !self.worker.advance(&self.plan, slot, job, Some(Instant::now()))? {
                break;
            }
            self.mark_done(place);
        }
        self.start_waiting()
    }

    fn mark_done(&mut self, place: usize) {
        let entry = &mut self.flights.list[place];
        if let State::Started(job) = entry.state {
            entry.state = State::Done(job);
        }
        if entry.given_up {
            self.worker.release(entry.slot);
            self.flights.remove(place);
        }
    }

    fn start_waiting(&mut self) -> Result<()> {
        let room = self.room();
        while let Some(entry) = self.flights.startable(room) {
            let job = entry.job(self.last);
            self.worker.start(&self.plan, entry.slot, job)?;
            entry.state = State::Started(job);
            entry.before = self.last;
            entry.previous = self.last.map_or(entry.frame, |last| last.frame);
            let (frame, epoch) = (entry.frame, entry.epoch);
            self.last = Some(Last { frame, epoch, parity: job.parity, carried: job.pair });
        }
        Ok(())
    }

    /// Checks that a ticket belongs to a frame in flight.
    pub(super) fn find(&self, ticket: Ticket) -> Result<()> {
        if ticket.stream == self.id && self.flights.place(ticket.frame).is_some() {
            return Ok(());
        }
        let lost = self.lost_frame(ticket.frame).filter(|_| ticket.stream == self.id);
        self.worker.check()?;
        Err(lost.unwrap_or(Error::Ticket { ticket: ticket.frame }))
    }

    /// Computes or waits until a frame is done or the deadline has passed. Returns true if it is done.
    pub(super) fn bring(&mut self, frame: u64, wait: bool, until: Option<Instant>) -> Result<bool> {
        loop {
            // The wait itself finds what is done.
            if !wait {
                self.refresh()?;
            }
            let done = |entry: &InFlight<P>| entry.frame == frame && matches!(entry.state, State::Done(_));
            let done = self.flights.list.iter().any(done);
            // On the CPU the next frame can wait, and be dropped.
            if !done || self.worker.is_gpu() {
                self.start_waiting()?;
            }
            if done {
                return Ok(true);
            }
            let Some((place, slot, job)) = self.flights.started() else {
                return Ok(false);
            };
            if !wait && self.worker.is_gpu() {
                return Ok(false);
            }
            if self.worker.advance(&self.plan, slot, job, until)? {
                self.mark_done(place);
            } else if until.is_some_and(|until| Instant::now() >= until) {
                return Ok(false);
            }
        }
    }

    pub(super) fn take(&mut self, ticket: Ticket) -> Result<Taken<P>> {
        let found = self.find(ticket);
        self.lost.retain(|frame| *frame != ticket.frame || ticket.stream != self.id);
        found?;
        let due = self.flights.place(ticket.frame).and_then(|place| self.flights.list[place].due);
        let done = self.bring(ticket.frame, true, due);
        let taken = done.and_then(|_| self.hand_over(ticket));
        let taken = self.recovered(taken);
        // The frame in hand reports the loss at once.
        self.lost.retain(|frame| *frame != ticket.frame);
        taken
    }

    fn hand_over(&mut self, ticket: Ticket) -> Result<Taken<P>> {
        let gone = Error::Ticket { ticket: ticket.frame };
        let Some(place) = self.flights.place(ticket.frame) else { return Err(gone) };
        let entry = &mut self.flights.list[place];
        let waited = entry.submitted.elapsed();
        let State::Done(job) = entry.state else {
            entry.due = in_flight::due(Instant::now(), self.config.deadline);
            return Err(self.late(ticket.frame, waited));
        };
        self.worker.take(&self.plan, entry.slot, job)?;
        let Some(entry) = self.flights.remove(place) else { return Err(gone) };
        let InFlight { slot, previous, submitted, payload, .. } = entry;
        self.stats.done += 1;
        let latency = submitted.elapsed();
        if job.pair {
            self.window.add(latency);
        }
        Ok(Taken { frame: ticket.frame, payload, previous, slot, pair: job.pair, latency })
    }

    /// Waits for a frame without taking it. A frame that misses its deadline is given up and counted as dropped.
    ///
    /// # Errors
    /// As [`Stream::wait`].
    pub fn finish(&mut self, ticket: Ticket) -> Result<()> {
        self.find(ticket)?;
        let entry = self.flights.place(ticket.frame).map(|place| &self.flights.list[place]);
        let (due, submitted) = entry.map_or((None, Instant::now()), |entry| (entry.due, entry.submitted));
        let done = self.bring(ticket.frame, true, due);
        if self.recovered(done)? {
            return Ok(());
        }
        self.give_up(ticket.frame);
        Err(self.late(ticket.frame, submitted.elapsed()))
    }

    fn late(&mut self, frame: u64, waited: Duration) -> Error {
        self.stats.timeouts += 1;
        let ms = |time: Duration| u64::try_from(time.as_millis()).unwrap_or(u64::MAX);
        let deadline_ms = self.config.deadline.map_or(u64::MAX, ms);
        Error::Timeout { frame, waited_ms: ms(waited), deadline_ms }
    }

    /// Gives up a frame that has missed its deadline.
    pub(super) fn give_up(&mut self, frame: u64) {
        let Some(place) = self.flights.place(frame) else { return };
        self.stats.dropped += 1;
        let entry = &mut self.flights.list[place];
        if let State::Started(job) = entry.state {
            if self.worker.is_gpu() {
                // A submission cannot be cancelled. The frame stays a part of the stream, and its slot is freed when it
                // is done.
                entry.given_up = true;
                return;
            }
            // The next frame takes the same parity. The host's inputs may have replaced the values that it would find
            // there.
            self.last = entry.before.map(|last| Last { carried: last.carried && !job.replaced, ..last });
        }
        self.flights.remove(place);
    }

    pub(super) fn handed(&self, taken: Taken<P>) -> Done<'_, P> {
        let Taken { frame, payload, previous, slot, pair, latency } = taken;
        let outputs = self.worker.outputs(slot).filter(|_| pair);
        Done { frame, payload, previous: pair.then_some(previous), outputs, latency }
    }
}
