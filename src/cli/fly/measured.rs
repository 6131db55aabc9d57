//! What a flight has measured, held against the truth.

use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use crate::error::{Error, Result};
use crate::io::picture;
use crate::report::{FULL_DIVERGENCE_HZ, divergence_strip};
use crate::sim::flight::{Divergences, Flight, FlightFrame, Measured};

/// The picture's name in the flight's folder.
pub(super) const PICTURE: &str = "divergence.png";

#[derive(Args, Debug)]
#[command(next_help_heading = "Against the truth")]
pub(super) struct MeasureArgs {
    /// Hold the flow of images against the true one in every frame, and draw divergence.png: the measured divergence of the
    /// flow on the view sphere beside the true one, red where things come nearer, gray where it is not known
    #[arg(long)]
    pub(super) measure: bool,
    /// When divergence.png is drawn [default: when half of the way is done]; the last frame before, if the flight ends first
    #[arg(long, value_name = "SECONDS", requires = "measure", allow_negative_numbers = true)]
    picture_at: Option<f64>,
}

/// The divergences that are to be drawn.
pub(super) struct Picture {
    at_s: Option<f64>,
    half_m: f64,
    side: u32,
    /// With the time they are of.
    kept: Option<(f64, Divergences)>,
    done: bool,
}

/// What is written of it: null where nothing is known.
#[derive(Debug, Serialize)]
pub(super) struct MeasuredFigures {
    better_half_error_px: Option<f64>,
    trusted_error_px: Option<f64>,
    trusted: f64,
    contact_error: Option<f64>,
    contact_cells: usize,
}

impl MeasureArgs {
    /// What keeps the divergences, if they are to be drawn.
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

    /// Writes the picture, and says what is in it.
    pub(super) fn write(&self, folder: &Path) -> Result<String> {
        let path: PathBuf = folder.join(PICTURE);
        let Some((time_s, divergences)) = &self.kept else {
            return Ok("picture    none: no frame was measured".to_owned());
        };
        picture::write_png(&path, &divergence_strip(divergences, self.side, *time_s)?)?;
        Ok(format!(
            "picture    {}: divergence at {time_s:.2} s, full colour at ±{FULL_DIVERGENCE_HZ} /s",
            path.display()
        ))
    }
}

/// What was measured and drawn, to read.
pub(super) fn text(measured: Option<&Measured>, picture: Option<String>) -> Option<String> {
    let known = |value: Option<f64>, scale: f64, digits: usize| {
        value.map_or("?".to_owned(), |value| format!("{:.digits$}", scale * value))
    };
    let figures = measured.map(|measured| {
        format!(
            "flow       {} px off in the better half of what is trusted, {} px in all of it, {:.0} % of the view\n\
             contact    {} % off in {} cells that are met within 0.7 to 4 s (all medians)",
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
