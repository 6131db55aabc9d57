use super::Job;
use crate::sim::flight::Summary;

/// How a job ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Ended {
    /// It was flown.
    Flown(Summary),
    /// It could not be flown to its end, for this reason.
    Failed(String),
}

/// What became of a job.
#[derive(Clone, Debug, PartialEq)]
pub struct JobResult {
    /// Which one.
    pub job: Job,
    /// What computed the flow; none where there were no pictures.
    pub adapter: Option<String>,
    /// How it ended.
    pub ended: Ended,
}
