//! Plots over the time of a flight.

use super::page::FlightReport;
use crate::quantile::{nearest, sorted};
use crate::report::html::section;
use crate::report::plot::{Curve, Plot, Span, WIDE, range};
use crate::sim::flight::{Cost, FRAME_S, Record};
use crate::steer::Source;

/// The height of the plots and of the strip, pixels.
const HEIGHT: f64 = 190.0;
const STRIP: f64 = 90.0;
/// The longest time to contact shown, seconds.
const FAR_S: f64 = 8.0;
/// The true times to contact for which the relative error is computed, seconds.
const COUNTED_S: [f64; 2] = [0.7, 4.0];

type Part = (&'static str, &'static str, fn(&Cost) -> f64);

/// The parts of a frame's cost: name, CSS class, and time in milliseconds.
pub(super) const PARTS: [Part; 4] = [
    ("rendering or true flow", "c0", |cost| 1e3 * cost.sensor.as_secs_f64()),
    ("image to sectors", "c1", |cost| 1e3 * cost.pipeline.as_secs_f64()),
    ("steering", "c2", |cost| 1e3 * cost.steer.as_secs_f64()),
    ("vehicle", "c3", |cost| 1e3 * cost.vehicle.as_secs_f64()),
];

/// The relative error of the view's time to contact, for true times in [`COUNTED_S`].
pub(super) fn relative_error(record: &Record) -> Option<f64> {
    let true_s = record.true_contact_s.filter(|true_s| (COUNTED_S[0]..=COUNTED_S[1]).contains(true_s))?;
    Some(record.contact_s? / true_s - 1.0)
}

/// The plots, under headings.
pub(super) fn sections(report: &FlightReport<'_>) -> String {
    let over = Over { records: report.records, end_s: report.summary.time_s.max(FRAME_S), width: WIDE };
    let mut html = section(
        "Clearance and altitude",
        "Distance from the vehicle's centre to the nearest surface, and height above the ground.",
        &(over.clearance(report) + &over.altitude(report)),
    );
    html += &section(
        "Control",
        "The bank angle commanded and flown; positive is the right wing down.",
        &over.bank(),
    );
    html += &section(
        "Time to contact",
        "Along the direction of motion. The measured time is the median of the sectors around it; the true time is that of a \
         single ray, which may pass beside a thin obstacle. The relative error is shown where the true time is 0.7 to 4 s, \
         clamped to ±50 %. It does not measure the flow: fly --measure compares that cell by cell.",
        &(over.contact() + &over.error()),
    );
    html += &section(
        "Cues and faults",
        "Red: no valid cue, wings level. Amber: no valid cue, last command held. Violet: a fault is active. The curve is the \
         share of the view that is trusted.",
        &over.validity(report),
    );
    if !report.costs.is_empty() {
        let about = "Measured during the flight; the line is the frame interval.";
        html += &section("Computing time per frame", about, &over.cost(report.costs));
    }
    html
}

/// The time to contact ahead, and the bank, as plots of this width.
#[cfg(feature = "io")]
pub(in crate::report) fn contact_and_bank(records: &[Record], width: f64) -> [String; 2] {
    let end_s = records.last().map_or(FRAME_S, |record| record.time_s.max(FRAME_S));
    let over = Over { records, end_s, width };
    [over.contact(), over.bank()]
}

/// Plots over the time of a flight.
struct Over<'a> {
    records: &'a [Record],
    end_s: f64,
    /// The width of each plot.
    width: f64,
}

impl<'a> Over<'a> {
    fn curve<'b>(&self, name: &'b str, class: &'static str, of: impl Fn(&Record) -> f64) -> Curve<'b> {
        Curve { name, class, points: self.records.iter().map(|r| [r.time_s, of(r)]).collect() }
    }

    fn plot<'b>(&self, title: &'b str, unit: &'b str, y: [f64; 2], curves: Vec<Curve<'b>>) -> Plot<'b> {
        let x = [0.0, self.end_s];
        let size = [self.width, HEIGHT];
        Plot { title, unit, x, y, size, curves, levels: Vec::new(), spans: Vec::new() }
    }

    fn clearance(&self, report: &FlightReport<'_>) -> String {
        let curve = self.curve("clearance", "c0", |record| record.clearance_m);
        let [_, high] = range(self.records.iter().map(|record| record.clearance_m), 2.0);
        let levels = vec![(report.config.radius_m, "vehicle radius")];
        Plot { levels, ..self.plot("Clearance", "m", [0.0, high], vec![curve]) }.svg()
    }

    fn altitude(&self, report: &FlightReport<'_>) -> String {
        let curve = self.curve("altitude", "c2", |record| -record.position_ned_m.z);
        let [low, high] = report.course.altitude_m;
        let y = range(self.records.iter().map(|record| -record.position_ned_m.z), 4.0);
        let all = [(low, "lower limit"), (high, "upper limit")];
        let levels = all.into_iter().filter(|(level, _)| (y[0]..=y[1]).contains(level)).collect();
        Plot { levels, ..self.plot("Altitude", "m", y, vec![curve]) }.svg()
    }

    fn bank(&self) -> String {
        let curves = vec![
            self.curve("commanded", "c1", |record| record.acting.bank_rad.to_degrees()),
            self.curve("flown", "c0", |record| record.roll_pitch_yaw_rad[0].to_degrees()),
        ];
        let values = curves.iter().flat_map(|curve| curve.points.iter().map(|[_, y]| *y));
        let y = range(values.collect::<Vec<_>>().into_iter(), 20.0);
        self.plot("Bank", "degrees", y, curves).svg()
    }

    fn contact(&self) -> String {
        let near = |time_s: Option<f64>| time_s.filter(|time_s| *time_s <= FAR_S).unwrap_or(f64::NAN);
        let curves = vec![
            self.curve("true", "c0", |record| near(record.true_contact_s)),
            self.curve("measured", "c1", |record| near(record.contact_s)),
        ];
        self.plot("Time to contact ahead", "s", [0.0, FAR_S], curves).svg()
    }

    fn error(&self) -> String {
        let error = |record: &Record| 100.0 * relative_error(record).unwrap_or(f64::NAN);
        let curve = self.curve("relative error", "c4", error);
        let levels = vec![(10.0, "10 %"), (-10.0, "−10 %")];
        Plot { levels, ..self.plot("Relative error", "%", [-50.0, 50.0], vec![curve]) }.svg()
    }

    fn validity(&self, report: &FlightReport<'_>) -> String {
        let curve = self.curve("trusted", "c2", |record| record.coverage);
        let mut spans: Vec<Span> = (report.config.faults.iter())
            .map(|fault| Span {
                from: fault.from_s,
                to: fault.until_s,
                class: "fault",
                name: fault.to_string(),
            })
            .collect();
        let alike = |a: &Record, b: &Record| a.source == b.source && a.invalid == b.invalid;
        for part in self.records.chunk_by(alike) {
            let class = match (part[0].source, &part[0].invalid) {
                (Source::Cue, None) => continue,
                (Source::Recovery, _) => "bad",
                (Source::Held | Source::Cue, _) => "warn",
            };
            let name = part[0].invalid.clone().unwrap_or_default();
            spans.push(Span { from: part[0].time_s, to: part[part.len() - 1].time_s + FRAME_S, class, name });
        }
        let size = [self.width, STRIP];
        Plot { size, spans, ..self.plot("Trusted share of the view", "", [0.0, 1.0], vec![curve]) }.svg()
    }

    fn cost(&self, costs: &[Cost]) -> String {
        let times = || self.records.iter().map(|record| record.time_s).zip(costs);
        let curves: Vec<Curve<'_>> = PARTS
            .into_iter()
            .map(|(name, class, part)| Curve {
                name,
                class,
                points: times().map(|(time_s, cost)| [time_s, part(cost)]).collect(),
            })
            .collect();
        let totals = sorted(costs.iter().map(|cost| 1e3 * cost.total().as_secs_f64()));
        // A few slow frames, such as the first one, must not compress the rest.
        let high = nearest(&totals, 0.99).unwrap_or(0.0).max(1.1e3 * FRAME_S);
        let levels = vec![(1e3 * FRAME_S, "frame interval")];
        Plot { levels, ..self.plot("Computing time", "ms", [0.0, high], curves) }.svg()
    }
}
