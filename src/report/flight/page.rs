//! The page about a whole flight.

use super::{curves, way};
use crate::quantile::{nearest, nearest_rank, sorted};
use crate::report::html::{figures, page, paragraph, section, tile};
use crate::sim::Course;
use crate::sim::flight::{Body, Cost, FlightConfig, Measured, Outcome, Record, Sensor, Summary};
use crate::text::counted;

/// A completed flight.
#[derive(Clone, Copy, Debug)]
pub struct FlightReport<'a> {
    /// The course flown through.
    pub course: &'a Course,
    /// The flight's configuration.
    pub config: &'a FlightConfig,
    /// The backend that computed, as text for people.
    pub backend: &'a str,
    /// The records of all frames.
    pub records: &'a [Record],
    /// The summary.
    pub summary: &'a Summary,
    /// The cost of each frame, in order; may be empty.
    pub costs: &'a [Cost],
}

impl FlightReport<'_> {
    /// The report as a self-contained HTML page: key figures, the course with the path flown, plots over time, and a
    /// table.
    pub fn html(&self) -> String {
        let Self { course, config, summary, .. } = *self;
        let title = format!("{}, seed {}", course.name, course.seed);
        let mut body = paragraph(format_args!(
            "policy {} over {} by {}, at {} m/s; computed on {}",
            config.steer.policy,
            config.steer.danger,
            sensor(config.sensor),
            config.speed_m_s,
            self.backend,
        ));
        body += &self.tiles();
        let about = "Solids are gray, the centre line is dashed, and the dotted line is the goal. The circle is the \
                     start; a cross is a crash.";
        body += &section("Path", about, &way::svg(course, self.records, summary.outcome));
        body += &curves::sections(self);
        body += &section("Figures", "", &figures(&self.rows()));
        page(&title, &body)
    }

    fn tiles(&self) -> String {
        let Summary { outcome, time_s, progress_m, least_clearance_m, invalid, .. } = *self.summary;
        let kind = if outcome == Outcome::Reached { "good" } else { "bad" };
        let tiles = [
            tile("outcome", outcome, kind),
            tile("progress", format_args!("{progress_m:.0} of {:.0} m", self.course.length_m), ""),
            tile("time", format_args!("{time_s:.1} s"), ""),
            tile("least clearance", format_args!("{least_clearance_m:.2} m"), ""),
            tile("path efficiency", format_args!("{:.0} %", 100.0 * self.summary.efficiency()), ""),
            tile("frames without a valid cue", format_args!("{:.1} %", 100.0 * invalid), ""),
        ];
        let median =
            nearest_rank(&sorted(self.costs.iter().map(|cost| 1e3 * cost.total().as_secs_f64())), 500);
        let cost = median.map(|ms| tile("computing time per frame", format_args!("{ms:.1} ms"), ""));
        format!("<div class=\"tiles\">\n{}{}</div>\n", tiles.concat(), cost.unwrap_or_default())
    }

    fn rows(&self) -> Vec<(&'static str, String)> {
        let Self { config, summary, .. } = *self;
        let mut rows = vec![
            ("outcome", summary.outcome.to_string()),
            ("flown", format!("{:.2} m in {:.2} s", summary.path_m, summary.time_s)),
            (
                "progress",
                format!(
                    "{:.2} m, {:.1} % of the distance flown",
                    summary.progress_m,
                    100.0 * summary.efficiency()
                ),
            ),
            (
                "clearance",
                format!(
                    "least {:.2} m, 5th percentile {:.2} m; the vehicle's radius is {:.2} m",
                    summary.least_clearance_m, summary.low_clearance_m, config.radius_m
                ),
            ),
            ("roll rate, root mean square", format!("{:.1} °/s", summary.roll_rate_rad_s.to_degrees())),
            (
                "frames",
                format!("{}, {:.1} % without a valid cue", self.records.len(), 100.0 * summary.invalid),
            ),
        ];
        if let Some([deviation, mean]) = summary.offset_m {
            rows.push((
                "offset to the right of the centre line",
                format!("mean {mean:.2} m, standard deviation {deviation:.2} m"),
            ));
        }
        let errors = sorted(self.records.iter().filter_map(curves::relative_error).map(f64::abs));
        let count = errors.len();
        if let [Some(median), Some(high)] = [0.5, 0.9].map(|share| nearest(&errors, share)) {
            let text = format!(
                "median {:.1} %, 90th percentile {:.1} %, over {count} frames with 0.7 to 4 s to contact",
                100.0 * median,
                100.0 * high
            );
            rows.push(("relative error of the time to contact ahead, sectors against one ray", text));
        }
        if let Some(measured) = &summary.measured {
            rows.extend(measured_rows(measured));
        }
        let headings = sorted(self.records.iter().filter_map(|record| record.heading_error_rad));
        if let Some(median) = nearest(&headings, 0.5) {
            rows.push(("error of the direction of motion", format!("median {:.2}°", median.to_degrees())));
        }
        for (name, _, part) in curves::PARTS {
            let times = sorted(self.costs.iter().map(part));
            if let [Some(median), Some(high)] = [500, 990].map(|rank| nearest_rank(&times, rank)) {
                rows.push((name, format!("median {median:.2} ms, 99th percentile {high:.2} ms")));
            }
        }
        rows.push(("camera", format!("{}", config.camera.size)));
        rows.push(("body, air", air(config)));
        rows.push(("latency", counted(config.latency_frames as usize, "frame")));
        let faults: Vec<String> = config.faults.iter().map(ToString::to_string).collect();
        rows.push(("faults", if faults.is_empty() { "none".to_owned() } else { faults.join(", ") }));
        rows
    }
}

/// The rows for the measured flow, if there are values.
fn measured_rows(measured: &Measured) -> Vec<(&'static str, String)> {
    let flow = [measured.better_half_error_px, measured.trusted_error_px];
    let flow = if let [Some(better), Some(all)] = flow {
        let trusted = 100.0 * measured.trusted;
        let text = format!(
            "{better:.3} px in the more confident half of the trusted cells, {all:.3} px in all of them \
             ({trusted:.0} %)"
        );
        Some(("median error of the flow", text))
    } else {
        None
    };
    let contact = measured.contact_error.map(|error| {
        let text = format!(
            "{:.1} % over {} cells with 0.7 to 4 s to contact",
            100.0 * error,
            measured.contact_cells
        );
        ("median relative error of the time to contact, cell by cell", text)
    });
    flow.into_iter().chain(contact).collect()
}

/// The body and the air, as text.
fn air(config: &FlightConfig) -> String {
    let body = match config.body {
        Body::Turn(_) => "coordinated turns",
        Body::Airframe { .. } => "rigid airframe",
    };
    let [north, east, down] = config.wind_ned_m_s.to_array();
    let gusts = config.gusts.as_ref().map_or("no gusts".to_owned(), |gusts| {
        let [north, east, down] = gusts.intensity_m_s.to_array();
        format!("gusts of {north} {east} {down} m/s (standard deviation)")
    });
    let vanes = if config.vanes.is_some() { "vanes" } else { "no vanes" };
    format!("{body}; wind {north} {east} {down} m/s to north, east and down; {gusts}; {vanes}")
}

fn sensor(sensor: Sensor) -> &'static str {
    match sensor {
        Sensor::Depth => "true depth",
        Sensor::Flow => "true flow",
        Sensor::NoisyFlow => "true flow with noise",
        Sensor::Images => "rendered images",
    }
}
