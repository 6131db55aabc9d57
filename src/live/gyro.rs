use crate::imu::GyroSample;

/// A gyro's log, delivered in its own order and not before its time, as by a live gyro.
#[derive(Clone, Debug)]
pub struct GyroFeed {
    samples: Vec<GyroSample>,
    offset_s: f64,
    next: usize,
    /// The arrival time of the last delivered sample.
    reached_s: f64,
}

impl GyroFeed {
    /// Creates a feed of samples in the order of their arrival. `offset_s` is added to their times to get the frames'
    /// time, as in [`GyroConfig::time_offset_s`](crate::imu::GyroConfig::time_offset_s).
    pub fn new(samples: Vec<GyroSample>, offset_s: f64) -> Self {
        Self { samples, offset_s, next: 0, reached_s: f64::NEG_INFINITY }
    }

    /// The samples up to a frame's time and one after it, without those that were delivered before. They determine the
    /// rotation until that frame.
    ///
    /// Samples that are not finite, or out of order, are delivered, too: the pipeline's gyro finds which frames they
    /// affect.
    pub fn until(&mut self, time_s: f64) -> &[GyroSample] {
        let begin = self.next;
        while let Some(sample) = self.samples.get(self.next).filter(|_| !(self.reached_s > time_s)) {
            if let Some(arrival_s) = self.arrival_s(self.next).filter(|_| is_finite(sample)) {
                self.reached_s = arrival_s;
            }
            self.next += 1;
        }
        &self.samples[begin..self.next]
    }

    /// The arrival time of a sample, in the frames' time. It may differ from the sample's own time: a single outlier
    /// must not hold up the samples behind it, so it is the median of the sample's time and its neighbours' (the
    /// earlier of two).
    fn arrival_s(&self, at: usize) -> Option<f64> {
        let around = at.saturating_sub(1)..(at + 2).min(self.samples.len());
        let mut times: Vec<f64> =
            self.samples[around].iter().map(|sample| sample.time_s).filter(|time| time.is_finite()).collect();
        times.sort_by(f64::total_cmp);
        times.get(times.len().saturating_sub(1) / 2).map(|time| time + self.offset_s)
    }
}

fn is_finite(sample: &GyroSample) -> bool {
    sample.time_s.is_finite() && sample.gyro_rad_s.is_finite()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn feed(times_s: &[f64], offset_s: f64) -> GyroFeed {
        let sample = |&time_s: &f64| GyroSample { time_s, gyro_rad_s: DVec3::ZERO };
        GyroFeed::new(times_s.iter().map(sample).collect(), offset_s)
    }

    #[test]
    fn samples_come_up_to_one_after_the_frame_and_once() {
        let mut feed = feed(&[0.0, 0.1, 0.2, 0.3], 1.0);
        let mut times = |until_s: f64| -> Vec<f64> { feed.until(until_s).iter().map(|s| s.time_s).collect() };
        // A sample's arrival time is the median of itself and its neighbours, so the last one gets the time of the
        // previous one.
        assert_eq!(times(1.05), [0.0, 0.1]);
        assert!(times(1.05).is_empty());
        assert_eq!(times(1.1), [0.2]);
        assert_eq!(times(9.0), [0.3]);
        assert!(times(9.0).is_empty());
    }

    #[test]
    fn a_wild_time_holds_up_nothing_behind_it() {
        let feed = feed(&[0.0, 0.1, 1e9, 0.3, f64::NAN, 0.5], 10.0);
        let arrivals: Vec<f64> = (0..6).map(|at| feed.arrival_s(at).unwrap()).collect();
        assert!(arrivals.iter().all(|time| (10.0..=10.5).contains(time)), "{arrivals:?}");
    }
}
