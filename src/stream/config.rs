//! The configuration of a stream of frames.

use std::time::Duration;

use crate::error::{Error, Result};

/// The behaviour of a stream when the GPU is lost and cannot be reopened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum OnLoss {
    /// Every further call is [`Error::DeviceLost`].
    #[default]
    Fail,
    /// The stream continues on the CPU, as [`Stats::on_cpu`](super::Stats::on_cpu) tells.
    Cpu,
}

/// The configuration of a stream of frames, for any plan.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct StreamConfig {
    /// The number of frames that may be in flight (submitted and not yet taken), 1 to 8.
    pub in_flight: usize,
    /// The time that a frame may take from its submission on. `None` for no limit.
    pub deadline: Option<Duration>,
    /// The behaviour when the GPU is lost a second time.
    pub on_loss: OnLoss,
    /// Whether the time of every step is measured.
    pub timestamps: bool,
    /// Whether a submit to a full stream drops the oldest waiting frame and counts it, in place of failing with
    /// [`Error::Busy`]. Needs `in_flight` of at least 2: one frame is computed while another one waits.
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
