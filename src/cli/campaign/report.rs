//! A campaign's table, written to files and to standard output.

use std::path::Path;

use crate::cli::print;
use crate::error::Result;
use crate::io::write_bytes;
use crate::report::{CampaignRow, campaign_page};
use crate::sim::campaign::{Row, Table};

/// The files of the table.
pub(super) const FILES: [&str; 3] = ["table.csv", "table.json", "report.html"];

/// Writes the table in every format.
pub(super) fn write(folder: &Path, table: &Table) -> Result<()> {
    let texts = [table.csv(), print::pretty(table)? + "\n", html(table)];
    for (name, text) in FILES.into_iter().zip(texts) {
        write_bytes(folder.join(name), text.as_bytes())?;
    }
    Ok(())
}

/// The table as text.
pub(super) fn text(table: &Table) -> String {
    let (keys, same) = keys(table);
    let columns: Vec<Column> = keys.into_iter().chain(FIGURES).collect();
    let mut lines = vec![columns.iter().map(|(name, _)| (*name).to_owned()).collect()];
    lines.extend(table.rows.iter().map(|row| cells(row, &columns)));
    format!("{same}\n{}", print::table(&lines))
}

/// The table as an HTML page.
fn html(table: &Table) -> String {
    let (keys, same) = keys(table);
    let row = |row: &Row| CampaignRow {
        labels: cells(row, &keys),
        flights: row.flights,
        failed: row.failed,
        reached: row.reached,
        crashed: row.crashed,
        left_band: row.left_band,
        timed_out: row.timed_out,
        interval: [row.success_low, row.success_high],
        least_clearance_mean_m: row.least_clearance_mean_m,
        least_clearance_p5_m: row.least_clearance_p5_m,
        efficiency: row.efficiency,
        between_touches_m: row.between_touches_m,
        progress: row.progress,
        optimality: row.optimality,
        goal_speed_m_s: row.goal_speed_m_s,
        energy_hz2: row.energy_hz2,
    };
    let names: Vec<&str> = keys.iter().map(|(name, _)| *name).collect();
    campaign_page("Campaign", &same, &names, &table.rows.iter().map(row).collect::<Vec<_>>())
}

/// The key columns whose values differ between rows, and a text with the values that all rows share.
fn keys(table: &Table) -> (Vec<Column>, String) {
    let is_same = |(name, value): &Column| {
        *name != "world" && table.rows.windows(2).all(|pair| value(&pair[0]) == value(&pair[1]))
    };
    let (alike, keys): (Vec<Column>, Vec<Column>) = KEYS.into_iter().partition(is_same);
    let first = table.rows.first();
    let same = alike.iter().filter_map(|(name, value)| Some(format!("{name} {}", value(first?))));
    let adapters = (!table.adapters.is_empty()).then(|| format!("flow on {}", table.adapters.join(" and ")));
    (keys, same.chain(adapters).collect::<Vec<_>>().join(", "))
}

fn cells(row: &Row, columns: &[Column]) -> Vec<String> {
    columns.iter().map(|(_, value)| value(row)).collect()
}

type Column = (&'static str, fn(&Row) -> String);

/// The columns of a row's key.
const KEYS: [Column; 8] = [
    ("world", |row| row.world.clone()),
    ("sensor", |row| row.sensor.clone()),
    ("policy", |row| row.policy.clone()),
    ("danger", |row| row.danger.clone()),
    ("speed m/s", |row| row.speed_m_s.to_string()),
    ("size", |row| row.size.clone()),
    ("latency", |row| row.latency_frames.to_string()),
    ("faults", |row| row.faults.clone()),
];

/// The columns of a row's figures.
const FIGURES: [Column; 13] = [
    ("flights", |row| row.flights.to_string()),
    ("success", |row| some(row.success, 3)),
    ("95 %", |row| format!("{:.3}–{:.3}", row.success_low, row.success_high)),
    ("crashed", |row| row.crashed.to_string()),
    ("left band", |row| row.left_band.to_string()),
    ("timed out", |row| row.timed_out.to_string()),
    ("failed", |row| row.failed.to_string()),
    ("clear m", |row| some(row.least_clearance_mean_m, 2)),
    ("5 %", |row| some(row.least_clearance_p5_m, 2)),
    ("efficiency", |row| some(row.efficiency, 3)),
    ("m/touch", |row| some(row.between_touches_m, 0)),
    ("roll °/s", |row| some(row.roll_rate_rad_s.map(f64::to_degrees), 1)),
    ("no cue", |row| some(row.invalid, 3)),
];

/// A figure with `decimals` decimals, or a dash if there is none.
fn some(value: Option<f64>, decimals: usize) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{value:.decimals$}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(world: &str, policy: &str) -> Row {
        Row {
            world: world.to_owned(),
            sensor: "depth".to_owned(),
            policy: policy.to_owned(),
            danger: "nearness".to_owned(),
            speed_m_s: 12.0,
            size: "320x240".to_owned(),
            latency_frames: 1,
            faults: "none".to_owned(),
            flights: 2,
            failed: 0,
            reached: 1,
            crashed: 1,
            left_band: 0,
            timed_out: 0,
            success: Some(0.5),
            success_low: 0.1,
            success_high: 0.9,
            least_clearance_mean_m: Some(1.0),
            least_clearance_p5_m: Some(0.5),
            efficiency: None,
            touches: 1,
            between_touches_m: None,
            progress: Some(0.9),
            optimality: None,
            goal_speed_m_s: None,
            energy_hz2: Some(2.0),
            without_way: 0,
            path_m: 100.0,
            roll_rate_rad_s: Some(0.1),
            invalid: Some(0.01),
            offset_mean_m: None,
            offset_std_m: None,
        }
    }

    #[test]
    fn what_is_the_same_for_all_rows_stands_above() {
        let table = Table { adapters: Vec::new(), rows: vec![row("wall", "none"), row("wall", "arc")] };
        let text = text(&table);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(
            lines[0],
            "sensor depth, danger nearness, speed m/s 12, size 320x240, latency 1, faults none"
        );
        assert!(lines[1].starts_with("world  policy  flights  success"), "{text}");
        assert!(lines[3].starts_with("wall      arc        2    0.500"), "{text}");
        assert_eq!(lines.len(), 4);
    }
}
