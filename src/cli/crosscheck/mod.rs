//! `viewsphere crosscheck`: compares the two backends step by step, on the user's machine and images.

mod show;

use std::path::PathBuf;

use clap::Args;

use super::backend::options;
use super::flow_args::FlowArgs;
use super::{Outcome, input, print};
use crate::camera::{Camera, Framing, Lens};
use crate::crosscheck::crosscheck;
use crate::error::{Error, Result};
use crate::eval::Scene;
use crate::flow::{self, Algorithm, FlowOptions};
use crate::frame::{Image, Plane, Size};
use crate::gpu::{Gpu, GpuOptions};
use crate::io::picture;
use crate::plan::Plan;
use crate::sphere::{Cameras, ExtraOutputs, Sphere, plan};

/// Compare the GPU with the CPU, step by step.
///
/// Each step of the computation runs on both, with the same inputs (the CPU's), and every value must lie within its
/// kernel's bound. Then each computes the whole flow on its own, errors accumulating, and the two flow fields are
/// compared. Exits with 1 if a value of a step exceeds its bound.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  viewsphere crosscheck                              a synthetic pair of 640×480
  viewsphere crosscheck a.png b.png --steps
  viewsphere crosscheck --sphere                     on to the sectors of the view, through a lens and a turn
  viewsphere crosscheck --size 1280x720 --preset accurate --adapter llvmpipe --json")]
pub(super) struct Crosscheck {
    /// Two images of the same size [default: a synthetic textured pair]
    #[arg(num_args = 2, value_names = ["A", "B"])]
    pictures: Vec<PathBuf>,
    /// Size of the synthetic pair
    #[arg(long, value_name = "WxH", conflicts_with = "pictures")]
    size: Option<Size>,
    /// Also check the certainty weighting, with this image (black 0, white 1) or .npy plane as the certainty of both
    /// frames
    #[arg(long, value_name = "FILE")]
    mask: Option<PathBuf>,
    /// Check all steps up to the sectors of the view: undistortion of a synthetic lens, a synthetic rotation, the
    /// flow, cells and sectors
    #[arg(long)]
    sphere: bool,
    /// Part of the name of the GPU adapter to check [default: the best one, software adapters included]
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Multiply every bound by this factor; 0 demands identical bits
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, allow_negative_numbers = true)]
    bounds: f32,
    /// Print every step, not only the worst one of each kernel
    #[arg(long)]
    steps: bool,
    /// Print the results as JSON, always with every step
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
        let gpu = Gpu::new(&GpuOptions { adapter: self.adapter.clone(), allow_software: true, ..options() })?;
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
        let report = crosscheck(&gpu, &plan, &pair, certainty.as_ref(), self.bounds)?;
        if self.json {
            print::json(&report)?;
        } else {
            print::text(&show::text(&report, self.steps))?;
        }
        Ok(if report.breaches == 0 { Outcome::Done } else { Outcome::CheckFailed })
    }

    /// The two images, and the name by which errors refer to them.
    fn pair(&self) -> Result<([Image; 2], PathBuf)> {
        if let [a, b] = self.pictures.as_slice() {
            return Ok((picture::read_pair(a, b)?, a.clone()));
        }
        let scene = Scene::new(self.size.unwrap_or(Size::new(640, 480)))?;
        Ok(([scene.frame(0), scene.frame(1)], PathBuf::from("the synthetic pair")))
    }
}

/// The plan up to the sectors, for a wide-angle camera with typical barrel distortion.
fn sphere_plan(algorithm: &Algorithm, image: &Image, mask: Option<&Plane>) -> Result<Plan> {
    let [width, height] = [image.size.width, image.size.height].map(f64::from);
    let lens = Lens::new(&[-0.28, 0.075, 3e-4, -2e-4, 0.0])?;
    let (f_u, f_v) = (0.53 * width, 0.53 * width);
    let raw = Camera { size: image.size, f_u, f_v, u_0: 0.504 * width, v_0: 0.492 * height, lens };
    let cameras =
        Cameras { raw: &raw, ideal: &raw.ideal(image.size, Framing::CropToValid)?, mask, gyro: true };
    let fields = ExtraOutputs { spherical_flow: true, ..ExtraOutputs::default() };
    Ok(plan(algorithm, mask.is_some(), &Sphere::default(), cameras, image.format, fields)?.0)
}
