use std::cmp::Ordering;
use std::fmt;

use super::Faults;
use crate::backend::Backend;
use crate::error::Result;
use crate::frame::Size;
use crate::sim::CourseKind;
use crate::sim::flight::{Flight, FlightConfig, Sensor, Summary, resized};
use crate::steer::{Danger, Policy, SteerParams};

/// The setting of a flight: everything that distinguishes it but the seed. A row of the campaign's table.
///
/// As text, the fields in their order, separated by `/`: `forest/images/arc/nearness/12/320x240/1/none`.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// The world's generator.
    pub world: CourseKind,
    /// What the vehicle steers by.
    pub sensor: Sensor,
    /// The steering policy.
    pub policy: Policy,
    /// The measure of danger.
    pub danger: Danger,
    /// Airspeed, m/s.
    pub speed_m_s: f64,
    /// Image size, in pixels.
    pub size: Size,
    /// Frames from an exposure until its command takes effect.
    pub latency_frames: u32,
    /// The faults that occur.
    pub faults: Faults,
}

/// A flight of a campaign.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// The setting.
    pub setting: Setting,
    /// The world's seed.
    pub seed: u64,
}

/// The names of the parts of a [`Setting`], in the order of its text.
pub const PART_NAMES: [&str; 8] =
    ["world", "sensor", "policy", "danger", "speed_m_s", "size", "latency_frames", "faults"];

impl Setting {
    /// The parts as text, each with its name.
    pub fn parts(&self) -> [(&'static str, String); 8] {
        let Self { world, sensor, policy, danger, speed_m_s, latency_frames, faults, .. } = self;
        let values = [
            world.to_string(),
            sensor.to_string(),
            policy.to_string(),
            danger.to_string(),
            speed_m_s.to_string(),
            self.size_text(),
            latency_frames.to_string(),
            faults.to_string(),
        ];
        let mut names = PART_NAMES.into_iter();
        values.map(|value| (names.next().unwrap_or_default(), value))
    }

    /// The order of a table's rows: by world, then from exact to camera-based sensing, then from the simplest policy
    /// on.
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

    /// The size as `320x240`: in ASCII.
    pub fn size_text(&self) -> String {
        format!("{}x{}", self.size.width, self.size.height)
    }

    /// The flight's configuration: this setting, and `base` for everything else. The camera is that of `base` with another
    /// number of pixels.
    pub fn config(&self, base: &FlightConfig) -> FlightConfig {
        FlightConfig {
            sensor: self.sensor,
            steer: SteerParams { policy: self.policy, danger: self.danger, ..base.steer },
            speed_m_s: self.speed_m_s,
            camera: resized(&base.camera, self.size),
            latency_frames: self.latency_frames,
            faults: self.faults.0.clone(),
            ..base.clone()
        }
    }
}

impl Job {
    /// The job's unique key: the setting and the seed.
    pub fn key(&self) -> String {
        format!("{}/{}", self.setting, self.seed)
    }

    /// The order of jobs: by setting, then by seed.
    pub fn order(&self, other: &Self) -> Ordering {
        self.setting.order(&other.setting).then(self.seed.cmp(&other.seed))
    }

    /// Flies the job to its end. The first backend renders the images, the second one computes the flow.
    ///
    /// # Errors
    /// As in [`CourseKind::course`], [`Flight::new`] and [`Flight::step`].
    pub fn fly(&self, backends: [Backend; 2], base: &FlightConfig) -> Result<Summary> {
        let course = self.setting.world.course(self.seed)?;
        Flight::new(backends, &course, &self.setting.config(base))?.fly(|_| Ok(()))
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.parts().map(|(_, value)| value).join("/"))
    }
}
