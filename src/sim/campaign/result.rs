use super::Job;
use crate::sim::flight::Summary;

/// How a job ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Ended {
    /// It was flown.
    Flown(Summary),
    /// It failed with this error.
    Failed(String),
}

/// The result of a job.
#[derive(Clone, Debug, PartialEq)]
pub struct JobResult {
    /// The job.
    pub job: Job,
    /// The adapter that computed the flow; `None` if no flow was computed.
    pub adapter: Option<String>,
    /// How it ended.
    pub ended: Ended,
}
