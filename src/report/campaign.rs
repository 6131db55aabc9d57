//! A campaign's table as an HTML page.

use super::html::{escape, page, paragraph, table};
use crate::text::counted;

/// The width of an interval's drawing, pixels.
const BAR_PX: f64 = 150.0;

/// The statistics of one setting's flights.
#[derive(Clone, Debug, PartialEq)]
pub struct CampaignRow {
    /// The setting, one value for each of the table's labels: world, policy, sensor and the like.
    pub labels: Vec<String>,
    /// The number of flights.
    pub flights: usize,
    /// The number of flights that failed with an error; no other figure counts them.
    pub failed: usize,
    /// The number of flights that reached the goal.
    pub reached: usize,
    /// The number of flights that crashed.
    pub crashed: usize,
    /// The number of flights that left the altitude band.
    pub left_band: usize,
    /// The number of flights that timed out.
    pub timed_out: usize,
    /// Wilson's 95 % confidence interval of the success rate, `[low, high]`, 0 to 1.
    pub interval: [f64; 2],
    /// The least clearance of a flight, metres: the mean over the flights.
    pub least_clearance_mean_m: Option<f64>,
    /// The least clearance of a flight, metres: the 5th percentile over the flights.
    pub least_clearance_p5_m: Option<f64>,
    /// Path efficiency, progress per distance flown, 0 to 1: the mean over the flights that reached the goal.
    pub efficiency: Option<f64>,
    /// Distance flown per touch of a surface, metres; `None` without a touch.
    pub between_touches_m: Option<f64>,
    /// Mission progress, the share of the course that was flown, 0 to 1: the mean over the flights.
    pub progress: Option<f64>,
    /// Path length over that of the shortest way, minus 1: the mean over the flights that reached the goal.
    pub optimality: Option<f64>,
    /// Length of the shortest way over the time taken, m/s: the mean over the flights that reached the goal.
    pub goal_speed_m_s: Option<f64>,
    /// Integral of the jerk per distance flown, 1/s².
    pub energy_hz2: Option<f64>,
}

/// A campaign as a self-contained HTML page: a table with a row per setting.
///
/// `about` is a line below the title, `labels` are the column heads of [`CampaignRow::labels`]. Consecutive rows with
/// the same first label are grouped.
pub fn campaign_page(title: &str, about: &str, labels: &[&str], rows: &[CampaignRow]) -> String {
    let head = |name: &&str| format!("<th class=\"label\" scope=\"col\">{}</th>", escape(name));
    let figures = [
        "flights",
        "success",
        "95 % interval",
        "crashed",
        "left band",
        "timed out",
        "failed",
        "clearance, m",
        "5th percentile, m",
        "efficiency, %",
        "m per touch",
        "progress, %",
        "optimality, %",
        "goal speed, m/s",
        "energy, 1/s²",
    ];
    let heads: String = labels.iter().map(head).collect();
    let figures: String =
        figures.iter().map(|name| format!("<th scope=\"col\">{}</th>", escape(name))).collect();
    let mut content = format!("<thead><tr>{heads}{figures}</tr></thead>\n");
    for group in rows.chunk_by(|a, b| a.labels.first() == b.labels.first()) {
        let rows: String = group.iter().map(|row| cells(row, labels.len())).collect();
        content += &format!("<tbody class=\"group\">\n{rows}</tbody>\n");
    }
    let flights: usize = rows.iter().map(|row| row.flights).sum();
    let body = format!(
        "{}<section>\n<h2>{}</h2>\n\
         <p>The bar is the share that reached the goal, the line over it the 95 % interval (Wilson). Clearance is the mean of \
         each flight's least; efficiency is progress per metre flown, of the flights that reached the goal. The last four are \
         AvoidBench's: the share of the course that was flown; by how much the path is longer than the shortest way, and \
         that way over the time, of the flights that reached the goal; and the integral of the jerk per metre.</p>\n\
         {}</section>\n",
        paragraph(about),
        counted(flights, "flight"),
        table(&content),
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
        number(row.between_touches_m, 0),
        number(row.progress.map(|share| 100.0 * share), 1),
        number(row.optimality.map(|share| 100.0 * share), 1),
        number(row.goal_speed_m_s, 2),
        number(row.energy_hz2, 2),
    ];
    let figures: String = figures.iter().map(|figure| format!("<td>{figure}</td>")).collect();
    format!("<tr>{labels}{figures}</tr>\n")
}

/// A share and its interval as a bar with a whisker, labelled with the interval in numbers.
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
            between_touches_m: Some(5900.0),
            progress: Some(0.99),
            optimality: Some(0.02),
            goal_speed_m_s: Some(11.7),
            energy_hz2: Some(3.1),
        };
        let none = CampaignRow {
            labels: Vec::new(),
            flights: 0,
            reached: 0,
            interval: [f64::NAN; 2],
            efficiency: Some(f64::NAN),
            between_touches_m: None,
            ..row.clone()
        };
        let html = campaign_page("A & B", "seeds 0..30", &["world", "policy"], &[row.clone(), row, none]);
        assert_eq!(check(&html), Ok(()));
        assert!(html.contains("&lt;b&gt;") && html.contains("<h2>60 flights</h2>"), "{html}");
        assert!(html.contains("<td>0.967</td>") && html.contains("<td>5900</td>"), "{html}");
        assert_eq!(html.matches("<tbody").count(), 2);
        // A narrow screen scrolls the table, not the page.
        assert_eq!(
            (html.matches("<table").count(), html.matches("<div class=\"wide\"><table>").count()),
            (1, 1)
        );
        // 29 of 30 of the bar's 150 px.
        assert!(html.contains("class=\"bar\" x=\"0\" y=\"4\" width=\"145.0\""), "{html}");
    }
}
