//! The processor time of this process.

use std::fs;
use std::thread;
use std::time::Duration;

/// The time for which this process's threads have run so far, in nanoseconds.
#[derive(Clone, Copy, Debug)]
pub(super) struct ProcessorTime(u64);

impl ProcessorTime {
    /// The time so far, from Linux's `/proc/self/task/*/schedstat`, whose first number is a thread's time on a processor.
    /// `None` where there are no such files. Threads that end leave the sum, so the threads must be the same at both ends
    /// of a measurement.
    pub(super) fn now() -> Option<Self> {
        // The kernel brings a running thread's time up to date when it stops.
        thread::sleep(Duration::from_micros(1));
        let nanoseconds = |thread: fs::DirEntry| -> Option<u64> {
            let text = fs::read_to_string(thread.path().join("schedstat")).ok()?;
            text.split_whitespace().next()?.parse().ok()
        };
        // A thread that ends meanwhile has no file any more.
        let times: Vec<u64> =
            fs::read_dir("/proc/self/task").ok()?.flatten().filter_map(nanoseconds).collect();
        (!times.is_empty()).then(|| Self(times.iter().sum()))
    }

    /// The time from an earlier moment on, in milliseconds.
    pub(super) fn ms_since(self, earlier: Self) -> f64 {
        self.0.saturating_sub(earlier.0) as f64 * 1e-6
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use std::time::Instant;

    use super::*;

    #[test]
    fn work_takes_processor_time_and_sleep_takes_none() {
        let Some(start) = ProcessorTime::now() else { return };
        let clock = Instant::now();
        let mut sum = 0_u64;
        while clock.elapsed().as_millis() < 60 {
            sum = std::hint::black_box(sum.wrapping_add(1));
        }
        let Some(end) = ProcessorTime::now() else { panic!("there was one before") };
        // On a loaded machine this thread runs for a part of the time; a clock tick of 10 ms may be missing.
        assert!(end.ms_since(start) > 2.0, "{}", end.ms_since(start));
    }
}
