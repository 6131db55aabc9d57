//! The tables and error maps as an HTML page.

use std::path::Path;

use super::columns::{Best, CLASSES, CONFIDENCE, Column, ERRORS, cell, filled};
use super::maps::{Maps, Shown};
use super::text::{Failure, failures};
use crate::error::Result;
use crate::eval::{Bad, PairResult, Row, STEPS, Table};
use crate::io::picture;
use crate::report::{EvalCurves, EvalImage, EvalPage, EvalPair, EvalSet, EvalTable};
use crate::text::counted;

/// The page.
pub(super) fn html(table: &Table, results: &[&PairResult], maps: &Maps) -> Result<String> {
    let mut sets = Vec::new();
    for rows in table.sets.chunk_by(|a, b| a.set == b.set) {
        let name = rows[0].set.as_deref().unwrap_or_default();
        let own: Vec<&PairResult> = results.iter().filter(|result| result.job.set == name).copied().collect();
        let mut set = part(name, rows);
        let rows: Vec<&Row> = table.pairs.iter().filter(|row| row.set.as_deref() == Some(name)).collect();
        set.failures = failures(&rows)
            .into_iter()
            .map(|Failure { pair, runs, reason }| [pair.to_owned(), runs.join(", "), reason.to_owned()])
            .collect();
        for pair in own.chunk_by(|a, b| a.job.pair == b.job.pair) {
            if maps.has(name, &pair[0].job.pair, Shown::FirstFrame) {
                set.pairs.extend(images(&rows, pair, maps)?);
            }
        }
        sets.push(set);
    }
    if sets.len() > 1 {
        sets.insert(0, part("all data sets", &table.total));
    }
    let by = format!("viewsphere {}", env!("CARGO_PKG_VERSION"));
    let about = match &table.baseline {
        None => format!("No results, by {by}."),
        Some(baseline) => format!(
            "Computed on {} by {by}. Figures are over the pixels of all pairs; × is the geometric mean over the pairs of the \
             ratio to {baseline}. The best of each column is bold.",
            table.adapters.join(" and "),
        ),
    };
    Ok(EvalPage { about, sets }.html())
}

fn part(name: &str, rows: &[Row]) -> EvalSet {
    let pairs = rows.iter().map(|row| row.scored + row.failed).max().unwrap_or(0);
    let rows: Vec<&Row> = rows.iter().collect();
    let tables = [
        (
            "Errors over all pixels (AEE: mean endpoint error, AAE: mean angular error, R1 and R3: off by over 1 and 3 px) and time per pair",
            &ERRORS[..],
        ),
        (
            "Mean endpoint error in px by displacement, distance from motion edges in px, texture, occlusion and depth",
            &CLASSES[..],
        ),
        (
            "How well the confidence tells bad pixels: area under the ROC, bad pixels missed at 10 % false alarms",
            &CONFIDENCE[..],
        ),
    ];
    EvalSet {
        name: name.to_owned(),
        about: counted(pairs, "pair"),
        tables: tables.into_iter().filter_map(|(about, columns)| grid(about, columns, &rows)).collect(),
        curves: rows.iter().filter_map(|row| curves(row)).collect(),
        failures: Vec::new(),
        pairs: Vec::new(),
    }
}

fn grid(about: &str, columns: &[Column], rows: &[&Row]) -> Option<EvalTable> {
    let columns = filled(columns, rows);
    let best = |column: &Column| {
        let values = rows.iter().filter_map(|row| (column.value)(row));
        match column.best {
            Best::Least => values.min_by(f64::total_cmp),
            Best::Largest => values.max_by(f64::total_cmp),
            Best::Neither => None,
        }
        .filter(|best| rows.iter().any(|row| (column.value)(row).is_some_and(|value| value != *best)))
    };
    let bests: Vec<Option<f64>> = columns.iter().map(best).collect();
    let cells = |row: &&Row| {
        let figures = columns.iter().zip(&bests).map(|(column, best)| {
            let is_best = best.is_some() && (column.value)(row) == *best;
            (cell(row, column), is_best)
        });
        std::iter::once((row.name.clone(), false)).chain(figures).collect()
    };
    let heads = std::iter::once("run").chain(columns.iter().map(|column| column.head));
    (!columns.is_empty()).then(|| EvalTable {
        about: about.to_owned(),
        heads: heads.map(str::to_owned).collect(),
        rows: rows.iter().map(cells).collect(),
    })
}

fn curves(row: &Row) -> Option<EvalCurves> {
    let score = row.score.confidence()?;
    let steps = |values: &[f64]| {
        (1..).zip(values).map(|(step, px): (usize, _)| [step as f64 / STEPS as f64, *px]).collect::<Vec<_>>()
    };
    Some(EvalCurves {
        run: row.name.clone(),
        roc: score.roc(Bad::Everywhere).map(|roc| roc.points().to_vec()).unwrap_or_default(),
        best_px: steps(score.sparsification().best_px()),
        oracle_px: steps(score.sparsification().oracle_px()),
    })
}

/// The images of a pair, whose set has these rows; `None` if there are none.
fn images(rows: &[&Row], results: &[&PairResult], maps: &Maps) -> Result<Option<EvalPair>> {
    let Some(first) = results.first() else { return Ok(None) };
    let (set, pair) = (&first.job.set, &first.job.pair);
    let mut shown = vec![
        (Shown::FirstFrame, "The first frame".to_owned(), "first frame".to_owned()),
        (
            Shown::Truth,
            "The true flow as colours".to_owned(),
            "true flow; its largest displacement in full colour, black unknown".to_owned(),
        ),
    ];
    for result in results {
        let is_its = |row: &&&Row| {
            row.pair.as_ref() == Some(pair)
                && (&row.run, &row.backend) == (&result.job.run, &result.job.backend)
        };
        let row = rows.iter().find(is_its).filter(|row| row.scored > 0);
        let Some(row) = row else { continue };
        let caption = format!("{}: {} px, {}°", row.name, cell(row, &ERRORS[0]), cell(row, &ERRORS[2]));
        shown.push((Shown::Error(&result.job), format!("Error map of {}", row.name), caption));
    }
    let mut images = Vec::new();
    for (what, alt, caption) in shown {
        if let Some(bytes) = maps.get(set, pair, what) {
            let size = picture::decode(Path::new("map"), &bytes)?.size;
            images.push(EvalImage { alt, caption, size, media_type: what.media_type(), bytes });
        }
    }
    Ok((images.len() > 2).then(|| EvalPair { name: pair.clone(), images }))
}
