//! What goes out to the user: results to standard output, everything else to standard error.

use std::io::{self, ErrorKind, Write};

use serde::Serialize;

use crate::error::{Error, Result};

/// Bytes to standard output.
///
/// A reader that has gone away, such as `head`, has had enough, which is no failure.
pub(super) fn bytes(bytes: &[u8]) -> Result<()> {
    offer(bytes).map(|_| ())
}

/// The same, and whether there is still a reader: one who goes on for ever has to know.
pub(super) fn offer(bytes: &[u8]) -> Result<bool> {
    let mut out = io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Ok(()) => Ok(true),
        Err(source) if source.kind() == ErrorKind::BrokenPipe => Ok(false),
        Err(source) => Err(Error::io("standard output", source)),
    }
}

/// Text to standard output, with a line end.
pub(super) fn text(text: &str) -> Result<()> {
    bytes(format!("{}\n", text.trim_end()).as_bytes())
}

/// Figures to standard output, as JSON. What is not a number is `null` there.
pub(super) fn json(figures: &impl Serialize) -> Result<()> {
    text(&pretty(figures)?)
}

/// Figures as JSON over several lines, without their end.
pub(super) fn pretty(figures: &impl Serialize) -> Result<String> {
    to_json(serde_json::to_string_pretty(figures))
}

/// The same on one line.
pub(super) fn json_line(figures: &impl Serialize) -> Result<()> {
    text(&one_line(figures)?)
}

/// Figures as JSON on one line, without its end.
pub(super) fn one_line(figures: &impl Serialize) -> Result<String> {
    to_json(serde_json::to_string(figures))
}

fn to_json(text: serde_json::Result<String>) -> Result<String> {
    text.map_err(|error| Error::io("standard output", io::Error::other(error)))
}

/// A line to standard error. That it cannot be written there is nothing to fail for.
pub(super) fn note(text: impl std::fmt::Display) {
    let line = text.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
    let _ = writeln!(io::stderr(), "viewsphere: {line}");
}

/// Rows of cells as columns of equal width: the first one to the left, the others to the right.
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
