//! The method's parameters by name.

use super::FarnebackTv;
use crate::error::Result;
use crate::flow::parameter::{Choice, Parameter, Parameters, read, wrong};

impl Parameters for FarnebackTv {
    const NAME: &'static str = "farneback-tv";
    const ABOUT: &'static str = "polynomial expansions with total-variation smoothness: much less error";
    const LIST: &'static [Parameter] = &[
        Parameter::number("pyr_scale", "RATIO", "Size of a level relative to the next finer one, above 0 and below 1"),
        Parameter::number("smallest", "PX", "Shortest side of a level in pixels, 8 to 1024"),
        Parameter::number("skip", "N", "Finest levels that are left out, 0 to 8; with 1 the flow has half the size and is enlarged"),
        Parameter::number("warps", "N", "Warps on the finest level, 0 to 100"),
        Parameter::number("coarse_warps", "N", "Warps on each coarser level, 0 to 100"),
        Parameter::number("alpha", "WEIGHT", "Weight of smoothness, above 0, at most 1000; less suits thin things"),
        Parameter::number("samples", "N", "Radius of the non-local step's grid in samples, 0 to 3; 0 leaves the step out"),
        Parameter::number("spacing", "PX", "Distance of its samples in pixels, 1 to 16"),
        Parameter::number("nonlocal_scale", "RATIO", "Smallest scale of the levels that end with a non-local step, 0 to 1"),
        Parameter::number("third_frame", "WEIGHT", "In a stream, weight of the frame before the pair, 0 to 1, for example 0.5; 0 leaves it out"),
        Parameter::number("carry", "WEIGHT", "In a stream, weight of the previous pair's flow, 0 to 1, for example 0.5; 0 leaves it out"),
    ];
    const PRESETS: &'static [Choice] = &[
        ("fast", "Half the size, 1 warp: for slow computers"),
        ("half", "Half the size, 3 warps and a non-local step"),
        ("light", "Full size, 1 warp; the default"),
        ("default", "The same as light"),
        ("medium", "Full size, 1 warp and a non-local step"),
        ("accurate", "Full size, 2 warps and a non-local step"),
        ("fine", "As accurate, for thin things: alpha 1.2, spacing 2"),
        ("best", "More levels, 3 warps, 49 samples, for recorded frames"),
    ];

    fn preset(name: &str) -> Option<Self> {
        match name {
            "fast" => Some(Self::fast()),
            "half" => Some(Self::half()),
            "light" | "default" => Some(Self::light()),
            "medium" => Some(Self::medium()),
            "accurate" => Some(Self::accurate()),
            "fine" => Some(Self::fine()),
            "best" => Some(Self::best()),
            _ => None,
        }
    }

    fn get(&self, name: &str) -> Option<String> {
        Some(match name {
            "pyr_scale" => self.pyr_scale.to_string(),
            "smallest" => self.smallest.to_string(),
            "skip" => self.skip.to_string(),
            "warps" => self.warps.to_string(),
            "coarse_warps" => self.coarse_warps.to_string(),
            "alpha" => self.alpha.to_string(),
            "samples" => self.samples.to_string(),
            "spacing" => self.spacing.to_string(),
            "nonlocal_scale" => self.nonlocal_scale.to_string(),
            "third_frame" => self.third_frame.to_string(),
            "carry" => self.carry.to_string(),
            _ => return None,
        })
    }

    fn set(&mut self, name: &str, value: &str) -> Result<()> {
        match name {
            "pyr_scale" => self.pyr_scale = read(Self::LIST, name, value)?,
            "smallest" => self.smallest = read(Self::LIST, name, value)?,
            "skip" => self.skip = read(Self::LIST, name, value)?,
            "warps" => self.warps = read(Self::LIST, name, value)?,
            "coarse_warps" => self.coarse_warps = read(Self::LIST, name, value)?,
            "alpha" => self.alpha = read(Self::LIST, name, value)?,
            "samples" => self.samples = read(Self::LIST, name, value)?,
            "spacing" => self.spacing = read(Self::LIST, name, value)?,
            "nonlocal_scale" => self.nonlocal_scale = read(Self::LIST, name, value)?,
            "third_frame" => self.third_frame = read(Self::LIST, name, value)?,
            "carry" => self.carry = read(Self::LIST, name, value)?,
            _ => return Err(wrong(Self::LIST, name, value)),
        }
        Ok(())
    }
}
