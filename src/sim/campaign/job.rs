use std::cmp::Ordering;
use std::fmt;

use super::Faults;
use crate::backend::Backend;
use crate::error::Result;
use crate::frame::Size;
use crate::sim::CourseKind;
use crate::sim::flight::{Flight, FlightConfig, Sensor, Summary, camera};
use crate::steer::{Danger, Policy, SteerParams};

/// What distinguishes the flights of a campaign but for their seeds: a row of its table.
///
/// As text the fields in their order with `/` between them: `forest/images/arc/nearness/12/320x240/1/none`.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// The world's generator.
    pub world: CourseKind,
    /// What is steered by.
    pub sensor: Sensor,
    /// How a command is found.
    pub policy: Policy,
    /// What counts as near.
    pub danger: Danger,
    /// Airspeed, m/s.
    pub speed_m_s: f64,
    /// Size of the pictures, in pixels.
    pub size: Size,
    /// Frames from an exposure until its command acts.
    pub latency_frames: u32,
    /// What goes wrong.
    pub faults: Faults,
}

/// A flight of a campaign.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// How it is flown.
    pub setting: Setting,
    /// Through which world of its kind.
    pub seed: u64,
}

impl Setting {
    /// The order of a table's rows: by world, then from what is known exactly to what a camera gives, then from the simplest
    /// policy on.
    pub fn order(&self, other: &Self) -> Ordering {
        let world = |setting: &Self| setting.world.to_string();
        let rest = |s: &Self| (s.size.width, s.size.height, s.latency_frames, s.faults.to_string());
        world(self)
            .cmp(&world(other))
            .then((self.sensor as u8).cmp(&(other.sensor as u8)))
            .then((self.policy as u8).cmp(&(other.policy as u8)))
            .then((self.danger as u8).cmp(&(other.danger as u8)))
            .then(self.speed_m_s.total_cmp(&other.speed_m_s))
            .then_with(|| rest(self).cmp(&rest(other)))
    }

    /// The size as `320x240`: in letters that any program reads.
    pub fn size_text(&self) -> String {
        format!("{}x{}", self.size.width, self.size.height)
    }

    /// How it is flown, where the rest is as in `base`.
    pub fn config(&self, base: &FlightConfig) -> FlightConfig {
        FlightConfig {
            sensor: self.sensor,
            steer: SteerParams { policy: self.policy, danger: self.danger, ..base.steer.clone() },
            speed_m_s: self.speed_m_s,
            camera: camera(self.size),
            latency_frames: self.latency_frames,
            faults: self.faults.0.clone(),
            ..base.clone()
        }
    }
}

impl Job {
    /// What tells it from all other jobs: the setting and the seed.
    pub fn key(&self) -> String {
        format!("{}/{}", self.setting, self.seed)
    }

    /// The order of jobs: that of their settings, then that of their seeds.
    pub fn order(&self, other: &Self) -> Ordering {
        self.setting.order(&other.setting).then(self.seed.cmp(&other.seed))
    }

    /// Flies it to the end. The first backend draws the pictures, the second one computes the flow.
    ///
    /// # Errors
    /// As [`CourseKind::course`], [`Flight::new`] and [`Flight::step`].
    pub fn fly(&self, backends: [Backend; 2], base: &FlightConfig) -> Result<Summary> {
        let course = self.setting.world.course(self.seed)?;
        Flight::new(backends, &course, &self.setting.config(base))?.fly(|_| Ok(()))
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { world, sensor, policy, danger, speed_m_s, latency_frames, faults, .. } = self;
        let size = self.size_text();
        write!(f, "{world}/{sensor}/{policy}/{danger}/{speed_m_s}/{size}/{latency_frames}/{faults}")
    }
}
