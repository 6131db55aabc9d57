//! `viewsphere eval`: the error of a flow field against the ground truth.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::{Outcome, input, print};
use crate::error::{Error, Result};
use crate::eval::{FlowError, flow_error};
use crate::io::read_flow;

/// Compare a flow field with the ground truth.
///
/// The extension tells the format: .flo (Middlebury), .png (KITTI), .npy (float32, height × width × 2). Pixels
/// unknown in the ground truth are left out; those unknown in the estimate lower the density. If no pixel is left to
/// compare, that is an error.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  viewsphere eval --truth gt.flo estimate.flo
  viewsphere eval --truth kitti/000000_10.png estimate.flo --mask valid.png --json")]
pub(super) struct Eval {
    /// The ground truth
    #[arg(long, value_name = "FILE")]
    truth: PathBuf,
    /// The flow field to evaluate
    estimate: PathBuf,
    /// Count only pixels where this image is brighter than mid-gray, or where this .npy plane is above 0.5
    #[arg(long, value_name = "FILE")]
    mask: Option<PathBuf>,
    /// Print the results as JSON
    #[arg(long)]
    json: bool,
}

/// [`FlowError`] as printed.
#[derive(Serialize)]
pub(super) struct FlowErrorFigures {
    aee_px: f64,
    aee_std_px: f64,
    aae_deg: f64,
    aae_std_deg: f64,
    rmse_px: f64,
    r1: f64,
    r3: f64,
    density: f64,
    pixels: usize,
}

impl From<FlowError> for FlowErrorFigures {
    fn from(e: FlowError) -> Self {
        Self {
            aee_px: e.aee_px,
            aee_std_px: e.aee_std,
            aae_deg: e.aae_deg,
            aae_std_deg: e.aae_std_deg,
            rmse_px: e.rmse_px,
            r1: e.r1,
            r3: e.r3,
            density: e.density,
            pixels: e.pixels,
        }
    }
}

impl Eval {
    pub(super) fn run(&self) -> Result<Outcome> {
        let truth = read_flow(&self.truth)?;
        let estimate = read_flow(&self.estimate)?;
        input::same_size(&self.estimate, estimate.size, truth.size, &self.truth)?;
        let mask = self.mask.as_ref().map(|path| input::plane(path, truth.size, &self.truth)).transpose()?;
        let error = flow_error(&truth, &estimate, mask.as_ref())?;
        if error.pixels == 0 {
            let inside =
                self.mask.as_ref().map_or(String::new(), |mask| format!(" inside {}", mask.display()));
            let found = format!("0: no pixel{inside} is known both there and in {}", self.truth.display());
            return Err(Error::format(&self.estimate, "number of pixels compared", found, "at least 1"));
        }
        if self.json {
            print::json(&FlowErrorFigures::from(error))?;
        } else {
            let e = &error;
            print::text(&format!(
                "endpoint error  mean {:.4} px, standard deviation {:.4} px, root mean square {:.4} px\n\
                 angular error   mean {:.3}°, standard deviation {:.3}°\n\
                 over 1 px       {:.2} %\n\
                 over 3 px       {:.2} %\n\
                 density         {:.2} % ({} pixels compared)",
                e.aee_px,
                e.aee_std,
                e.rmse_px,
                e.aae_deg,
                e.aae_std_deg,
                100.0 * e.r1,
                100.0 * e.r3,
                100.0 * e.density,
                e.pixels,
            ))?;
        }
        Ok(Outcome::Done)
    }
}
