//! The method's parameters by name.

use super::FlowFilter;
use crate::error::Result;
use crate::flow::parameter::{Choice, Parameter, Parameters, read, wrong};

impl Parameters for FlowFilter {
    const NAME: &'static str = "flow-filter";
    const ABOUT: &'static str =
        "each frame corrects a prediction from the previous flow: for streams of 60 to 300 Hz, not for lone pairs";
    const LIST: &'static [Parameter] = &[
        Parameter::number("gamma", "WEIGHT", "Weight of the prediction in squared gray levels, 0.01 to 100000; more averages over more frames"),
        Parameter::number("winsize", "PX", "Width of the Gaussian window in pixels of its level, 3 to 63"),
        Parameter::number("levels", "N", "Levels beside the full image, 0 to 32"),
        Parameter::number("skip", "N", "Finest levels that are left out, 0 to 8; with 1 the flow has half the size and is enlarged"),
    ];
    const PRESETS: &'static [Choice] = &[
        ("fast", "A quarter of the size"),
        ("default", "Half the size"),
        ("fine", "Full size, for fine detail"),
    ];

    fn preset(name: &str) -> Option<Self> {
        match name {
            "fast" => Some(Self::fast()),
            "default" => Some(Self::default()),
            "fine" => Some(Self::fine()),
            _ => None,
        }
    }

    fn get(&self, name: &str) -> Option<String> {
        Some(match name {
            "gamma" => self.gamma.to_string(),
            "winsize" => self.winsize.to_string(),
            "levels" => self.levels.to_string(),
            "skip" => self.skip.to_string(),
            _ => return None,
        })
    }

    fn set(&mut self, name: &str, value: &str) -> Result<()> {
        match name {
            "gamma" => self.gamma = read(Self::LIST, name, value)?,
            "winsize" => self.winsize = read(Self::LIST, name, value)?,
            "levels" => self.levels = read(Self::LIST, name, value)?,
            "skip" => self.skip = read(Self::LIST, name, value)?,
            _ => return Err(wrong(Self::LIST, name, value)),
        }
        Ok(())
    }
}
