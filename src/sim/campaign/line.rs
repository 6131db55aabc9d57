//! A result as a line of JSON.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Deserializer, Serialize};
use serde_json::Value;

use super::{Ended, Job, JobResult, Setting};
use crate::error::{Error, Result};
use crate::journal::problem;
use crate::sim::flight::Summary;

/// A result as written: the setting's parts as text, and either the reason of a failure or an outcome and its
/// figures.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    world: String,
    sensor: String,
    policy: String,
    danger: String,
    speed_m_s: f64,
    size: String,
    latency_frames: u32,
    faults: String,
    seed: u64,
    adapter: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    flown: Option<FlownFigures>,
}

/// A [`Summary`].
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct FlownFigures {
    outcome: String,
    #[serde(deserialize_with = "number")]
    time_s: f64,
    #[serde(deserialize_with = "number")]
    progress_m: f64,
    #[serde(deserialize_with = "number")]
    length_m: f64,
    #[serde(deserialize_with = "number")]
    path_m: f64,
    shortest_m: Option<f64>,
    touches: u32,
    #[serde(deserialize_with = "number")]
    jerk_m_s2: f64,
    #[serde(deserialize_with = "number")]
    least_clearance_m: f64,
    #[serde(deserialize_with = "number")]
    low_clearance_m: f64,
    #[serde(deserialize_with = "number")]
    roll_rate_rad_s: f64,
    #[serde(deserialize_with = "number")]
    invalid: f64,
    offset_std_mean_m: Option<[f64; 2]>,
}

/// Reads a number; JSON represents NaN as `null`.
fn number<'de, D: Deserializer<'de>>(deserializer: D) -> std::result::Result<f64, D::Error> {
    Option::<f64>::deserialize(deserializer).map(|number| number.unwrap_or(f64::NAN))
}

impl JobResult {
    /// The result as one line of JSON, without its end.
    pub(super) fn as_line(&self) -> serde_json::Result<String> {
        serde_json::to_string(&self.line())
    }

    fn line(&self) -> Line {
        let setting = &self.job.setting;
        let Setting { world, sensor, policy, danger, speed_m_s, latency_frames, faults, .. } = setting;
        let (flown, error) = match &self.ended {
            Ended::Flown(summary) => (Some(FlownFigures::from(summary)), None),
            Ended::Failed(reason) => (None, Some(reason.clone())),
        };
        Line {
            world: world.to_string(),
            sensor: sensor.to_string(),
            policy: policy.to_string(),
            danger: danger.to_string(),
            speed_m_s: *speed_m_s,
            size: setting.size_text(),
            latency_frames: *latency_frames,
            faults: faults.to_string(),
            seed: self.job.seed,
            adapter: self.adapter.clone(),
            error,
            flown,
        }
    }

    /// The fields in which two results differ, with the values of each; `None` if they are the same.
    pub(super) fn contradictions(&self, other: &Self) -> serde_json::Result<Option<[String; 2]>> {
        let members = |result: &Self| -> serde_json::Result<BTreeMap<String, Value>> {
            let flown = serde_json::to_value(result.line())?;
            let figures = flown.get("flown").and_then(Value::as_object).cloned().unwrap_or_default();
            let all = flown.as_object().cloned().unwrap_or_default();
            Ok(all.into_iter().filter(|(name, _)| name != "flown").chain(figures).collect())
        };
        let both = [members(self)?, members(other)?];
        let names = || both.iter().flatten().map(|(name, _)| name).collect::<BTreeSet<_>>();
        let differ: Vec<&String> =
            names().into_iter().filter(|&name| both[0].get(name) != both[1].get(name)).collect();
        let told = |members: &BTreeMap<String, Value>| {
            let value = |name: &&String| format!("{name} {}", members.get(*name).unwrap_or(&Value::Null));
            differ.iter().map(value).collect::<Vec<_>>().join(", ")
        };
        Ok((!differ.is_empty()).then(|| both.each_ref().map(told)))
    }

    /// Parses the output of [`JobResult::as_line`]; an error is the reason.
    pub(super) fn parsed(text: &str) -> std::result::Result<Self, String> {
        let line: Line = serde_json::from_str(text).map_err(|error| problem(&error))?;
        line.result().map_err(|error| error.to_string())
    }
}

impl Line {
    fn result(self) -> Result<JobResult> {
        let setting = Setting {
            world: self.world.parse()?,
            sensor: self.sensor.parse()?,
            policy: self.policy.parse()?,
            danger: self.danger.parse()?,
            speed_m_s: self.speed_m_s,
            size: self.size.parse()?,
            latency_frames: self.latency_frames,
            faults: self.faults.parse()?,
        };
        let ended = match (self.flown, self.error) {
            (Some(figures), None) => Ended::Flown(figures.summary()?),
            (None, Some(reason)) => Ended::Failed(reason),
            _ => return Err(Error::parameter("result", "both or neither", "either flown or an error")),
        };
        Ok(JobResult { job: Job { setting, seed: self.seed }, adapter: self.adapter, ended })
    }
}

impl From<&Summary> for FlownFigures {
    fn from(summary: &Summary) -> Self {
        Self {
            outcome: summary.outcome.to_string(),
            time_s: summary.time_s,
            progress_m: summary.progress_m,
            length_m: summary.length_m,
            path_m: summary.path_m,
            shortest_m: summary.shortest_m,
            touches: summary.touches,
            jerk_m_s2: summary.jerk_m_s2,
            least_clearance_m: summary.least_clearance_m,
            low_clearance_m: summary.low_clearance_m,
            roll_rate_rad_s: summary.roll_rate_rad_s,
            invalid: summary.invalid,
            offset_std_mean_m: summary.offset_m,
        }
    }
}

impl FlownFigures {
    fn summary(&self) -> Result<Summary> {
        Ok(Summary {
            outcome: self.outcome.parse()?,
            time_s: self.time_s,
            progress_m: self.progress_m,
            length_m: self.length_m,
            path_m: self.path_m,
            shortest_m: self.shortest_m,
            touches: self.touches,
            jerk_m_s2: self.jerk_m_s2,
            least_clearance_m: self.least_clearance_m,
            low_clearance_m: self.low_clearance_m,
            roll_rate_rad_s: self.roll_rate_rad_s,
            invalid: self.invalid,
            offset_m: self.offset_std_mean_m,
            // The journal keeps no measurements of single flights.
            measured: None,
        })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::super::testing::{failed, flown};
    use super::*;
    use crate::sim::flight::Outcome;

    #[test]
    fn what_is_written_is_read_back_to_the_last_bit() {
        let mut random = crate::sim::Random::new(5);
        for seed in 0..200 {
            let mut result = flown("forest:density=1/64", seed, Outcome::Crashed, random.normal());
            if seed % 2 == 0 {
                result.adapter = Some("llvmpipe \"x\"".to_owned());
                result.job.setting.faults = "black:0.1..0.3+gyro-bias=5:2".parse().unwrap();
                let Ended::Flown(summary) = &mut result.ended else { unreachable!() };
                summary.offset_m = Some([random.normal() * 1e-9, random.normal() * 1e9]);
            }
            let line = result.as_line().unwrap();
            assert!(!line.contains('\n'), "{line}");
            assert_eq!(JobResult::parsed(&line).unwrap(), result, "{line}");
        }
        let result = failed("wall", 3);
        assert_eq!(JobResult::parsed(&result.as_line().unwrap()).unwrap(), result);
    }

    #[test]
    fn what_is_not_a_number_stays_so() {
        let line = flown("wall", 1, Outcome::Crashed, f64::NAN).as_line().unwrap();
        let back = JobResult::parsed(&line).unwrap();
        let Ended::Flown(summary) = &back.ended else { unreachable!() };
        assert!(summary.least_clearance_m.is_nan() && summary.time_s == 10.0);
        assert_eq!(back.as_line().unwrap(), line);
    }

    #[test]
    fn what_is_no_result_says_why() {
        let line = flown("wall", 1, Outcome::Reached, 1.0).as_line().unwrap();
        for (from, to, words) in [
            ("\"wall\"", "\"moon\"", "moon"),
            ("\"arc\"", "\"arch\"", "arch"),
            ("reached", "reacht", "reacht"),
            ("\"seed\":1", "\"seed\":-1", "-1"),
            ("\"seed\":1,", "", "seed"),
            ("\"seed\"", "\"more\":2,\"seed\"", "more"),
            ("\"flown\"", "\"error\":\"x\",\"flown\"", "both"),
        ] {
            let wrong = line.replacen(from, to, 1);
            assert_ne!(wrong, line);
            let error = JobResult::parsed(&wrong).unwrap_err();
            assert!(error.contains(words), "{error}");
        }
    }
}
