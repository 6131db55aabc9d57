//! One flow field against one ground truth.

use std::path::Path;

use serde::Serialize;

use crate::cli::place::Allowed;
use crate::cli::{Outcome, input, paths, print};
use crate::error::{Error, Result};
use crate::eval::{FlowError, flow_error};
use crate::io::{read_flow, write_bytes};

/// The files, and where JSON goes.
pub(super) struct Single<'a> {
    pub(super) truth: &'a Path,
    pub(super) estimate: &'a Path,
    pub(super) mask: Option<&'a Path>,
    /// A file, or `-` for standard output.
    pub(super) json: Option<&'a Path>,
}

/// [`FlowError`] as printed.
#[derive(Serialize)]
pub(in crate::cli) struct FlowErrorFigures {
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

impl Single<'_> {
    pub(super) fn run(&self) -> Result<Outcome> {
        if let Some(path) = self.json.filter(|path| *path != Path::new(super::STDOUT)) {
            let place = Allowed::file(&["json"]).place("--json", path)?;
            let read = [self.truth, self.estimate].into_iter().chain(self.mask);
            paths::check(&[("--json", Some(&place))], read)?;
        }
        let truth = read_flow(self.truth)?;
        let estimate = read_flow(self.estimate)?;
        input::same_size(self.estimate, estimate.size, truth.size, self.truth)?;
        let mask = self.mask.map(|path| input::plane(path, truth.size, self.truth)).transpose()?;
        let error = flow_error(&truth, &estimate, mask.as_ref())?;
        if error.pixels == 0 {
            let inside = self.mask.map_or(String::new(), |mask| format!(" inside {}", mask.display()));
            let found = format!("0: no pixel{inside} is known both there and in {}", self.truth.display());
            return Err(Error::format(self.estimate, "number of pixels compared", found, "at least 1"));
        }
        match self.json {
            Some(path) if path == Path::new(super::STDOUT) => print::json(&FlowErrorFigures::from(error))?,
            Some(path) => {
                write_bytes(path, (print::pretty(&FlowErrorFigures::from(error))? + "\n").as_bytes())?;
            }
            None => print::text(&text(&error))?,
        }
        Ok(Outcome::Done)
    }
}

fn text(e: &FlowError) -> String {
    format!(
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
    )
}
