//! The progress bar of a sequence.

use indicatif::{ProgressBar, ProgressStyle};

/// A progress bar on standard error, where that is a terminal: of `total` such units, or a spinner if their number is unknown.
/// There is none for up to `brief` units.
pub(super) fn progress(total: Option<u64>, unit: &str, brief: u64) -> ProgressBar {
    let style = |template: &str| {
        ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
    };
    match total {
        Some(total) if total <= brief => ProgressBar::hidden(),
        Some(total) => ProgressBar::new(total)
            .with_style(style(&format!("{{bar:40}} {{pos}}/{{len}} {unit}, {{per_sec}}, {{eta}} left"))),
        None => {
            ProgressBar::new_spinner().with_style(style(&format!("{{spinner}} {{pos}} {unit}, {{per_sec}}")))
        }
    }
}
