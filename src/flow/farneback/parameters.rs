//! Farnebäck's parameters by name.

use super::{Border, Farneback, Motion, Outside, Update, Window};
use crate::error::Result;
use crate::flow::parameter::{Choice, Parameter, Parameters, choice_name, choose, read, wrong};

const WINDOWS: [(&str, Window); 2] = [("box", Window::Box), ("gaussian", Window::Gaussian)];
const UPDATES: [(&str, Update); 3] =
    [("flow", Update::Flow), ("increment", Update::Increment), ("normalized", Update::Normalized)];
const OUTSIDES: [(&str, Outside); 2] = [("first", Outside::First), ("nothing", Outside::Nothing)];

const MOTIONS: [(&str, Motion); 2] = [("constant", Motion::Constant), ("affine", Motion::Affine)];
const BORDERS: [(&str, Border); 2] = [("replicate", Border::Replicate), ("normalized", Border::Normalized)];

impl Parameters for Farneback {
    const NAME: &'static str = "farneback";
    const ABOUT: &'static str = "polynomial expansions, as in OpenCV's calcOpticalFlowFarneback";
    const LIST: &'static [Parameter] = &[
        Parameter::number("pyr_scale", "RATIO", "Size of a level relative to the next finer one, above 0 and below 1"),
        Parameter::number("levels", "N", "Levels beside the full image, 0 to 32"),
        Parameter::number("winsize", "PX", "Width of the averaging window in pixels, 2 to 1024"),
        Parameter::number("iterations", "N", "Iterations on each level, 1 to 1000"),
        Parameter::number("poly_n", "PX", "Radius of the polynomial expansion in pixels, 1 to 32"),
        Parameter::number(
            "poly_sigma",
            "PX",
            "Standard deviation of the expansion's Gaussian in pixels, 0 to 100; 0 is 0.3 × poly-n",
        ),
        Parameter::choice(
            "window",
            "Shape of the averaging window",
            &[("box", "All neighbours have the same weight"), ("gaussian", "Near neighbours have more weight")],
        ),
        Parameter::choice(
            "update",
            "Quantity that an iteration's window averages",
            &[
                ("flow", "The flow, as in OpenCV"),
                (
                    "increment",
                    "The increment of the flow: finer detail with a wider window. Requires a Gaussian window, or one \
                     iteration",
                ),
                ("normalized", "The increment of equations that are divided by their own slopes: less error still"),
            ],
        ),
        Parameter::choice(
            "outside",
            "Treatment of a pixel that the flow takes outside the second image",
            &[
                ("first", "Use the first image alone, as in OpenCV"),
                ("nothing", "Leave the pixel out: the window's other pixels decide"),
            ],
        ),
        Parameter::choice(
            "motion",
            "Model of the motion within the window",
            &[
                ("constant", "All neighbours move alike, as in OpenCV"),
                ("affine", "The motion is an affine function of the place: follows slopes of the flow in wide windows"),
            ],
        ),
        Parameter::choice(
            "border",
            "Treatment of expansions that the image's border cuts off",
            &[
                ("replicate", "Repeat the border's pixels, as in OpenCV"),
                ("normalized", "Give pixels outside no weight (normalised convolution)"),
            ],
        ),
    ];
    const PRESETS: &'static [Choice] = &[
        ("fast", "Half the default's work: 1 iteration, winsize 13"),
        ("default", "3 iterations, winsize 15, 3 levels"),
        ("accurate", "Three times the default's work: 10 iterations, winsize 13, 5 levels, poly-sigma 1.1"),
        (
            "increment",
            "Half the default's work and less error, except where there is no texture (as in a sky): 1 iteration of \
             normalized increments, Gaussian winsize 31, poly-n 3, poly-sigma 1, outside nothing",
        ),
        (
            "affine",
            "The 2003 paper's: affine motion in a Gaussian winsize of 45, poly-sigma 1.1, outside nothing, border normalized; for \
             smooth scenes",
        ),
    ];

    fn preset(name: &str) -> Option<Self> {
        match name {
            "default" => Some(Self::default()),
            "fast" => Some(Self::fast()),
            "accurate" => Some(Self::accurate()),
            "increment" => Some(Self::increment()),
            "affine" => Some(Self::affine()),
            _ => None,
        }
    }

    fn get(&self, name: &str) -> Option<String> {
        Some(match name {
            "pyr_scale" => self.pyr_scale.to_string(),
            "levels" => self.levels.to_string(),
            "winsize" => self.winsize.to_string(),
            "iterations" => self.iterations.to_string(),
            "poly_n" => self.poly_n.to_string(),
            "poly_sigma" => self.poly_sigma.to_string(),
            "window" => choice_name(&WINDOWS, self.window).to_owned(),
            "update" => choice_name(&UPDATES, self.update).to_owned(),
            "outside" => choice_name(&OUTSIDES, self.outside).to_owned(),
            "motion" => choice_name(&MOTIONS, self.motion).to_owned(),
            "border" => choice_name(&BORDERS, self.border).to_owned(),
            _ => return None,
        })
    }

    fn set(&mut self, name: &str, value: &str) -> Result<()> {
        match name {
            "pyr_scale" => self.pyr_scale = read(Self::LIST, name, value)?,
            "levels" => self.levels = read(Self::LIST, name, value)?,
            "winsize" => self.winsize = read(Self::LIST, name, value)?,
            "iterations" => self.iterations = read(Self::LIST, name, value)?,
            "poly_n" => self.poly_n = read(Self::LIST, name, value)?,
            "poly_sigma" => self.poly_sigma = read(Self::LIST, name, value)?,
            "window" => self.window = choose(Self::LIST, &WINDOWS, name, value)?,
            "update" => self.update = choose(Self::LIST, &UPDATES, name, value)?,
            "outside" => self.outside = choose(Self::LIST, &OUTSIDES, name, value)?,
            "motion" => self.motion = choose(Self::LIST, &MOTIONS, name, value)?,
            "border" => self.border = choose(Self::LIST, &BORDERS, name, value)?,
            _ => return Err(wrong(Self::LIST, name, value)),
        }
        Ok(())
    }
}
