//! The comparison as text.

use crate::cli::print::table;
use crate::crosscheck::{Report, Spread, StepFigures};

/// The results as tables: the worst step of each kernel, or every step.
pub(super) fn text(report: &Report, steps: bool) -> String {
    let mut text = format!("{}×{} on {} against the CPU\n\n", report.width, report.height, report.adapter);
    if steps {
        let mut rows = vec![head("step")];
        let name = |step: &StepFigures| format!("{} ({}): {}", step.kernel, step.step, step.output);
        rows.extend(report.steps.iter().map(|s| row(name(s), s, s.spread, s.breaches)));
        text += &format!("{}\n", table(&rows));
    }
    let mut rows = vec![head("kernel, worst of its steps")];
    let mut seen: Vec<&str> = Vec::new();
    for step in &report.steps {
        if !seen.contains(&step.kernel) {
            seen.push(step.kernel);
            rows.push(worst_of(step, &report.steps));
        }
    }
    text += &table(&rows);
    for step in &report.steps {
        if let Some(w) = &step.worst {
            text += &format!(
                "beyond the bound: {} ({}), {} at column {}, row {}, channel {}: CPU {:e}, GPU {:e}, bound {:e} ({})\n",
                step.kernel,
                step.step,
                step.output,
                w.column,
                w.row,
                w.channel,
                w.cpu,
                w.gpu,
                w.bound,
                step.reason,
            );
        }
    }
    let none = || "none".to_owned();
    text += &format!(
        "\nflow, computed independently: max {:.2e} px, 99.9 % within {:.2e} px, mean {:.2e} px\n\
         first step with any difference: {}\nfirst step beyond its bound when errors accumulate, which is no failure: {}\n{}\n",
        report.flow.max,
        report.flow.p999,
        report.flow.mean,
        report.first_difference.clone().unwrap_or_else(none),
        report.first_beyond_bound.clone().unwrap_or_else(none),
        match report.breaches {
            0 => "every value of every step is within its bound".to_owned(),
            count => format!("FAILED: {count} values are beyond their bounds"),
        },
    );
    text
}

fn head(first: &str) -> Vec<String> {
    [first, "max", "p99.9", "mean", "bound", "of bound", "breaches"].map(str::to_owned).to_vec()
}

fn worst_of(first: &StepFigures, all: &[StepFigures]) -> Vec<String> {
    let same = || all.iter().filter(|step| step.kernel == first.kernel);
    let spread = Spread {
        max: same().map(|s| s.spread.max).fold(0.0, f32::max),
        p999: same().map(|s| s.spread.p999).fold(0.0, f32::max),
        mean: same().map(|s| s.spread.mean).fold(0.0, f64::max),
    };
    // Show the bound of the step that uses the most of it.
    let step = same().max_by(|a, b| a.share_of_bound.total_cmp(&b.share_of_bound)).unwrap_or(first);
    row(first.kernel.to_owned(), step, spread, same().map(|s| s.breaches).sum())
}

fn row(name: String, step: &StepFigures, spread: Spread, breaches: usize) -> Vec<String> {
    let bound = match (&step.bound_own, step.bound_absolute, step.bound_relative) {
        (Some(own), ..) => format!("per value, median {:.1e}", own.median),
        (None, 0.0, 0.0) => "0".to_owned(),
        (None, absolute, 0.0) => format!("{absolute:.1e}"),
        (None, 0.0, relative) => format!("{relative:.1e}·|x|"),
        (None, absolute, relative) => format!("{absolute:.1e} + {relative:.1e}·|x|"),
    };
    vec![
        name,
        format!("{:.2e}", spread.max),
        format!("{:.2e}", spread.p999),
        format!("{:.2e}", spread.mean),
        bound,
        format!("{:.0} %", 100.0 * step.share_of_bound),
        breaches.to_string(),
    ]
}
