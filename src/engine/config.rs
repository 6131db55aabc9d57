//! The configuration of an engine.

use crate::error::Result;
use crate::flow::{Algorithm, FlowOptions, Initial};
use crate::frame::{FlowField, PixelFormat, Plane};
use crate::stream::StreamConfig;

/// The configuration of an [`Engine`](super::Engine): which flow, of which frames, and how the stream is run.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Config {
    /// The estimator and its parameters.
    pub algorithm: Algorithm,
    /// How the frames' pixels are stored.
    pub format: PixelFormat,
    /// Whether frames may come with a certainty of their pixels ([`FrameInputs::certainty`]).
    pub certainty: bool,
    /// Whether the confidence of the flow is computed and brought to the host.
    pub confidence: bool,
    /// Whether an initial flow may come with a frame ([`FrameInputs::initial_flow`]).
    pub initial_flow: bool,
    /// Whether a pair without an initial flow of its own begins with the flow of the previous pair, in place of no motion.
    pub warm_start: bool,
    /// Whether the flow is brought to the host.
    pub read_flow: bool,
    /// How the stream is run.
    pub stream: StreamConfig,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            algorithm: Algorithm::default(),
            format: PixelFormat::Gray8,
            certainty: false,
            confidence: false,
            initial_flow: false,
            warm_start: false,
            read_flow: true,
            stream: StreamConfig::default(),
        }
    }
}

impl Config {
    /// Checks every parameter's range.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter), naming the first one that is out of range.
    pub fn validate(&self) -> Result<()> {
        self.algorithm.validate()?;
        self.stream.validate()
    }

    /// What the plan takes and gives beside frames and flow.
    pub fn options(&self) -> FlowOptions {
        let initial = match (self.initial_flow, self.warm_start) {
            (_, true) => Initial::Previous,
            (true, false) => Initial::Given,
            (false, false) => Initial::Zero,
        };
        FlowOptions { initial, certainty: self.certainty, confidence: self.confidence }
    }
}

/// What may come with a frame.
#[derive(Clone, Copy, Debug, Default)]
pub struct FrameInputs<'a> {
    /// How far each pixel is to be trusted, 0 to 1. Values outside are clamped, and NaN is 0. Needs
    /// [`Config::certainty`]; a frame without one is trusted everywhere.
    pub certainty: Option<&'a Plane>,
    /// What the search for the flow to this frame begins with, in pixels; an unknown displacement is zero. Needs
    /// [`Config::initial_flow`] or [`Config::warm_start`]. A first frame has no use for it.
    pub initial_flow: Option<&'a FlowField>,
}
