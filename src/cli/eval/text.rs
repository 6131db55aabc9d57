//! The tables as text and as CSV.

use super::columns::{CLASSES, CONFIDENCE, Column, ERRORS, cell, filled};
use crate::cli::print;
use crate::eval::{Row, Table};
use crate::text::counted;

/// A set of more pairs has no table with a column for each.
const MOST_PAIRS: usize = 8;

/// The tables for a terminal.
pub(super) fn text(table: &Table) -> String {
    let Some(baseline) = &table.baseline else { return "no results".to_owned() };
    let mut text =
        format!("on {}; × is the geometric mean of ratios to {baseline}\n", table.adapters.join(" and "));
    for set in table.sets.chunk_by(|a, b| a.set == b.set) {
        let name = set[0].set.as_deref().unwrap_or_default();
        text += &part(name, set);
        let pairs: Vec<&Row> = table.pairs.iter().filter(|row| row.set == set[0].set).collect();
        text += &by_pair(&pairs);
        for Failure { pair, runs, reason } in failures(&pairs) {
            text += &format!("failed  {pair} with {}: {reason}\n", runs.join(", "));
        }
    }
    if table.sets.iter().any(|row| row.set != table.sets[0].set) {
        text += &part("total", &table.total);
    }
    text
}

/// The tables of one set.
fn part(name: &str, rows: &[Row]) -> String {
    let pairs = rows.iter().map(|row| row.scored + row.failed).max().unwrap_or(0);
    let mut text = format!("\n{name}, {}\n", counted(pairs, "pair"));
    let rows: Vec<&Row> = rows.iter().collect();
    text += &grid("run", &ERRORS, &rows);
    text += &grid("AEE px by class", &CLASSES, &rows);
    text + &grid("confidence", &CONFIDENCE, &rows)
}

fn grid(corner: &str, columns: &[Column], rows: &[&Row]) -> String {
    let columns = filled(columns, rows);
    if columns.is_empty() {
        return String::new();
    }
    let heads = std::iter::once(corner).chain(columns.iter().map(|column| column.head));
    let mut lines = vec![heads.map(str::to_owned).collect::<Vec<_>>()];
    for row in rows {
        let cells = columns.iter().map(|column| cell(row, column));
        lines.push(std::iter::once(row.name.clone()).chain(cells).collect());
    }
    print::table(&lines)
}

/// A column for each pair: mean endpoint error in pixels and mean angular error in degrees.
fn by_pair(rows: &[&Row]) -> String {
    let mut names: Vec<&str> = rows.iter().filter_map(|row| row.pair.as_deref()).collect();
    names.dedup();
    if !(2..=MOST_PAIRS).contains(&names.len()) {
        return String::new();
    }
    let mut runs: Vec<String> = Vec::new();
    for row in rows {
        if !runs.contains(&row.name) {
            runs.push(row.name.clone());
        }
    }
    let mut lines =
        vec![std::iter::once("AEE px / AAE °").chain(names.iter().copied()).map(str::to_owned).collect()];
    for run in runs {
        let figures = |pair: &&str| {
            let row = rows.iter().find(|row| row.pair.as_deref() == Some(pair) && row.name == run);
            row.map_or_else(String::new, |row| {
                format!("{} / {}", cell(row, &ERRORS[0]), cell(row, &ERRORS[2]))
            })
        };
        let cells: Vec<String> = names.iter().map(figures).collect();
        lines.push(std::iter::once(run).chain(cells).collect());
    }
    print::table(&lines)
}

/// All rows as comma-separated values below a header: pairs, then sets, then the total. `*` stands for all pairs or sets; an
/// undefined figure is an empty cell, and `reason` tells why a pair failed.
pub(super) fn csv(table: &Table) -> String {
    let columns: Vec<&Column> = ERRORS.iter().chain(&CLASSES).chain(&CONFIDENCE).collect();
    let names = columns.iter().map(|column| column.name);
    let mut text = ["set", "pair", "run", "backend", "pairs"]
        .into_iter()
        .chain(names)
        .chain(["reason"])
        .collect::<Vec<_>>()
        .join(",")
        + "\n";
    for row in table.pairs.iter().chain(&table.sets).chain(&table.total) {
        let quoted = |name: &Option<String>| cell_of(name.as_deref().unwrap_or("*"));
        let keys = [
            quoted(&row.set),
            quoted(&row.pair),
            row.run.clone(),
            row.backend.clone(),
            row.scored.to_string(),
        ];
        let reason = row.reason.as_ref().map(|reason| cell_of(reason)).unwrap_or_default();
        let figures = columns
            .iter()
            .map(|column| (column.value)(row).map(|value| value.to_string()).unwrap_or_default());
        text += &(keys.into_iter().chain(figures).chain([reason]).collect::<Vec<_>>().join(",") + "\n");
    }
    text
}

/// A text as a cell of comma-separated values.
fn cell_of(text: &str) -> String {
    let is_plain = !text.contains([',', '"', '\n', '\r']);
    if is_plain { text.to_owned() } else { format!("\"{}\"", text.replace('"', "\"\"")) }
}

/// Runs that failed on a pair for one reason.
pub(super) struct Failure<'a> {
    pub(super) pair: &'a str,
    pub(super) runs: Vec<&'a str>,
    pub(super) reason: &'a str,
}

/// What failed among the rows of a set's pairs: a pair that cannot be read is told once, not for each run.
pub(super) fn failures<'a>(rows: &[&'a Row]) -> Vec<Failure<'a>> {
    let mut all: Vec<Failure<'a>> = Vec::new();
    for row in rows {
        let (Some(pair), Some(reason)) = (row.pair.as_deref(), row.reason.as_deref()) else { continue };
        // The rows of a pair stand together.
        let own = all.iter_mut().rev().take_while(|known| known.pair == pair);
        match own.into_iter().find(|known| known.reason == reason) {
            Some(known) => known.runs.push(&row.name),
            None => all.push(Failure { pair, runs: vec![&row.name], reason }),
        }
    }
    all
}
