//! The measurements of a flight against ground truth.

use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use crate::error::{Error, Result};
use crate::io::picture;
use crate::report::{FULL_DIVERGENCE_HZ, divergence_strip};
use crate::sim::flight::{Divergences, Flight, FlightFrame, Measured};

/// The image's file name in the flight's folder.
pub(super) const PICTURE: &str = "divergence.png";

#[derive(Args, Debug)]
#[command(next_help_heading = "Comparison with ground truth")]
pub(super) struct MeasureArgs {
    /// Compare the flow of images with ground truth in every frame, and draw divergence.png: the measured divergence of
    /// the flow on the view sphere beside the true one, red where surfaces approach, gray where it is unknown
    #[arg(long)]
    pub(super) measure: bool,
    /// Time of divergence.png, in seconds [default: half of the course]; the last frame before, if the flight ends
    /// earlier
    #[arg(long, value_name = "SECONDS", requires = "measure", allow_negative_numbers = true)]
    picture_at: Option<f64>,
}

/// Keeps the divergences to draw.
pub(super) struct Picture {
    at_s: Option<f64>,
    half_m: f64,
    side: u32,
    /// The divergences with their time, seconds.
    kept: Option<(f64, Divergences)>,
    done: bool,
}

/// The measurements as JSON; unknown values are `null`.
#[derive(Debug, Serialize)]
pub(super) struct MeasuredFigures {
    better_half_error_px: Option<f64>,
    trusted_error_px: Option<f64>,
    trusted: f64,
    contact_error: Option<f64>,
    contact_cells: usize,
}

impl MeasureArgs {
    /// The recorder of the divergences, if they are to be drawn.
    pub(super) fn picture(&self, flight: &Flight) -> Result<Option<Picture>> {
        if let Some(at_s) = self.picture_at.filter(|at_s| !(*at_s >= 0.0 && at_s.is_finite())) {
            return Err(Error::parameter("--picture-at", at_s, "0 or above"));
        }
        Ok(self.measure.then(|| Picture {
            at_s: self.picture_at,
            half_m: 0.5 * flight.course().length_m,
            side: flight.config().pipeline.sphere.cell,
            kept: None,
            done: false,
        }))
    }
}

impl Picture {
    pub(super) fn add(&mut self, seen: &FlightFrame<'_>) {
        let Some(divergences) = seen.divergences.filter(|_| !self.done) else { return };
        let record = seen.record;
        self.done = match self.at_s {
            Some(at_s) => record.time_s >= at_s,
            None => record.progress_m >= self.half_m,
        };
        self.kept = Some((record.time_s, divergences.clone()));
    }

    /// Writes the image, and describes it in a line of text.
    pub(super) fn write(&self, folder: &Path) -> Result<String> {
        let path: PathBuf = folder.join(PICTURE);
        let Some((time_s, divergences)) = &self.kept else {
            return Ok("image      none: no frame was measured".to_owned());
        };
        picture::write_png(&path, &divergence_strip(divergences, self.side, *time_s)?)?;
        Ok(format!(
            "image      {}: divergence at {time_s:.2} s, full colour at ±{FULL_DIVERGENCE_HZ} /s",
            path.display()
        ))
    }
}

/// The measurements and the image, as text.
pub(super) fn text(measured: Option<&Measured>, picture: Option<String>) -> Option<String> {
    let known = |value: Option<f64>, scale: f64, digits: usize| {
        value.map_or("?".to_owned(), |value| format!("{:.digits$}", scale * value))
    };
    let figures = measured.map(|measured| {
        format!(
            "flow       median error {} px in the more confident half of the trusted cells, {} px in all of them, \
             {:.0} % of the view\n\
             contact    median error {} % of the time to contact, over {} cells with 0.7 to 4 s to contact",
            known(measured.better_half_error_px, 1.0, 3),
            known(measured.trusted_error_px, 1.0, 3),
            100.0 * measured.trusted,
            known(measured.contact_error, 100.0, 1),
            measured.contact_cells,
        )
    });
    let lines: Vec<String> = figures.into_iter().chain(picture).collect();
    (!lines.is_empty()).then(|| lines.join("\n"))
}

impl From<Measured> for MeasuredFigures {
    fn from(measured: Measured) -> Self {
        Self {
            better_half_error_px: measured.better_half_error_px,
            trusted_error_px: measured.trusted_error_px,
            trusted: measured.trusted,
            contact_error: measured.contact_error,
            contact_cells: measured.contact_cells,
        }
    }
}
