//! The errors of flow algorithms on data sets as an HTML page.

use super::error_map::ERROR_COLOURS;
use super::html::{data_uri, escape, figure, page, paragraph, section, table};
use super::plot::{Curve, Plot};
use crate::frame::Size;

/// The size of a plot; two of them stand side by side on a wide screen.
const PLOT: [f64; 2] = [500.0, 320.0];
/// The CSS classes of the curves' colours. Runs beyond them have no curve.
const COLOURS: [&str; 5] = ["c0", "c1", "c2", "c3", "c4"];

/// The content of the page.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EvalPage {
    /// What was computed on, and the like.
    pub about: String,
    /// The data sets, and last the total if there are several.
    pub sets: Vec<EvalSet>,
}

/// A data set.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EvalSet {
    /// The name.
    pub name: String,
    /// A line about it.
    pub about: String,
    /// The tables.
    pub tables: Vec<EvalTable>,
    /// The confidence's curves of each run; the first five are drawn.
    pub curves: Vec<EvalCurves>,
    /// What failed: the pair, the runs, and the reason.
    pub failures: Vec<[String; 3]>,
    /// The pairs whose images are shown.
    pub pairs: Vec<EvalPair>,
}

/// A table with a row per run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EvalTable {
    /// A line above it.
    pub about: String,
    /// The column heads, that of the run included.
    pub heads: Vec<String>,
    /// The rows' cells, each with whether it is the best of its column.
    pub rows: Vec<Vec<(String, bool)>>,
}

/// How well the confidence of a run tells bad pixels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EvalCurves {
    /// The run.
    pub run: String,
    /// False alarms and alarms, each 0 to 1, from (0, 0) to (1, 1); empty if there is no curve.
    pub roc: Vec<[f64; 2]>,
    /// Shares of the pixels, 0 to 1, and the mean error of the best of them, px.
    pub best_px: Vec<[f64; 2]>,
    /// The same if the pixels were sorted by their errors.
    pub oracle_px: Vec<[f64; 2]>,
}

/// The images of a pair.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EvalPair {
    /// The pair's name.
    pub name: String,
    /// The images.
    pub images: Vec<EvalImage>,
}

/// An image in a file's format.
#[derive(Clone, Debug, PartialEq)]
pub struct EvalImage {
    /// A description for those who cannot see it.
    pub alt: String,
    /// The caption.
    pub caption: String,
    /// Its size.
    pub size: Size,
    /// The format, such as `image/png`.
    pub media_type: &'static str,
    /// The file's bytes.
    pub bytes: Vec<u8>,
}

impl EvalPage {
    /// The page as self-contained HTML, images included.
    pub fn html(&self) -> String {
        let mut body = paragraph(&self.about);
        body += &self.sets.iter().map(EvalSet::html).collect::<String>();
        page("Optical flow evaluation", &body)
    }
}

impl EvalSet {
    fn html(&self) -> String {
        let mut content: String = self.tables.iter().map(EvalTable::html).collect();
        if !self.failures.is_empty() {
            content += &self.failed();
        }
        if !self.curves.is_empty() {
            content += &paragraph(
                "Left: how many of the bad pixels (error over 0.5 px) an alarm at low confidence finds, against its false \
                 alarms. Right: the mean error of the pixels that the confidence rates best; dashed, if it sorted them by \
                 their true error.",
            );
            content += &format!("<div class=\"curves\">\n{}{}</div>\n", self.roc(), self.sparsification());
            content += &self.legend();
        }
        if !self.pairs.is_empty() {
            content += &scale();
            content += &self.pairs.iter().map(EvalPair::html).collect::<String>();
        }
        section(&self.name, &self.about, &content)
    }

    fn failed(&self) -> String {
        let row = |[pair, runs, reason]: &[String; 3]| {
            let cells = [pair, runs, reason].map(|text| format!("<td class=\"text\">{}</td>", escape(text)));
            format!("<tr>{}</tr>\n", cells.concat())
        };
        let heads =
            ["pair", "runs", "reason"].map(|head| format!("<th class=\"label\" scope=\"col\">{head}</th>"));
        paragraph("What failed; no figure counts it")
            + &table(&format!(
                "<thead><tr>{}</tr></thead>\n<tbody>\n{}</tbody>\n",
                heads.concat(),
                self.failures.iter().map(row).collect::<String>()
            ))
    }

    fn drawn(&self) -> impl Iterator<Item = (&EvalCurves, &'static str)> {
        self.curves.iter().zip(COLOURS)
    }

    fn roc(&self) -> String {
        let curve = |(curves, class): (&EvalCurves, &'static str)| Curve {
            name: "",
            class,
            points: curves.roc.clone(),
        };
        let mut curves: Vec<Curve<'_>> = self.drawn().map(curve).collect();
        curves.retain(|curve| !curve.points.is_empty());
        plot("alarms for bad pixels against false alarms", "", [0.0, 1.0], curves)
    }

    fn sparsification(&self) -> String {
        let mut curves = Vec::new();
        for (run, class) in self.drawn() {
            curves.push(Curve { name: "", class, points: run.best_px.clone() });
            let dashed = ["c0 dashed", "c1 dashed", "c2 dashed", "c3 dashed", "c4 dashed"];
            let place = COLOURS.iter().position(|colour| *colour == class).unwrap_or(0);
            curves.push(Curve { name: "", class: dashed[place], points: run.oracle_px.clone() });
        }
        let highest =
            curves.iter().flat_map(|curve| &curve.points).map(|[_, y]| *y).filter(|y| y.is_finite());
        let top = 1.05 * highest.fold(0.0, f64::max);
        plot(
            "mean error of the best pixels against their share",
            "px",
            [0.0, if top > 0.0 { top } else { 1.0 }],
            curves,
        )
    }

    fn legend(&self) -> String {
        let entry = |(curves, class): (&EvalCurves, &str)| {
            format!("<li><i style=\"background:var(--{class})\"></i>{}</li>", escape(&curves.run))
        };
        format!("<ul class=\"keys\">{}</ul>\n", self.drawn().map(entry).collect::<String>())
    }
}

fn plot(title: &str, unit: &str, y: [f64; 2], curves: Vec<Curve<'_>>) -> String {
    let plot =
        Plot { title, unit, x: [0.0, 1.0], y, size: PLOT, curves, levels: Vec::new(), spans: Vec::new() };
    plot.svg()
}

impl EvalTable {
    fn html(&self) -> String {
        let class = |column: usize| if column == 0 { " class=\"label\"" } else { "" };
        let head =
            |(i, head): (usize, &String)| format!("<th{} scope=\"col\">{}</th>", class(i), escape(head));
        let heads: String = self.heads.iter().enumerate().map(head).collect();
        let cell = |(i, (text, is_best)): (usize, &(String, bool))| match is_best {
            true => format!("<td{}><b>{}</b></td>", class(i), escape(text)),
            false => format!("<td{}>{}</td>", class(i), escape(text)),
        };
        let row = |row: &Vec<(String, bool)>| {
            format!("<tr>{}</tr>\n", row.iter().enumerate().map(cell).collect::<String>())
        };
        let rows: String = self.rows.iter().map(row).collect();
        paragraph(&self.about)
            + &table(&format!("<thead><tr>{heads}</tr></thead>\n<tbody>\n{rows}</tbody>\n"))
    }
}

impl EvalPair {
    fn html(&self) -> String {
        let image = |image: &EvalImage| {
            figure(&data_uri(image.media_type, &image.bytes), image.size, &image.alt, &image.caption)
        };
        let images: String = self.images.iter().map(image).collect();
        format!("<h3>{}</h3>\n<div class=\"pictures\">\n{images}</div>\n", escape(&self.name))
    }
}

/// The colours of the error maps.
fn scale() -> String {
    let mut from = "0".to_owned();
    let mut entries = String::new();
    for (next, [r, g, b]) in ERROR_COLOURS {
        let range = if next.is_finite() { format!("{from}–{next}") } else { format!("{from} and more") };
        entries += &format!("<li><i style=\"background:rgb({r},{g},{b})\"></i>{range}</li>");
        from = next.to_string();
    }
    format!(
        "<p>Endpoint error in px; gray has no truth, black no estimate:</p>\n<ul class=\"keys\">{entries}</ul>\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::html::check;

    #[test]
    fn the_page_is_well_formed_and_escapes_what_it_is_told() {
        let text = |text: &str| text.to_owned();
        let curves = EvalCurves {
            run: text("a<b"),
            roc: vec![[0.0, 0.0], [1.0, 1.0]],
            best_px: vec![[0.5, 0.1], [1.0, 0.2]],
            oracle_px: vec![[0.5, f64::NAN], [1.0, 0.2]],
        };
        let set = EvalSet {
            name: text("<set>"),
            about: text("a & b"),
            tables: vec![EvalTable {
                about: text("\"c\""),
                heads: vec![text("run"), text("AEE <px>")],
                rows: vec![vec![(text("r&r"), false), (text("0.1"), true)]],
            }],
            failures: vec![[text("p<"), text("r&r"), text("a <b>")]],
            curves: vec![curves.clone(), EvalCurves { roc: Vec::new(), ..curves }],
            pairs: vec![EvalPair {
                name: text("p<"),
                images: vec![EvalImage {
                    alt: text("alt \""),
                    caption: text("caption <"),
                    size: Size::new(3, 2),
                    media_type: "image/png",
                    bytes: vec![1, 2, 3],
                }],
            }],
        };
        let html = EvalPage { about: text("<on>"), sets: vec![set, EvalSet::default()] }.html();
        assert_eq!(check(&html), Ok(()));
        assert!(
            html.contains("a &lt;b&gt;")
                && html.contains("&lt;set&gt;")
                && html.contains("<b>0.1</b>")
                && html.contains("r&amp;r"),
            "{html}"
        );
        assert_eq!(html.matches("data:image/png;base64,AQID").count(), 1);
        // A narrow screen scrolls the tables, not the page.
        assert_eq!(
            (html.matches("<table").count(), html.matches("<div class=\"wide\"><table>").count()),
            (2, 2)
        );
        // One ROC, and two curves of each run.
        assert_eq!(html.matches("<path class=\"curve").count(), 1 + 4);
    }
}
