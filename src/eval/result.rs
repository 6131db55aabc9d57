//! The result of an algorithm on a pair, as a journal keeps it.

use std::cmp::Ordering;

use serde::{Deserialize, Serialize};

use super::{Class, PairTime, Score};
use crate::flow::Algorithm;
use crate::journal::{Entry, problem};

/// What is to be evaluated: a run on a pair. As text the fields in their order, separated by `/`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Job {
    /// The data set's name.
    pub set: String,
    /// The pair's name.
    pub pair: String,
    /// The algorithm with its preset and parameters, as [`RunSpec::label`](super::RunSpec::label) names it.
    pub run: String,
    /// `cpu` or `gpu`.
    pub backend: String,
}

/// The result of a job.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PairResult {
    /// The job.
    pub job: Job,
    /// A digest of the pair's files, which tells whether a result is that of the same files; empty if they could not be
    /// read.
    pub input: String,
    /// What computed the flow.
    pub adapter: String,
    /// How it ended.
    pub ended: Ended,
}

/// How a job ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ended {
    /// The flow was computed and compared with the truth.
    Scored {
        /// The figures.
        score: Score,
        /// The time, if it was measured.
        time: Option<PairTime>,
    },
    /// It failed with this error.
    Failed(String),
}

impl Job {
    /// The unique key.
    pub fn key(&self) -> String {
        format!("{}/{}/{}/{}", self.set, self.pair, self.run, self.backend)
    }

    /// The order of jobs: by set and pair, then by [`Job::run_order`].
    pub fn order(&self, other: &Self) -> Ordering {
        (&self.set, &self.pair).cmp(&(&other.set, &other.pair)).then_with(|| self.run_order(other))
    }

    /// The order of runs in a table: by algorithm and preset, as they are listed in [`Algorithm`], then by parameters and
    /// backend.
    pub fn run_order(&self, other: &Self) -> Ordering {
        self.run_place().cmp(&other.run_place())
    }

    /// What decides its run's place in a table.
    fn run_place(&self) -> (usize, usize, &str, &str) {
        let mut parts = self.run.split(':');
        let (name, preset) = (parts.next().unwrap_or_default(), parts.next().unwrap_or_default());
        let at = |list: &[(&str, &str)], name: &str| list.iter().position(|(known, _)| *known == name);
        let presets = Algorithm::named(name, "default").map_or(&[][..], |algorithm| algorithm.presets());
        let rank = |at: Option<usize>| at.unwrap_or(usize::MAX);
        (rank(at(Algorithm::ALL, name)), rank(at(presets, preset)), &self.run, &self.backend)
    }
}

impl PairResult {
    /// The figures, unless it failed.
    pub fn score(&self) -> Option<&Score> {
        match &self.ended {
            Ended::Scored { score, .. } => Some(score),
            Ended::Failed(_) => None,
        }
    }

    /// Why it failed, if it did.
    pub fn failure(&self) -> Option<&str> {
        match &self.ended {
            Ended::Scored { .. } => None,
            Ended::Failed(reason) => Some(reason),
        }
    }

    /// The time, if it was measured.
    pub fn time(&self) -> Option<PairTime> {
        match self.ended {
            Ended::Scored { time, .. } => time,
            Ended::Failed(_) => None,
        }
    }
}

impl Entry for PairResult {
    fn key(&self) -> String {
        self.job.key()
    }

    fn is_failure(&self) -> bool {
        matches!(self.ended, Ended::Failed(_))
    }

    fn order(&self, other: &Self) -> Ordering {
        self.job.order(&other.job)
    }

    fn to_line(&self) -> serde_json::Result<String> {
        serde_json::to_string(self)
    }

    fn from_line(text: &str) -> Result<Self, String> {
        serde_json::from_str(text).map_err(|error| problem(&error))
    }

    /// Times differ from run to run, and so do the names of processors, on which all results are the same.
    fn differences(&self, other: &Self) -> serde_json::Result<Option<[String; 2]>> {
        let aee = |result: &Self| {
            let all = result.score().and_then(|score| score.class(Class::All));
            all.map_or_else(|| "none".to_owned(), |tally| format!("{} px", tally.error().aee_px))
        };
        let both = [self, other];
        let told = if self.input != other.input {
            both.map(|result| format!("input {}", result.input))
        } else if self.job.backend == "gpu" && self.adapter != other.adapter {
            both.map(|result| format!("adapter {}", result.adapter))
        } else if self.score() != other.score() {
            both.map(|result| format!("mean endpoint error {}", aee(result)))
        } else {
            return Ok(None);
        };
        Ok(Some(told))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
pub(crate) mod tests {
    use super::*;
    use crate::eval::{Classes, GroundTruth};
    use crate::frame::{FlowField, Frame, PixelFormat, Plane, Size};

    /// A result whose endpoint error is `error_px` everywhere, at a confidence of ½.
    pub(crate) fn result(set: &str, pair: &str, run: &str, error_px: f32) -> PairResult {
        let size = Size::new(4, 2);
        let field = |u: f32| FlowField { size, data: vec![[u, 0.0]; 8] };
        let truth = GroundTruth::from(field(1.0));
        let gray = [0; 8];
        let classes = Classes::new(&Frame::new(size, PixelFormat::Gray8, &gray).unwrap(), &truth).unwrap();
        let confidence = Plane { size, data: vec![0.5; 8] };
        let score = Score::new(&truth, &classes, &field(1.0 + error_px), Some(&confidence)).unwrap();
        let time = Some(PairTime { wall_ms: 4.0, processor_ms: Some(8.0) });
        let [set, pair, run] = [set, pair, run].map(str::to_owned);
        PairResult {
            job: Job { set, pair, run, backend: "cpu".to_owned() },
            input: "00".to_owned(),
            adapter: "CPU".to_owned(),
            ended: Ended::Scored { score, time },
        }
    }

    pub(crate) fn failed(set: &str, pair: &str, run: &str) -> PairResult {
        PairResult {
            ended: Ended::Failed("a.png: image is missing".to_owned()),
            ..result(set, pair, run, 1.0)
        }
    }

    #[test]
    fn what_is_written_is_read_back_to_the_last_bit() {
        for result in [result("mb", "Venus", "farneback:default", 1.0 / 3.0), failed("a/\"b\"", "c\n", "d")] {
            let line = result.to_line().unwrap();
            assert!(!line.contains('\n'), "{line}");
            assert_eq!(PairResult::from_line(&line).unwrap(), result);
        }
        let line = result("mb", "Venus", "farneback:default", 1.0).to_line().unwrap();
        for (from, to) in
            [("\"pair\"", "\"pear\""), ("\"scored\"", "\"scores\""), ("\"input\"", "\"more\":1,\"input\"")]
        {
            assert!(PairResult::from_line(&line.replacen(from, to, 1)).is_err(), "{from}");
        }
    }

    #[test]
    fn times_do_not_contradict_each_other_but_errors_do() {
        let one = result("mb", "Venus", "farneback:default", 1.0);
        let mut slower = one.clone();
        let Ended::Scored { time, .. } = &mut slower.ended else { unreachable!() };
        *time = None;
        assert_eq!(one.differences(&slower).unwrap(), None);
        let worse = result("mb", "Venus", "farneback:default", 2.0);
        let told = one.differences(&worse).unwrap().unwrap();
        assert_eq!(told, ["mean endpoint error 1 px", "mean endpoint error 2 px"]);
        let other = PairResult { input: "01".to_owned(), ..one.clone() };
        assert_eq!(one.differences(&other).unwrap().unwrap(), ["input 00", "input 01"]);
    }

    #[test]
    fn runs_are_in_the_order_of_the_algorithms_and_presets() {
        let job = |run: &str| result("mb", "Venus", run, 0.0).job;
        let mut jobs =
            ["x", "lucas-kanade:default", "farneback-tv:best", "farneback-tv:fast", "farneback:fast"]
                .map(job);
        jobs.sort_by(Job::order);
        let runs = jobs.each_ref().map(|job| job.run.as_str());
        assert_eq!(
            runs,
            ["farneback:fast", "farneback-tv:fast", "farneback-tv:best", "lucas-kanade:default", "x"]
        );
    }
}
