//! Output to the user: results to standard output, everything else to standard error.

use std::io::{self, ErrorKind, Write};

use serde::Serialize;

use crate::error::{Error, Result};
use crate::journal::Shard;

/// Writes bytes to standard output.
///
/// A reader that closes the pipe early, such as `head`, is not an error.
pub(super) fn bytes(bytes: &[u8]) -> Result<()> {
    offer(bytes).map(|_| ())
}

/// Writes bytes to standard output, and returns whether there still is a reader: for output without an end.
pub(super) fn offer(bytes: &[u8]) -> Result<bool> {
    let mut out = io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Ok(()) => Ok(true),
        Err(source) if source.kind() == ErrorKind::BrokenPipe => Ok(false),
        Err(source) => Err(Error::io("standard output", source)),
    }
}

/// Writes text and a line end to standard output.
pub(super) fn text(text: &str) -> Result<()> {
    bytes(format!("{}\n", text.trim_end()).as_bytes())
}

/// Writes figures as JSON to standard output. NaN becomes `null`.
pub(super) fn json(figures: &impl Serialize) -> Result<()> {
    text(&pretty(figures)?)
}

/// Figures as indented JSON, without a line end.
pub(super) fn pretty(figures: &impl Serialize) -> Result<String> {
    to_json(serde_json::to_string_pretty(figures))
}

/// Writes figures as one line of JSON to standard output.
pub(super) fn json_line(figures: &impl Serialize) -> Result<()> {
    text(&one_line(figures)?)
}

/// Figures as one line of JSON, without a line end.
pub(super) fn one_line(figures: &impl Serialize) -> Result<String> {
    to_json(serde_json::to_string(figures))
}

fn to_json(text: serde_json::Result<String>) -> Result<String> {
    text.map_err(|error| Error::io("standard output", io::Error::other(error)))
}

/// Writes a line to standard error. A failure to write it is ignored.
pub(super) fn note(text: impl std::fmt::Display) {
    let line = text.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
    let _ = writeln!(io::stderr(), "viewsphere: {line}");
}

/// What to know about a pair that is computed without those before it, by an algorithm that has memory.
pub(super) fn alone(run: &str) -> String {
    format!("{run} uses earlier pairs of its stream: a pair alone, which has none, has more error")
}

/// Says that a shard of this many jobs (such as "3 pairs") has none.
pub(super) fn empty_shard(shard: Shard, all: String) {
    note(format_args!("shard {shard} of {all} is empty: there are more shards than that; nothing is run"));
}

/// Rows of cells as columns of even width: the first one left-aligned, the others right-aligned.
pub(super) fn table(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for row in rows {
        let mut line = String::new();
        for (i, (cell, width)) in row.iter().zip(&widths).enumerate() {
            if i == 0 {
                line.push_str(&format!("{cell:<width$}"));
            } else {
                line.push_str(&format!("  {cell:>width$}"));
            }
        }
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_aligned() {
        let row = |cells: [&str; 3]| cells.map(str::to_owned).to_vec();
        let text = table(&[row(["kernel", "ms", ""]), row(["é", "12.5", "x"])]);
        assert_eq!(text, "kernel    ms\né       12.5  x\n");
    }
}
