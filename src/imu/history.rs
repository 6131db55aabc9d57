//! The recent samples, in the order of time, and the faults between them.

use std::collections::VecDeque;

use glam::DVec3;

use super::GyroFault;

/// A sample in the camera's clock, with the bias subtracted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub(super) time_s: f64,
    pub(super) rate_rad_s: DVec3,
    /// The fault between the previous entry and this one.
    before: Option<GyroFault>,
}

/// A bounded queue of entries with rising times.
#[derive(Clone, Debug)]
pub(super) struct History {
    entries: VecDeque<Entry>,
    capacity: usize,
    max_gap_s: f64,
    /// The fault after the newest entry.
    pending: Option<GyroFault>,
    /// A sample that ran backwards: if the next one continues from it, the clock was set.
    stray: Option<(f64, DVec3)>,
}

impl History {
    pub(super) fn new(capacity: usize, max_gap_s: f64) -> Self {
        Self { entries: VecDeque::with_capacity(capacity), capacity, max_gap_s, pending: None, stray: None }
    }

    pub(super) fn push(&mut self, time_s: f64, rate_rad_s: DVec3) {
        let last = self.entries.back().copied();
        if !(time_s.is_finite() && rate_rad_s.is_finite()) {
            let near = if time_s.is_finite() { time_s } else { last.map_or(f64::NAN, |last| last.time_s) };
            self.pending.get_or_insert(GyroFault::NotANumber { time_s: near });
            self.stray = None;
            return;
        }
        match last {
            Some(last) if last.time_s == time_s && last.rate_rad_s == rate_rad_s => {}
            Some(last) if !(time_s > last.time_s) => self.push_backwards(time_s, rate_rad_s, last.time_s),
            _ => self.append(time_s, rate_rad_s),
        }
    }

    fn push_backwards(&mut self, time_s: f64, rate_rad_s: DVec3, after_s: f64) {
        let fault = GyroFault::Backwards { time_s, after_s };
        match self.stray {
            // Two in a row on another clock: the clock was set back, or one sample had been far ahead. Small steps
            // back need no such treatment, as time makes up for them within a gap.
            Some((stray_s, rate)) if self.follows(stray_s, time_s) && !self.follows(stray_s, after_s) => {
                while self.entries.back().is_some_and(|entry| entry.time_s >= stray_s) {
                    self.entries.pop_back();
                }
                self.pending = Some(fault);
                self.append(stray_s, rate);
                self.append(time_s, rate_rad_s);
            }
            _ => {
                // Either of the two samples may have the wrong time.
                if let Some(last) = self.entries.back_mut() {
                    last.before.get_or_insert(fault);
                }
                self.pending.get_or_insert(fault);
                self.stray = Some((time_s, rate_rad_s));
            }
        }
    }

    /// Whether the second time follows the first one without a gap.
    fn follows(&self, first_s: f64, second_s: f64) -> bool {
        second_s > first_s && second_s - first_s <= self.max_gap_s
    }

    fn append(&mut self, time_s: f64, rate_rad_s: DVec3) {
        if self.entries.len() >= self.capacity {
            self.entries.pop_front();
        }
        self.entries.push_back(Entry { time_s, rate_rad_s, before: self.pending.take() });
        self.stray = None;
    }

    /// The pairs of neighbouring entries that the interval touches.
    pub(super) fn pairs(
        &self,
        from_s: f64,
        to_s: f64,
    ) -> Result<impl Iterator<Item = [Entry; 2]> + '_, GyroFault> {
        let (Some(first), Some(last)) = (self.entries.front(), self.entries.back()) else {
            return Err(self.pending.unwrap_or(GyroFault::Empty));
        };
        if !(first.time_s <= from_s && to_s <= last.time_s) {
            let (first_s, last_s) = (first.time_s, last.time_s);
            let late = if to_s > last_s { self.pending } else { None };
            return Err(late.unwrap_or(GyroFault::NotCovered { from_s, to_s, first_s, last_s }));
        }
        let begin = self.entries.partition_point(|entry| entry.time_s <= from_s) - 1;
        let end = self.entries.partition_point(|entry| entry.time_s < to_s).max(begin);
        let pairs = (begin..end).map(|i| [self.entries[i], self.entries[i + 1]]);
        for [a, b] in pairs.clone() {
            if let Some(fault) = b.before {
                return Err(fault);
            }
            if !(b.time_s - a.time_s <= self.max_gap_s) {
                return Err(GyroFault::Gap { from_s: a.time_s, to_s: b.time_s, limit_s: self.max_gap_s });
            }
        }
        Ok(pairs)
    }
}
