use std::ops::Range;

use super::{Faults, Job, Setting};
use crate::backend::Backend;
use crate::error::{Error, Result};
use crate::frame::Size;
use crate::sim::CourseKind;
use crate::sim::flight::{FlightConfig, Sensor};
use crate::steer::{Danger, Policy};

/// The most flights of a campaign.
const MAX_JOBS: usize = 10_000_000;

/// A campaign: every combination of the lists' elements, each with every seed.
#[derive(Clone, Debug)]
pub struct Campaign {
    /// The configuration of everything that the lists do not state.
    pub base: FlightConfig,
    /// The worlds' generators.
    pub worlds: Vec<CourseKind>,
    /// What the vehicle steers by.
    pub sensors: Vec<Sensor>,
    /// The steering policies.
    pub policies: Vec<Policy>,
    /// The measures of danger.
    pub dangers: Vec<Danger>,
    /// Airspeeds, m/s.
    pub speeds_m_s: Vec<f64>,
    /// Image sizes, in pixels.
    pub sizes: Vec<Size>,
    /// Frames from an exposure until its command takes effect.
    pub latencies_frames: Vec<u32>,
    /// The faults of each flight.
    pub faults: Vec<Faults>,
    /// The seeds: the first inclusive, the last exclusive.
    pub seeds: Range<u64>,
}

impl Campaign {
    /// The distinct settings, in the order of the lists.
    pub fn settings(&self) -> Vec<Setting> {
        let mut all: Vec<Setting> = Vec::new();
        for &world in &self.worlds {
            for &sensor in &self.sensors {
                for &policy in &self.policies {
                    for &danger in &self.dangers {
                        for &speed_m_s in &self.speeds_m_s {
                            for &size in &self.sizes {
                                for &latency_frames in &self.latencies_frames {
                                    all.extend(self.faults.iter().map(|faults| Setting {
                                        world,
                                        sensor,
                                        policy,
                                        danger,
                                        speed_m_s,
                                        size,
                                        latency_frames,
                                        faults: faults.clone(),
                                    }));
                                }
                            }
                        }
                    }
                }
            }
        }
        let mut seen = std::collections::HashSet::new();
        all.retain(|setting| seen.insert(setting.to_string()));
        all
    }

    /// All jobs: the seeds of each setting one after the other, so that every `journal::Shard` has a part of each setting.
    pub fn jobs(&self) -> Vec<Job> {
        let seeds =
            |setting: Setting| self.seeds.clone().map(move |seed| Job { setting: setting.clone(), seed });
        self.settings().into_iter().flat_map(seeds).collect()
    }

    /// Checks that every setting can be flown, with its first seed at least. The backend is that of the flow.
    ///
    /// # Errors
    /// [`Error::Parameter`] if there are no flights or too many; as in [`FlightConfig::validate`],
    /// [`CourseKind::course`] and [`Faults::check`].
    pub fn validate(&self, flow: &Backend) -> Result<()> {
        let settings = self.settings();
        let seeds = usize::try_from(self.seeds.end.saturating_sub(self.seeds.start)).unwrap_or(usize::MAX);
        let jobs = settings.len().saturating_mul(seeds);
        if !(1..=MAX_JOBS).contains(&jobs) {
            return Err(Error::parameter("number of flights", jobs, format_args!("1 to {MAX_JOBS}")));
        }
        let first = self.worlds.iter().map(|world| Ok((world, world.course(self.seeds.start)?)));
        let courses = first.collect::<Result<Vec<_>>>()?;
        for setting in &settings {
            let config = setting.config(&self.base);
            config.validate()?;
            let course = courses.iter().find(|(world, _)| **world == setting.world);
            course.map_or(Ok(()), |(_, course)| config.check_faults_in(course))?;
            setting.faults.check(flow)?;
        }
        Ok(())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    #[cfg(all(feature = "io", feature = "serde"))]
    use crate::journal::Shard;

    fn campaign() -> Campaign {
        Campaign {
            base: FlightConfig::default(),
            worlds: vec!["wall".parse().unwrap(), "forest:density=1/64".parse().unwrap()],
            sensors: vec![Sensor::Depth, Sensor::Images],
            policies: vec![Policy::Arc, Policy::None],
            dangers: vec![Danger::Nearness],
            speeds_m_s: vec![8.0, 12.5],
            sizes: vec![Size::new(320, 240)],
            latencies_frames: vec![1],
            faults: vec![Faults::default(), "gyro-lost:2..3".parse().unwrap()],
            seeds: 3..10,
        }
    }

    fn keys(jobs: &[Job]) -> BTreeSet<String> {
        jobs.iter().map(Job::key).collect()
    }

    #[test]
    fn every_combination_is_a_job_with_its_own_key() {
        let all = campaign();
        all.validate(&Backend::Cpu).unwrap();
        let jobs = all.jobs();
        assert_eq!(jobs.len(), 2 * 2 * 2 * 2 * 2 * 7);
        let keys = keys(&jobs);
        assert_eq!(keys.len(), jobs.len());
        assert!(keys.contains("wall/depth/arc/nearness/8/320x240/1/none/3"), "{keys:?}");
        let last = "forest:density=0.015625/images/none/nearness/12.5/320x240/1/gyro-lost:2..3/9";
        assert!(keys.contains(last), "{keys:?}");
    }

    #[test]
    fn what_is_listed_twice_is_flown_once() {
        let once = campaign();
        let mut twice = once.clone();
        twice.worlds.push("forest:density=0.015625".parse().unwrap());
        twice.speeds_m_s.push(8.0);
        assert_eq!(twice.jobs(), once.jobs());
    }

    #[cfg(all(feature = "io", feature = "serde"))]
    #[test]
    fn shards_hold_every_job_once_and_every_setting() {
        let all = campaign().jobs();
        for of in [1, 2, 3, 7, 300] {
            let shards = (1..=of).map(|i| format!("{i}/{of}").parse::<Shard>().unwrap().part(all.clone()));
            let shards: Vec<Vec<Job>> = shards.collect();
            assert_eq!(shards.iter().map(Vec::len).sum::<usize>(), all.len());
            assert_eq!(keys(&shards.concat()), keys(&all));
            let settings =
                |jobs: &[Job]| jobs.iter().map(|job| job.setting.to_string()).collect::<BTreeSet<_>>();
            assert!(of > 7 || shards.iter().all(|shard| settings(shard).len() == 32));
        }
    }

    #[test]
    fn what_cannot_be_flown_is_refused_before() {
        let refused = |change: fn(&mut Campaign), words: &str| {
            let mut campaign = campaign();
            change(&mut campaign);
            let error = campaign.validate(&Backend::Cpu).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        };
        refused(|campaign| campaign.seeds = 5..5, "number of flights is 0");
        refused(|campaign| campaign.seeds = 0..u64::MAX, "number of flights");
        refused(|campaign| campaign.worlds.clear(), "number of flights is 0");
        refused(|campaign| campaign.speeds_m_s.push(f64::NAN), "speed_m_s");
        refused(|campaign| campaign.latencies_frames.push(31), "latency_frames");
        refused(|campaign| campaign.faults.push("black".parse().unwrap()), "black:0 with the sensor depth");
        let late = |campaign: &mut Campaign| campaign.faults.push("gyro-lost:1000".parse().unwrap());
        refused(late, "gyro-lost:1000 in wall, expected one that begins before the flight is given up, at ");
    }
}
