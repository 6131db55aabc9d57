//! A flight as a whole, as a page.

use super::{curves, way};
use crate::report::html::{counted, figures, page, paragraph, section, tile};
use crate::sim::Course;
use crate::sim::flight::{Body, Cost, FlightConfig, Measured, Outcome, Record, Sensor, Summary};

/// A flight that is over, and what it was flown with.
#[derive(Clone, Copy, Debug)]
pub struct FlightReport<'a> {
    /// Where it led through.
    pub course: &'a Course,
    /// How it was flown.
    pub config: &'a FlightConfig,
    /// What computed, as a name for the reader.
    pub backend: &'a str,
    /// All its frames.
    pub records: &'a [Record],
    /// How it ended.
    pub summary: &'a Summary,
    /// What each frame cost, in their order; may be empty.
    pub costs: &'a [Cost],
}

impl FlightReport<'_> {
    /// The flight as one page of HTML that needs nothing beside itself: its key figures, the course with the way flown,
    /// curves over time, and a table.
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
        let about = "Solid things are gray, the middle of the way is dashed, the dotted line is the goal. The circle is the \
                     start; a cross is a crash.";
        body += &section("The way", about, &way::svg(course, self.records, summary.outcome));
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
            tile("frames without a cue", format_args!("{:.1} %", 100.0 * invalid), ""),
        ];
        let median = quantile(self.costs.iter().map(|cost| 1e3 * cost.total().as_secs_f64()).collect(), 0.5);
        let cost = median.map(|ms| tile("a frame costs", format_args!("{ms:.1} ms"), ""));
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
                    "{:.2} m, {:.1} % of what was flown",
                    summary.progress_m,
                    100.0 * summary.efficiency()
                ),
            ),
            (
                "clearance",
                format!(
                    "{:.2} m at least, below {:.2} m for a twentieth of the time; the vehicle's radius is {:.2} m",
                    summary.least_clearance_m, summary.low_clearance_m, config.radius_m
                ),
            ),
            ("roll rate, root mean square", format!("{:.1} °/s", summary.roll_rate_rad_s.to_degrees())),
            ("frames", format!("{}, {:.1} % without a cue", self.records.len(), 100.0 * summary.invalid)),
        ];
        if let Some([deviation, mean]) = summary.offset_m {
            rows.push((
                "right of the middle of the way",
                format!("{mean:.2} m in the mean, deviation {deviation:.2} m"),
            ));
        }
        let errors: Vec<f64> = self.records.iter().filter_map(curves::relative_error).map(f64::abs).collect();
        let count = errors.len();
        if let [Some(median), Some(high)] = [0.5, 0.9].map(|share| quantile(errors.clone(), share)) {
            let text = format!(
                "{:.1} % in the median, {:.1} % at the 90th percentile of {count} frames with 0.7 to 4 s to go",
                100.0 * median,
                100.0 * high
            );
            rows.push(("time to contact ahead, sectors against one ray, relative error", text));
        }
        if let Some(measured) = &summary.measured {
            rows.extend(measured_rows(measured));
        }
        let headings: Vec<f64> = self.records.iter().filter_map(|record| record.heading_error_rad).collect();
        if let Some(median) = quantile(headings, 0.5) {
            rows.push(("direction of motion, error", format!("{:.2}° in the median", median.to_degrees())));
        }
        for (name, _, part) in curves::PARTS {
            let times: Vec<f64> = self.costs.iter().map(part).collect();
            if let [Some(median), Some(high)] = [0.5, 0.99].map(|share| quantile(times.clone(), share)) {
                rows.push((
                    name,
                    format!("{median:.2} ms in the median, {high:.2} ms at the 99th percentile"),
                ));
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

/// What `measure` says, where it says something.
fn measured_rows(measured: &Measured) -> Vec<(&'static str, String)> {
    let flow = [measured.better_half_error_px, measured.trusted_error_px];
    let flow = if let [Some(better), Some(all)] = flow {
        let trusted = 100.0 * measured.trusted;
        let text = format!(
            "{better:.3} px in the better half of the trusted cells, {all:.3} px in all ({trusted:.0} %)"
        );
        Some(("flow against the true one, medians", text))
    } else {
        None
    };
    let contact = measured.contact_error.map(|error| {
        let text =
            format!("{:.1} % in {} cells with 0.7 to 4 s to go", 100.0 * error, measured.contact_cells);
        ("time to contact against the true one, cell by cell, median", text)
    });
    flow.into_iter().chain(contact).collect()
}

/// What flies, and in what air.
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
        Sensor::Images => "rendered pictures",
    }
}

/// The value that this share of all lie below; none of none.
pub(in crate::report) fn quantile(mut values: Vec<f64>, share: f64) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(((values.len().max(1) - 1) as f64 * share).round() as usize).copied()
}
