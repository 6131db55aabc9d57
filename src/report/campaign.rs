//! Many flights in one table.

use super::html::{escape, page, paragraph};
use crate::text::counted;

/// Width of an interval's drawing, pixels.
const BAR_PX: f64 = 150.0;

/// Flights of one kind in numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct CampaignRow {
    /// What they have in common, one for each of the table's labels: world, policy, sensor and the like.
    pub labels: Vec<String>,
    /// How many there were.
    pub flights: usize,
    /// How many could not be flown, because of an error; they are in no other figure.
    pub failed: usize,
    /// How many reached their goal.
    pub reached: usize,
    /// How many crashed.
    pub crashed: usize,
    /// How many left their band of altitudes.
    pub left_band: usize,
    /// How many took too long.
    pub timed_out: usize,
    /// Wilson's 95 % interval of the share that reached its goal, 0 to 1.
    pub interval: [f64; 2],
    /// The least clearance of a flight, metres: its mean over the flights.
    pub least_clearance_mean_m: Option<f64>,
    /// The same, the value that 5 % of the flights lie below.
    pub least_clearance_p5_m: Option<f64>,
    /// Progress a metre flown, 0 to 1: the mean over the flights that reached their goal.
    pub efficiency: Option<f64>,
    /// All way flown a crash, metres; none where there was no crash.
    pub between_crashes_m: Option<f64>,
}

/// A campaign as one page of HTML that needs nothing beside itself: a table with a row for each kind of flight.
///
/// `about` is a line below the title, `labels` heads the columns of [`CampaignRow::labels`]. Rows whose first label is the
/// same stand together where they follow each other.
pub fn campaign_page(title: &str, about: &str, labels: &[&str], rows: &[CampaignRow]) -> String {
    let head = |name: &&str| format!("<th class=\"label\" scope=\"col\">{}</th>", escape(name));
    let figures = [
        "flights",
        "success",
        "95 % interval",
        "crashed",
        "left altitudes",
        "too long",
        "failed",
        "clearance, m",
        "of the worst 5 %, m",
        "efficiency, %",
        "m a crash",
    ];
    let heads: String = labels.iter().map(head).collect();
    let figures: String =
        figures.iter().map(|name| format!("<th scope=\"col\">{}</th>", escape(name))).collect();
    let mut table = format!("<table>\n<thead><tr>{heads}{figures}</tr></thead>\n");
    for group in rows.chunk_by(|a, b| a.labels.first() == b.labels.first()) {
        let rows: String = group.iter().map(|row| cells(row, labels.len())).collect();
        table += &format!("<tbody class=\"group\">\n{rows}</tbody>\n");
    }
    table += "</table>\n";
    let flights: usize = rows.iter().map(|row| row.flights).sum();
    let body = format!(
        "{}<section>\n<h2>{}</h2>\n\
         <p>The bar is the share that reached its goal, the line over it its 95 % interval (Wilson). Clearance is the least of \
         a flight, in the mean; efficiency is progress a metre flown, of those that reached their goal.</p>\n\
         {table}</section>\n",
        paragraph(about),
        counted(flights, "flight"),
    );
    page(title, &body)
}

fn cells(row: &CampaignRow, labels: usize) -> String {
    let label = |i: usize| row.labels.get(i).map_or("", String::as_str);
    let labels: String =
        (0..labels).map(|i| format!("<td class=\"label\">{}</td>", escape(label(i)))).collect();
    let share = row.reached as f64 / row.flights as f64;
    let number = |value: Option<f64>, digits: usize| match value.filter(|value| value.is_finite()) {
        Some(value) => format!("{value:.digits$}"),
        None => "–".to_owned(),
    };
    let figures = [
        row.flights.to_string(),
        number(Some(share), 3),
        bar(share, row.interval),
        row.crashed.to_string(),
        row.left_band.to_string(),
        row.timed_out.to_string(),
        row.failed.to_string(),
        number(row.least_clearance_mean_m, 2),
        number(row.least_clearance_p5_m, 2),
        number(row.efficiency.map(|share| 100.0 * share), 1),
        number(row.between_crashes_m, 0),
    ];
    let figures: String = figures.iter().map(|figure| format!("<td>{figure}</td>")).collect();
    format!("<tr>{labels}{figures}</tr>\n")
}

/// A share and its interval as a bar with a whisker, and the interval in numbers.
fn bar(share: f64, interval: [f64; 2]) -> String {
    let at = |value: f64| BAR_PX * if value.is_finite() { value.clamp(0.0, 1.0) } else { 0.0 };
    let [low, high] = interval.map(at);
    let told = format!("{:.3} to {:.3}", interval[0], interval[1]);
    format!(
        "<svg viewBox=\"0 0 {BAR_PX} 16\" width=\"{BAR_PX}\" height=\"16\" role=\"img\" aria-label=\"{told}\">\
         <title>{told}</title>\
         <rect class=\"track\" x=\"0\" y=\"4\" width=\"{BAR_PX}\" height=\"8\" rx=\"2\"/>\
         <rect class=\"bar\" x=\"0\" y=\"4\" width=\"{:.1}\" height=\"8\" rx=\"2\"/>\
         <path class=\"whisker\" d=\"M{low:.1} 8H{high:.1}M{low:.1} 4V12M{high:.1} 4V12\"/></svg>",
        at(share)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::html::check;

    #[test]
    fn a_table_is_well_formed_whatever_its_rows_say() {
        let row = CampaignRow {
            labels: vec!["<b>".to_owned(), "arc".to_owned()],
            flights: 30,
            failed: 0,
            reached: 29,
            crashed: 1,
            left_band: 0,
            timed_out: 0,
            interval: [0.833, 0.994],
            least_clearance_mean_m: Some(1.234),
            least_clearance_p5_m: Some(0.7),
            efficiency: Some(0.971),
            between_crashes_m: Some(5900.0),
        };
        let none = CampaignRow {
            labels: Vec::new(),
            flights: 0,
            reached: 0,
            interval: [f64::NAN; 2],
            efficiency: Some(f64::NAN),
            between_crashes_m: None,
            ..row.clone()
        };
        let html = campaign_page("A & B", "seeds 0..30", &["world", "policy"], &[row.clone(), row, none]);
        assert_eq!(check(&html), Ok(()));
        assert!(html.contains("&lt;b&gt;") && html.contains("<h2>60 flights</h2>"), "{html}");
        assert!(html.contains("<td>0.967</td>") && html.contains("<td>5900</td>"), "{html}");
        assert_eq!(html.matches("<tbody").count(), 2);
        // 29 of 30 of the bar's 150 px.
        assert!(html.contains("class=\"bar\" x=\"0\" y=\"4\" width=\"145.0\""), "{html}");
    }
}
