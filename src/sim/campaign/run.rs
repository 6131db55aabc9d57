use std::num::NonZero;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{self, Sender};
use std::thread;

use rayon::ThreadPoolBuilder;

use super::{Ended, Job, JobResult};
use crate::backend::Backend;
use crate::error::{Error, Result};
use crate::sim::flight::{FlightConfig, Sensor};

/// Opens the backends that render the images and compute the flow.
pub type Open<'a> = dyn Fn() -> Result<[Backend; 2]> + Sync + 'a;

/// Flies jobs, up to `at_a_time` concurrently, and passes each result to `done` as soon as it is known, in the order of
/// completion. A failed job is a result too.
///
/// The cores are divided among the flights: a step of a small image on all cores would wait for the slowest longer
/// than it computes.
///
/// # Errors
/// The error of `done`, after which no further job starts; [`Error::Io`] if threads cannot be started.
pub fn fly_all(
    jobs: &[Job],
    base: &FlightConfig,
    at_a_time: NonZero<usize>,
    open: &Open<'_>,
    mut done: impl FnMut(JobResult) -> Result<()>,
) -> Result<()> {
    let at_a_time = at_a_time.get().min(jobs.len());
    let cores = thread::available_parallelism().map_or(1, NonZero::get);
    let next = AtomicUsize::new(0);
    thread::scope(|scope| {
        let (sender, results) = mpsc::channel();
        for _ in 0..at_a_time {
            let share = cores.div_ceil(at_a_time);
            let worker = Worker { jobs, base, open, next: &next, opened: None };
            let sender: Sender<JobResult> = sender.clone();
            let pool = ThreadPoolBuilder::new().num_threads(share).build();
            let pool = pool.map_err(|error| Error::io("threads", std::io::Error::other(error)))?;
            scope.spawn(move || worker.work(&pool, &sender));
        }
        drop(sender);
        let ended = results.into_iter().try_for_each(&mut done);
        // After an error the results are discarded; running flights end first.
        next.store(jobs.len(), Ordering::Relaxed);
        ended
    })
}

/// Flies jobs one after the other.
struct Worker<'a> {
    jobs: &'a [Job],
    base: &'a FlightConfig,
    open: &'a Open<'a>,
    next: &'a AtomicUsize,
    /// The backends, kept from flight to flight, as opening a device is slow.
    opened: Option<[Backend; 2]>,
}

impl Worker<'_> {
    fn work(mut self, pool: &rayon::ThreadPool, results: &Sender<JobResult>) {
        while let Some(job) = self.jobs.get(self.next.fetch_add(1, Ordering::Relaxed)) {
            let result = pool.install(|| self.fly(job));
            if results.send(result).is_err() {
                return;
            }
        }
    }

    fn fly(&mut self, job: &Job) -> JobResult {
        let pictures = job.setting.sensor == Sensor::Images;
        let opened = match &self.opened {
            _ if !pictures => Ok([Backend::Cpu, Backend::Cpu]),
            Some(opened) => Ok(opened.clone()),
            None => (self.open)(),
        };
        let (adapter, flown) = match opened {
            Ok(opened) => {
                let adapter = pictures.then(|| opened[1].name());
                let flown = job.fly(opened.clone(), self.base);
                // The next flight must not inherit a faulty device.
                let sound = flown.is_ok() && !job.setting.faults.destroy();
                if pictures {
                    self.opened = Some(opened).filter(|_| sound);
                }
                (adapter, flown)
            }
            Err(error) => (None, Err(error)),
        };
        let ended = match flown {
            Ok(summary) => Ended::Flown(summary),
            Err(error) => Ended::Failed(error.to_string()),
        };
        JobResult { job: job.clone(), adapter, ended }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::super::{Campaign, Faults};
    use super::*;
    use crate::frame::Size;
    use crate::sim::flight::Body;
    use crate::sim::vehicle::TurnParams;
    use crate::steer::{Danger, Policy};

    /// A wall that is reached soon, and passed soon.
    fn campaign(sensor: Sensor) -> Campaign {
        Campaign {
            base: FlightConfig { body: Body::Turn(TurnParams::default()), ..FlightConfig::default() },
            worlds: vec!["wall:distance=40:width=20:past=5".parse().unwrap()],
            sensors: vec![sensor],
            policies: vec![Policy::None],
            dangers: vec![Danger::Nearness],
            speeds_m_s: vec![12.0],
            sizes: vec![Size::new(96, 72)],
            latencies_frames: vec![1],
            faults: vec![Faults::default()],
            seeds: 0..5,
        }
    }

    fn flown(campaign: &Campaign, at_a_time: usize, open: &Open<'_>) -> Vec<JobResult> {
        let mut results = Vec::new();
        let at_a_time = NonZero::new(at_a_time).unwrap();
        let add = |result| {
            results.push(result);
            Ok(())
        };
        fly_all(&campaign.jobs(), &campaign.base, at_a_time, open, add).unwrap();
        results.sort_by(|a, b| a.job.order(&b.job));
        results
    }

    #[test]
    fn every_job_is_flown_once_however_many_at_a_time() {
        let campaign = campaign(Sensor::Depth);
        let never = || panic!("flights without images need no backend");
        let one = flown(&campaign, 1, &never);
        assert_eq!(one.iter().map(|result| result.job.clone()).collect::<Vec<_>>(), campaign.jobs());
        assert!(one.iter().all(|result| matches!(result.ended, Ended::Flown(_)) && result.adapter.is_none()));
        assert_eq!(flown(&campaign, 9, &never), one);
    }

    #[test]
    fn what_fails_is_a_result_with_its_reason() {
        let none = || Err(Error::NoAdapter { reason: "it is switched off".to_owned() });
        let results = flown(&campaign(Sensor::Images), 2, &none);
        assert_eq!(results.len(), 5);
        let why = Ended::Failed("no usable GPU adapter: it is switched off".to_owned());
        assert!(results.iter().all(|result| result.ended == why), "{results:?}");
    }

    #[test]
    fn no_job_is_begun_after_a_result_could_not_be_kept() {
        let campaign = Campaign { seeds: 0..1000, ..campaign(Sensor::Depth) };
        let mut kept = 0;
        let full = |_| {
            kept += 1;
            Err(Error::parameter("disk", "full", "room"))
        };
        let open = || Ok([Backend::Cpu, Backend::Cpu]);
        let error = fly_all(&campaign.jobs(), &campaign.base, NonZero::new(2).unwrap(), &open, full);
        assert_eq!(error.unwrap_err().to_string(), "disk is full, expected room");
        assert_eq!(kept, 1);
    }
}
