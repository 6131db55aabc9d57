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
    /// The pixel format of the frames.
    pub format: PixelFormat,
    /// Whether a frame may have a certainty of its pixels ([`FrameInputs::certainty`]).
    pub certainty: bool,
    /// Whether the confidence of the flow is computed and read back to the host.
    pub confidence: bool,
    /// Whether a frame may have an initial flow ([`FrameInputs::initial_flow`]).
    pub initial_flow: bool,
    /// Whether the search of a pair without an initial flow begins with the flow of the previous pair, in place of zero
    /// motion.
    pub warm_start: bool,
    /// Whether the flow is read back to the host.
    pub read_flow: bool,
    /// The configuration of the stream.
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

    /// The plan's options: its inputs beside frames, and its outputs beside flow.
    pub fn options(&self) -> FlowOptions {
        let initial = match (self.initial_flow, self.warm_start) {
            (_, true) => Initial::Previous,
            (true, false) => Initial::Given,
            (false, false) => Initial::Zero,
        };
        FlowOptions { initial, certainty: self.certainty, confidence: self.confidence }
    }
}

/// Optional inputs of a frame.
#[derive(Clone, Copy, Debug, Default)]
pub struct FrameInputs<'a> {
    /// The certainty of each pixel, 0 to 1, in a plane of the frame's size. Values outside the range are clamped, and
    /// NaN is 0. Needs [`Config::certainty`]; without it the certainty is 1 everywhere.
    pub certainty: Option<&'a Plane>,
    /// The flow with which the search begins, in pixels from the previous frame to this one, of the frame's size; an
    /// unknown displacement is zero. Needs [`Config::initial_flow`] or [`Config::warm_start`]. A first frame ignores
    /// it.
    pub initial_flow: Option<&'a FlowField>,
}
