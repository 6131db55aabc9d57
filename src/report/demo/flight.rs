//! The demo's flight.

use crate::quantile::{median, nearest_rank, sorted};
use crate::report::flight::{FlightFilm, curves};
use crate::report::html::paragraph;
use crate::sim::Course;
use crate::sim::flight::{Cost, FRAME_S, FlightConfig, Outcome, Record};

/// The width of the plots, pixels.
const CURVES: f64 = 520.0;

/// A flight, possibly cut short.
#[derive(Clone, Copy, Debug)]
pub struct DemoFlight<'a> {
    /// The course flown through.
    pub course: &'a Course,
    /// The flight's configuration.
    pub config: &'a FlightConfig,
    /// The adapter that rendered the images and computed the flow, as text for people.
    pub adapter: &'a str,
    /// Why it differs from the pair's adapter; `None` if it does not.
    pub why: Option<&'a str>,
    /// The records of all frames.
    pub records: &'a [Record],
    /// The cost of each frame, in order.
    pub costs: &'a [Cost],
    /// How the flight ended; `None` if it was still flying.
    pub outcome: Option<Outcome>,
    /// The film of the flight.
    pub film: &'a FlightFilm,
}

/// A part of a frame: its name, and its time in milliseconds.
type Part = (&'static str, fn(&Cost) -> f64);

/// The parts of a frame's cost.
const PARTS: [Part; 3] = [
    ("rendering", |cost| 1e3 * cost.sensor.as_secs_f64()),
    ("image to sectors", |cost| 1e3 * cost.pipeline.as_secs_f64()),
    ("sectors to command", |cost| 1e3 * cost.steer.as_secs_f64()),
];

impl DemoFlight<'_> {
    pub(super) fn about(&self) -> String {
        format!(
            "A fixed wing of {:.1} m span flies through the simulated world “{}”, seed {}, at {} m/s. It has one \
             camera, a gyro and an airspeed sensor, and knows the direction of its goal; every image is rendered at \
             its present position. The flow of each pair gives the times to contact of all sectors, and these the \
             arc that it flies next.",
            2.0 * self.config.radius_m,
            self.course.name,
            self.course.seed,
            self.config.speed_m_s,
        )
    }

    pub(super) fn curves(&self) -> String {
        let about = "Time to contact ahead, measured and true, and the bank angle commanded and flown; positive is \
                     the right wing down. The line marks the frame shown.";
        let curves = curves::contact_and_bank(self.records, CURVES).concat();
        format!("{}<div class=\"curves\">\n{curves}</div>\n", paragraph(about))
    }

    pub(super) fn state(&self) -> String {
        let time_s = self.records.len() as f64 * FRAME_S;
        match self.outcome {
            Some(outcome) => outcome.to_string(),
            None => format!("{time_s:.0} s without a crash"),
        }
    }

    pub(super) fn clearance_m(&self) -> f64 {
        self.records.iter().map(|record| record.clearance_m).fold(f64::INFINITY, f64::min)
    }

    /// The median time from an image to a command.
    pub(super) fn onboard_ms(&self) -> Option<f64> {
        let onboard = |cost: &Cost| 1e3 * (cost.pipeline + cost.steer).as_secs_f64();
        median(self.costs.iter().map(onboard))
    }

    /// The camera, the sectors and the frames, in numbers.
    pub(super) fn size(&self) -> String {
        let [columns, rows] = self.config.pipeline.sphere.sectors;
        format!(
            "camera of {}, {columns} × {rows} sectors, {:.0} images per second, {} frames",
            self.config.camera.size,
            1.0 / FRAME_S,
            self.records.len(),
        )
    }

    /// The rows of the table for the cost of a frame and its parts.
    pub(super) fn cost_rows(&self) -> Vec<(&'static str, String)> {
        let spread = |of: &dyn Fn(&Cost) -> f64| {
            let times = sorted(self.costs.iter().map(of));
            let [median, high] = [500, 990].map(|rank| nearest_rank(&times, rank).unwrap_or(f64::NAN));
            (median, format!("median {median:.2} ms, 99th percentile {high:.2} ms"))
        };
        let mut rows = PARTS.map(|(name, part)| (name, spread(&part).1)).to_vec();
        let (median, text) = spread(&|cost| 1e3 * cost.total().as_secs_f64());
        rows.push((
            "whole frame, with the vehicle's motion",
            format!("{text}; {:.0} frames per second", 1e3 / median),
        ));
        rows
    }
}
