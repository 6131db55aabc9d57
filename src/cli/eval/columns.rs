//! The columns of the tables.

use crate::eval::{Bad, Class, FlowError, Row};

/// A column: its head for people, its name in CSV, the number of decimals for people, and the value of a row.
#[derive(Clone, Copy)]
pub(super) struct Column {
    pub(super) head: &'static str,
    pub(super) name: &'static str,
    pub(super) decimals: usize,
    pub(super) value: fn(&Row) -> Option<f64>,
    /// Whether the least value is the best one, or the largest, or neither.
    pub(super) best: Best,
}

/// Which value of a column is the best one.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Best {
    Least,
    Largest,
    Neither,
}

const fn column(
    head: &'static str,
    name: &'static str,
    decimals: usize,
    best: Best,
    value: fn(&Row) -> Option<f64>,
) -> Column {
    Column { head, name, decimals, value, best }
}

/// A number, unless it is NaN.
fn some(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

fn all(row: &Row, figure: fn(FlowError) -> f64) -> Option<f64> {
    row.score.class(Class::All).and_then(|tally| some(figure(tally.error())))
}

fn area(row: &Row, of: Bad) -> Option<f64> {
    Some(row.score.confidence()?.roc(of)?.area())
}

fn missed(row: &Row, of: Bad) -> Option<f64> {
    Some(100.0 * row.score.confidence()?.roc(of)?.missed(0.1))
}

/// The mean error of the best 60 % by confidence.
fn best_60(row: &Row) -> Option<f64> {
    row.score.confidence()?.sparsification().best_px().get(11).copied()
}

use Best::{Largest, Least, Neither};

/// The errors over all pixels, and the times.
pub(super) const ERRORS: [Column; 13] = [
    column("AEE px", "aee_px", 3, Least, |row| all(row, |error| error.aee_px)),
    column("± px", "aee_std_px", 3, Least, |row| all(row, |error| error.aee_std)),
    column("AAE °", "aae_deg", 2, Least, |row| all(row, |error| error.aae_deg)),
    column("± °", "aae_std_deg", 2, Least, |row| all(row, |error| error.aae_std_deg)),
    column("R1 %", "r1_percent", 2, Least, |row| all(row, |error| 100.0 * error.r1)),
    column("R3 %", "r3_percent", 2, Least, |row| all(row, |error| 100.0 * error.r3)),
    column("density %", "density_percent", 1, Largest, |row| all(row, |error| 100.0 * error.density)),
    column("ms", "wall_ms", 1, Least, |row| row.time.map(|time| time.wall_ms)),
    column("CPU ms", "processor_ms", 1, Least, |row| row.time.and_then(|time| time.processor_ms)),
    column("×AEE", "aee_ratio", 3, Least, |row| row.ratios.aee),
    column("×AAE", "aae_ratio", 3, Least, |row| row.ratios.aae),
    column("×ms", "time_ratio", 2, Least, |row| row.ratios.time),
    column("failed", "failed", 0, Neither, |row| (row.failed > 0).then_some(row.failed as f64)),
];

/// How well the confidence tells bad pixels.
pub(super) const CONFIDENCE: [Column; 8] = [
    column("bad %", "bad_percent", 1, Least, |row| row.score.confidence().map(|score| 100.0 * score.bad())),
    column("AUC", "auc", 3, Largest, |row| area(row, Bad::Everywhere)),
    column("AUC solid", "auc_solid", 3, Largest, |row| sky(row).and_then(|()| area(row, Bad::Solid))),
    column("AUC sky", "auc_sky", 3, Largest, |row| area(row, Bad::Sky)),
    column("missed %", "missed_percent", 1, Least, |row| missed(row, Bad::Everywhere)),
    column("missed sky %", "missed_sky_percent", 1, Least, |row| missed(row, Bad::Sky)),
    column("best 60 % px", "best_60_px", 3, Least, best_60),
    column("over oracle px", "sparsification_px", 3, Least, |row| {
        row.score.confidence().map(|score| score.sparsification().area_px())
    }),
];

/// Whether a row has pixels of the sky.
fn sky(row: &Row) -> Option<()> {
    row.score.class(Class::Sky).map(|_| ())
}

macro_rules! classes {
    ($($class:ident: $head:literal, $name:literal);* $(;)?) => {
        [$(column($head, $name, 3, Least, |row| {
            row.score.class(Class::$class).and_then(|tally| some(tally.error().aee_px))
        })),*]
    };
}

/// The mean endpoint error of each class.
pub(super) const CLASSES: [Column; 16] = classes! {
    Slow: "<10 px", "aee_slow_px";
    Medium: "10–40", "aee_medium_px";
    Fast: ">40", "aee_fast_px";
    Edge: "edge <3", "aee_edge_px";
    NearEdge: "3–10", "aee_near_edge_px";
    Far: "far", "aee_far_px";
    Flat: "flat", "aee_flat_px";
    Textured: "textured", "aee_textured_px";
    Occluded: "occluded", "aee_occluded_px";
    Visible: "visible", "aee_visible_px";
    Inside: "inside", "aee_inside_px";
    Leaving: "leaving", "aee_leaving_px";
    DepthEdge: "depth edge", "aee_depth_edge_px";
    Thin: "thin", "aee_thin_px";
    Calm: "calm", "aee_calm_px";
    Sky: "sky", "aee_sky_px";
};

/// The columns in which a row has a value.
pub(super) fn filled(columns: &[Column], rows: &[&Row]) -> Vec<Column> {
    columns.iter().filter(|column| rows.iter().any(|row| (column.value)(row).is_some())).copied().collect()
}

/// The figure of a row, or a dash if it has none.
pub(super) fn cell(row: &Row, column: &Column) -> String {
    let decimals = column.decimals;
    (column.value)(row).map_or_else(|| "–".to_owned(), |value| format!("{value:.decimals$}"))
}
