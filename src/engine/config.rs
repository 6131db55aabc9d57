//! What an engine is made of and told.

use std::time::Duration;

use crate::error::{Error, Result};
use crate::flow::Farneback;
use crate::frame::{FlowField, PixelFormat, Plane};
use crate::gpu::Gpu;
use crate::sphere::Motion;

/// What an engine computes on.
#[derive(Clone)]
pub enum Backend {
    /// A GPU.
    Gpu(Gpu),
    /// The CPU, on the threads of rayon's pool.
    Cpu,
}

impl Backend {
    /// The adapter's name, or `cpu`: unlike [`Engine::adapter`](super::Engine::adapter) the same for any number of cores,
    /// which do not change the results.
    pub fn name(&self) -> String {
        match self {
            Self::Gpu(gpu) => gpu.adapter().to_string(),
            Self::Cpu => "cpu".to_owned(),
        }
    }
}

/// What an engine does when the GPU is lost and cannot be brought back.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum OnLoss {
    /// Every further call is [`Error::DeviceLost`].
    #[default]
    Fail,
    /// The stream goes on, on the CPU, and [`Stats::on_cpu`](super::Stats::on_cpu) says so.
    Cpu,
}

/// How an engine works.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Config {
    /// The estimator's parameters.
    pub flow: Farneback,
    /// How the frames' pixels are stored.
    pub format: PixelFormat,
    /// Frames that may be submitted and not yet taken, 1 to 8.
    pub in_flight: usize,
    /// How long a frame may take from [`submit`](super::Engine::submit) on; none for as long as it takes.
    pub deadline: Option<Duration>,
    /// What happens when the GPU is lost a second time.
    pub on_loss: OnLoss,
    /// Whether a pair begins with the flow of the pair before in place of none. Switches [`Farneback::initial_flow`] on.
    pub warm_start: bool,
    /// Whether the flow is brought to the host.
    pub read_flow: bool,
    /// Whether the confidence is brought to the host, if [`Farneback::confidence`] asks for it.
    pub read_confidence: bool,
    /// Whether the time of every step is taken.
    pub timestamps: bool,
    /// What a submit to a full engine does: if false it is [`Error::Busy`]; if true the oldest waiting frame is dropped
    /// and counted. Needs `in_flight` of at least 2: one frame is computed while another one waits.
    pub drop_oldest: bool,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            flow: Farneback::default(),
            format: PixelFormat::Gray8,
            in_flight: 2,
            deadline: None,
            on_loss: OnLoss::Fail,
            warm_start: false,
            read_flow: true,
            read_confidence: true,
            timestamps: false,
            drop_oldest: false,
        }
    }
}

impl Config {
    /// The largest [`Config::in_flight`].
    pub const MAX_IN_FLIGHT: usize = 8;

    /// Checks every parameter's range.
    ///
    /// # Errors
    /// [`Error::Parameter`], naming the first one that is out of range.
    pub fn validate(&self) -> Result<()> {
        self.flow.validate()?;
        let least = if self.drop_oldest { 2 } else { 1 };
        if !(least..=Self::MAX_IN_FLIGHT).contains(&self.in_flight) {
            let why = if self.drop_oldest { " where the oldest is dropped" } else { "" };
            let expected = format!("{least} to {}{why}", Self::MAX_IN_FLIGHT);
            return Err(Error::parameter("in_flight", self.in_flight, expected));
        }
        Ok(())
    }

    /// The estimator's parameters, with what the rest of the configuration asks of them.
    pub(super) fn estimator(&self) -> Farneback {
        Farneback { initial_flow: self.flow.initial_flow || self.warm_start, ..self.flow.clone() }
    }
}

/// What may come with a frame.
#[derive(Clone, Copy, Debug, Default)]
pub struct Extras<'a> {
    /// How far each pixel is to be trusted, 0 to 1. Values outside are held within, and NaN is 0. Needs
    /// [`Farneback::certainty`]; a frame without one is trusted everywhere.
    pub certainty: Option<&'a Plane>,
    /// What the search for the flow to this frame begins with, in pixels; an unknown displacement is none. Needs
    /// [`Farneback::initial_flow`] or [`Config::warm_start`]. A first frame has no use for it.
    pub initial_flow: Option<&'a FlowField>,
    /// What is known of the camera's motion since the frame before. Needs a plan that takes it: that of a
    /// pipeline, which gives it itself.
    pub motion: Option<&'a Motion>,
}
