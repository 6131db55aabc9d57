//! A flight that is steered by flow.

use crate::quantile::{median, nearest, sorted};
use crate::report::flight::{FlightFilm, curves};
use crate::report::html::paragraph;
use crate::sim::Course;
use crate::sim::flight::{Cost, FRAME_S, FlightConfig, Outcome, Record};

/// Width of the drawings of the curves.
const CURVES: f64 = 520.0;

/// A flight, or its beginning.
#[derive(Clone, Copy, Debug)]
pub struct DemoFlight<'a> {
    /// Where it led through.
    pub course: &'a Course,
    /// How it was flown.
    pub config: &'a FlightConfig,
    /// What drew the pictures and computed the flow.
    pub adapter: &'a str,
    /// Why that is another one than the pair's, if it is.
    pub why: Option<&'a str>,
    /// All its frames.
    pub records: &'a [Record],
    /// What each frame cost, in their order.
    pub costs: &'a [Cost],
    /// How it ended, if it did.
    pub outcome: Option<Outcome>,
    /// What there is to see.
    pub film: &'a FlightFilm,
}

/// A part of a frame: its name, and its time in milliseconds.
type Part = (&'static str, fn(&Cost) -> f64);

/// What the parts of a frame cost, and what they are called.
const PARTS: [Part; 3] = [
    ("picture rendered", |cost| 1e3 * cost.sensor.as_secs_f64()),
    ("picture to sectors", |cost| 1e3 * cost.pipeline.as_secs_f64()),
    ("sectors to command", |cost| 1e3 * cost.steer.as_secs_f64()),
];

impl DemoFlight<'_> {
    pub(super) fn about(&self) -> String {
        format!(
            "A fixed wing of {:.1} m span flies through the made-up world “{}”, seed {}, at {} m/s. It has one camera, a gyro and an \
             airspeed sensor, and knows the direction of its goal; every picture is rendered where it has flown to. From the flow \
             of each pair follow the times to contact of all sectors, from these the arc that it flies next.",
            2.0 * self.config.radius_m,
            self.course.name,
            self.course.seed,
            self.config.speed_m_s,
        )
    }

    pub(super) fn curves(&self) -> String {
        let about = "Time to contact ahead, as the view says and in truth, and the bank that is commanded and flown; positive is the \
                     right wing down. The line is the frame that is shown.";
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

    /// From a picture to a command, in the median.
    pub(super) fn onboard_ms(&self) -> Option<f64> {
        let onboard = |cost: &Cost| 1e3 * (cost.pipeline + cost.steer).as_secs_f64();
        median(self.costs.iter().map(onboard))
    }

    /// What was flown, in numbers.
    pub(super) fn size(&self) -> String {
        let [columns, rows] = self.config.pipeline.sphere.sectors;
        format!(
            "camera of {}, {columns} × {rows} sectors, {:.0} pictures a second, {} frames",
            self.config.camera.size,
            1.0 / FRAME_S,
            self.records.len(),
        )
    }

    /// What the parts of a frame cost, and all of it.
    pub(super) fn cost_rows(&self) -> Vec<(&'static str, String)> {
        let spread = |of: &dyn Fn(&Cost) -> f64| {
            let times = sorted(self.costs.iter().map(of));
            let [median, high] = [0.5, 0.99].map(|share| nearest(&times, share).unwrap_or(f64::NAN));
            (median, format!("{median:.2} ms in the median, {high:.2} ms at the 99th percentile"))
        };
        let mut rows = PARTS.map(|(name, part)| (name, spread(&part).1)).to_vec();
        let (median, text) = spread(&|cost| 1e3 * cost.total().as_secs_f64());
        rows.push((
            "all of a frame, the vehicle's motion too",
            format!("{text}; {:.0} frames a second", 1e3 / median),
        ));
        rows
    }
}
