//! The table as JSON. An undefined figure is `null`.

use std::collections::BTreeMap;

use serde::Serialize;

use super::single::FlowErrorFigures;
use crate::eval::{BAD_PX, Bad, Class, ConfidenceScore, PairTime, Ratios, Row, Table};

/// The whole table.
#[derive(Serialize)]
pub(super) struct TableFigures<'a> {
    viewsphere: &'static str,
    adapters: &'a [String],
    /// The run to which ratios are; `null` without results.
    baseline: Option<&'a str>,
    /// The endpoint error over which a pixel is bad.
    bad_px: f64,
    pairs: Vec<RowFigures<'a>>,
    sets: Vec<RowFigures<'a>>,
    total: Vec<RowFigures<'a>>,
}

#[derive(Serialize)]
struct RowFigures<'a> {
    set: Option<&'a str>,
    pair: Option<&'a str>,
    run: &'a str,
    backend: &'a str,
    scored: usize,
    failed: usize,
    /// Why a pair failed; `null` if it did not, and for rows of several pairs.
    reason: Option<&'a str>,
    /// By class.
    errors: BTreeMap<&'static str, FlowErrorFigures>,
    confidence: Option<ConfidenceFigures>,
    time: Option<PairTime>,
    ratios: Ratios,
}

#[derive(Serialize)]
struct ConfidenceFigures {
    pixels: usize,
    bad: f64,
    everywhere: RocFigures,
    solid: RocFigures,
    sky: RocFigures,
    /// The mean error of the best 5 %, 10 %, …, 100 % by the confidence.
    best_px: Vec<f64>,
    /// By the error itself.
    oracle_px: Vec<f64>,
    sparsification_px: f64,
}

#[derive(Serialize)]
struct RocFigures {
    area: Option<f64>,
    /// The share of the bad pixels that is missed at 10 % false alarms.
    missed: Option<f64>,
    /// The share of alarms for bad pixels at 0 %, 5 %, …, 100 % false alarms.
    alarms: Option<Vec<f64>>,
}

impl<'a> TableFigures<'a> {
    pub(super) fn of(table: &'a Table) -> Self {
        let rows = |rows: &'a [Row]| rows.iter().map(RowFigures::of).collect();
        Self {
            viewsphere: env!("CARGO_PKG_VERSION"),
            adapters: &table.adapters,
            baseline: table.baseline.as_deref(),
            bad_px: BAD_PX,
            pairs: rows(&table.pairs),
            sets: rows(&table.sets),
            total: rows(&table.total),
        }
    }
}

impl<'a> RowFigures<'a> {
    fn of(row: &'a Row) -> Self {
        let figures = |class: Class| Some((class.name(), row.score.class(class)?.error().into()));
        Self {
            set: row.set.as_deref(),
            pair: row.pair.as_deref(),
            run: &row.run,
            backend: &row.backend,
            scored: row.scored,
            failed: row.failed,
            reason: row.reason.as_deref(),
            errors: Class::ALL.into_iter().filter_map(figures).collect(),
            confidence: row.score.confidence().map(ConfidenceFigures::of),
            time: row.time,
            ratios: row.ratios,
        }
    }
}

impl ConfidenceFigures {
    fn of(score: &ConfidenceScore) -> Self {
        let roc = |of: Bad| {
            let roc = score.roc(of);
            let alarms = |roc: &crate::eval::Roc| {
                (0..=20).map(|step| 1.0 - roc.missed(f64::from(step) / 20.0)).collect()
            };
            RocFigures {
                area: roc.as_ref().map(crate::eval::Roc::area),
                missed: roc.as_ref().map(|roc| roc.missed(0.1)),
                alarms: roc.as_ref().map(alarms),
            }
        };
        Self {
            pixels: score.pixels(),
            bad: score.bad(),
            everywhere: roc(Bad::Everywhere),
            solid: roc(Bad::Solid),
            sky: roc(Bad::Sky),
            best_px: score.sparsification().best_px().to_vec(),
            oracle_px: score.sparsification().oracle_px().to_vec(),
            sparsification_px: score.sparsification().area_px(),
        }
    }
}
