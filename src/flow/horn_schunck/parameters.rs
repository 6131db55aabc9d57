//! The method's parameters by name.

use super::{HornSchunck, Penalty};
use crate::error::Result;
use crate::flow::parameter::{Choice, Parameter, Parameters, choice_name, choose, read, wrong};

const PENALTIES: [(&str, Penalty); 2] = [("quadratic", Penalty::Quadratic), ("robust", Penalty::Robust)];

impl Parameters for HornSchunck {
    const NAME: &'static str = "horn-schunck";
    const ABOUT: &'static str = "constant brightness and a smooth flow over the whole image, pyramidal with warping";
    const LIST: &'static [Parameter] = &[
        Parameter::number("alpha", "LEVELS", "Its square is the weight of smoothness, in gray levels, 0.1 to 1000"),
        Parameter::choice(
            "penalty",
            "Penalty of both terms",
            &[
                ("quadratic", "The squares of 1981"),
                ("robust", "Charbonnier's, for occlusions and edges of the flow"),
            ],
        ),
        Parameter::number("pyr_scale", "RATIO", "Size of a level relative to the next finer one, above 0 and below 1"),
        Parameter::number("levels", "N", "Levels beside the full image, 0 to 32"),
        Parameter::number("smallest", "PX", "Shortest side of a level in pixels, 8 to 1024"),
        Parameter::number("warps", "N", "Warps on each level, 1 to 100"),
        Parameter::number("sweeps", "N", "Sweeps of relaxation in each warp, an even number from 2 to 10000"),
        Parameter::number("omega", "RATIO", "Over-relaxation, 1 to 1.99; the more sweeps, the nearer to 2 is best"),
    ];
    const PRESETS: &'static [Choice] = &[
        ("fast", "2 warps of 10 sweeps on each level"),
        ("default", "3 warps of 20 sweeps"),
        ("accurate", "5 warps of 40 sweeps"),
        ("robust", "The robust penalty, 10 warps of 10 sweeps: the least error"),
        ("classic", "The method of 1981: 1 level, 1 warp, 400 sweeps, for motion of a pixel or two"),
    ];

    fn preset(name: &str) -> Option<Self> {
        match name {
            "fast" => Some(Self::fast()),
            "default" => Some(Self::default()),
            "accurate" => Some(Self::accurate()),
            "robust" => Some(Self::robust()),
            "classic" => Some(Self::classic()),
            _ => None,
        }
    }

    fn get(&self, name: &str) -> Option<String> {
        Some(match name {
            "alpha" => self.alpha.to_string(),
            "penalty" => choice_name(&PENALTIES, self.penalty).to_owned(),
            "pyr_scale" => self.pyr_scale.to_string(),
            "levels" => self.levels.to_string(),
            "smallest" => self.smallest.to_string(),
            "warps" => self.warps.to_string(),
            "sweeps" => self.sweeps.to_string(),
            "omega" => self.omega.to_string(),
            _ => return None,
        })
    }

    fn set(&mut self, name: &str, value: &str) -> Result<()> {
        match name {
            "alpha" => self.alpha = read(Self::LIST, name, value)?,
            "penalty" => self.penalty = choose(Self::LIST, &PENALTIES, name, value)?,
            "pyr_scale" => self.pyr_scale = read(Self::LIST, name, value)?,
            "levels" => self.levels = read(Self::LIST, name, value)?,
            "smallest" => self.smallest = read(Self::LIST, name, value)?,
            "warps" => self.warps = read(Self::LIST, name, value)?,
            "sweeps" => self.sweeps = read(Self::LIST, name, value)?,
            "omega" => self.omega = read(Self::LIST, name, value)?,
            _ => return Err(wrong(Self::LIST, name, value)),
        }
        Ok(())
    }
}
