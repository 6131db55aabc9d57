//! How a stream of frames is run.

use std::time::Duration;

use crate::error::{Error, Result};

/// What a stream does when the GPU is lost and cannot be reopened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum OnLoss {
    /// Every further call is [`Error::DeviceLost`].
    #[default]
    Fail,
    /// The stream goes on, on the CPU, and [`Stats::on_cpu`](super::Stats::on_cpu) says so.
    Cpu,
}

/// How a stream of frames is run, whatever is computed of them.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct StreamConfig {
    /// Frames that may be submitted and not yet taken, 1 to 8.
    pub in_flight: usize,
    /// How long a frame may take from submit on. None: as long as it takes.
    pub deadline: Option<Duration>,
    /// What happens when the GPU is lost a second time.
    pub on_loss: OnLoss,
    /// Whether the time of every step is taken.
    pub timestamps: bool,
    /// What a submit to a full stream does: if false it is [`Error::Busy`]; if true the oldest waiting frame is dropped
    /// and counted. Needs `in_flight` of at least 2: one frame is computed while another one waits.
    pub drop_oldest: bool,
}

impl Default for StreamConfig {
    fn default() -> Self {
        Self { in_flight: 2, deadline: None, on_loss: OnLoss::Fail, timestamps: false, drop_oldest: false }
    }
}

impl StreamConfig {
    /// The largest [`StreamConfig::in_flight`].
    pub const MAX_IN_FLIGHT: usize = 8;

    /// Checks every parameter's range.
    ///
    /// # Errors
    /// [`Error::Parameter`], naming the first one that is out of range.
    pub fn validate(&self) -> Result<()> {
        let least = if self.drop_oldest { 2 } else { 1 };
        if (least..=Self::MAX_IN_FLIGHT).contains(&self.in_flight) {
            return Ok(());
        }
        let why = if self.drop_oldest { " where the oldest is dropped" } else { "" };
        let expected = format!("{least} to {}{why}", Self::MAX_IN_FLIGHT);
        Err(Error::parameter("in_flight", self.in_flight, expected))
    }
}
