//! `viewsphere crosscheck`: the two executors against each other, step by step, on the user's machine and pictures.

mod run;
mod show;

use std::path::PathBuf;

use clap::Args;

use super::flow_args::FlowArgs;
use super::{Outcome, input, print};
use crate::camera::{Camera, Lens, View};
use crate::error::{Error, Result};
use crate::eval::Scene;
use crate::flow::{self, Algorithm, FlowOptions};
use crate::frame::{Image, Plane, Size};
use crate::gpu::{Gpu, GpuOptions};
use crate::plan::Plan;
use crate::sphere::{Eye, Fields, Sphere, plan};

/// Compare the GPU with the CPU, step by step.
///
/// Each step of the computation runs on both, on the same inputs (the CPU's), and every value must lie within the bound
/// of its kernel. Then both compute the whole flow on their own, errors adding up, and the two fields are compared.
/// Ends with 1 if a value of a step is beyond its bound.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  viewsphere crosscheck                              a made-up pair of 640×480
  viewsphere crosscheck a.png b.png --steps
  viewsphere crosscheck --sphere                     on to the sectors of the view, through a lens and a turn
  viewsphere crosscheck --size 1280x720 --preset accurate --adapter llvmpipe --json")]
pub(super) struct Crosscheck {
    /// Two pictures of one size; without them a made-up textured pair
    #[arg(num_args = 2, value_names = ["A", "B"])]
    pictures: Vec<PathBuf>,
    /// Size of the made-up pair
    #[arg(long, value_name = "WxH", conflicts_with = "pictures")]
    size: Option<Size>,
    /// Also check the certainty weighting, with this picture (black 0, white 1) or .npy as certainty of both frames
    #[arg(long, value_name = "FILE")]
    mask: Option<PathBuf>,
    /// Check the whole way to the sectors of the view: a made-up lens taken out and a made-up turn, then the flow, cells
    /// and sectors
    #[arg(long)]
    sphere: bool,
    /// Part of the name of the GPU adapter to check; without it the best one, software adapters too
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Multiply every bound by this; 0 asks for the same bits on both sides
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, allow_negative_numbers = true)]
    bounds: f32,
    /// Print every step, not only the worst of each kernel
    #[arg(long)]
    steps: bool,
    /// Print the figures as JSON, always with every step
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    flow: FlowArgs,
}

impl Crosscheck {
    pub(super) fn run(&self) -> Result<Outcome> {
        let algorithm = self.flow.algorithm()?;
        if !(self.bounds.is_finite() && self.bounds >= 0.0) {
            return Err(Error::parameter("--bounds", self.bounds, "a finite number of 0 or more"));
        }
        let (pair, name) = self.pair()?;
        let certainty = self.mask.as_ref().map(|path| input::plane(path, pair[0].size, &name)).transpose()?;
        let gpu = Gpu::new(&GpuOptions { adapter: self.adapter.clone(), allow_software: true })?;
        print::note(format_args!("checking {}", gpu.adapter()));
        let plan = match self.sphere {
            true => sphere_plan(&algorithm, &pair[0], certainty.as_ref())?,
            false => {
                let options = FlowOptions {
                    certainty: certainty.is_some(),
                    confidence: true,
                    ..FlowOptions::default()
                };
                flow::plan(&algorithm, pair[0].size, pair[0].format, options)?
            }
        };
        let report = run::run(&gpu, &plan, &pair, certainty.as_ref(), self.bounds)?;
        if self.json {
            print::json(&report)?;
        } else {
            print::text(&show::text(&report, self.steps))?;
        }
        Ok(if report.breaches == 0 { Outcome::Done } else { Outcome::CheckFailed })
    }

    /// The pictures, and what they are called.
    fn pair(&self) -> Result<([Image; 2], PathBuf)> {
        if let [a, b] = self.pictures.as_slice() {
            return Ok((input::pair(a, b)?, a.clone()));
        }
        let scene = Scene::new(self.size.unwrap_or(Size::new(640, 480)))?;
        Ok(([scene.frame(0), scene.frame(1)], PathBuf::from("the made-up pair")))
    }
}

/// The plan to the sectors, for a wide camera with a lens of the usual barrel distortion.
fn sphere_plan(algorithm: &Algorithm, image: &Image, mask: Option<&Plane>) -> Result<Plan> {
    let [width, height] = [image.size.width, image.size.height].map(f64::from);
    let lens = Lens::new(&[-0.28, 0.075, 3e-4, -2e-4, 0.0])?;
    let (f_u, f_v) = (0.53 * width, 0.53 * width);
    let raw = Camera { size: image.size, f_u, f_v, u_0: 0.504 * width, v_0: 0.492 * height, lens };
    let eye = Eye { raw: &raw, ideal: &raw.ideal(image.size, View::CropToValid)?, mask, gyro: true };
    let fields = Fields { tangent: true, ..Fields::default() };
    Ok(plan(algorithm, mask.is_some(), &Sphere::default(), eye, image.format, fields)?.0)
}
