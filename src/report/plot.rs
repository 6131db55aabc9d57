//! Curves over a common axis as SVG.

use super::html::escape;

/// The width of a plot that spans the page.
pub(super) const WIDE: f64 = 1000.0;
/// The margins for the labels of the axes, and above for the title.
const LEFT: f64 = 52.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 24.0;
const BOTTOM: f64 = 24.0;

/// A curve. It is interrupted at NaN.
pub(super) struct Curve<'a> {
    pub(super) name: &'a str,
    /// The CSS class of its colour, `c0` to `c4`.
    pub(super) class: &'static str,
    pub(super) points: Vec<[f64; 2]>,
}

/// A shaded part of the horizontal axis.
pub(super) struct Span {
    pub(super) from: f64,
    pub(super) to: f64,
    /// The CSS class of its colour: `good`, `warn`, `bad` or `fault`.
    pub(super) class: &'static str,
    pub(super) name: String,
}

/// Curves over a common axis.
pub(super) struct Plot<'a> {
    pub(super) title: &'a str,
    /// The unit of the vertical axis.
    pub(super) unit: &'a str,
    pub(super) x: [f64; 2],
    pub(super) y: [f64; 2],
    /// The size of the whole drawing, with its labels.
    pub(super) size: [f64; 2],
    pub(super) curves: Vec<Curve<'a>>,
    /// Named horizontal lines.
    pub(super) levels: Vec<(f64, &'a str)>,
    pub(super) spans: Vec<Span>,
}

impl Plot<'_> {
    /// The plot as an `svg` element.
    pub(super) fn svg(&self) -> String {
        let frame = PlotArea { x: self.x, y: self.y, size: self.size };
        let mut svg = frame.begin(self.title);
        let [bottom, top] = self.y.map(|y| frame.at([self.x[0], y])[1]);
        for span in &self.spans {
            let [from, to] = [span.from, span.to].map(|x| frame.at([x.clamp(self.x[0], self.x[1]), 0.0])[0]);
            svg += &format!(
                "<rect class=\"{} shade\" x=\"{from:.1}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"{:.1}\">\
                 <title>{}</title></rect>\n",
                span.class,
                (to - from).max(1.0),
                bottom - top,
                escape(&span.name),
            );
        }
        svg += &frame.axes();
        for (level, name) in &self.levels {
            let [right, y] = frame.at([self.x[1], *level]);
            svg += &format!(
                "<line class=\"level\" x1=\"{LEFT}\" y1=\"{y:.1}\" x2=\"{right:.1}\" y2=\"{y:.1}\"/>\
                 <text x=\"{right:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>\n",
                y - 4.0,
                escape(name),
            );
        }
        for curve in &self.curves {
            svg += &frame.curve(&curve.points, curve.class);
        }
        svg += &self.legend();
        svg + "</svg>\n"
    }

    /// The title and the names of those curves that have one, in one line.
    fn legend(&self) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(", {}", self.unit) };
        let title = format!("{}{unit}", self.title);
        let mut svg = format!("<text class=\"title\" x=\"{LEFT}\" y=\"14\">{}</text>\n", escape(&title));
        let mut x = self.size[0] - RIGHT;
        for curve in self.curves.iter().rev().filter(|curve| self.curves.len() > 1 && !curve.name.is_empty())
        {
            // About the width of text of this size.
            x -= 6.2 * curve.name.chars().count() as f64;
            svg += &format!(
                "<text x=\"{x:.1}\" y=\"14\">{}</text>\
                 <line class=\"curve thick {}\" x1=\"{:.1}\" y1=\"10\" x2=\"{:.1}\" y2=\"10\"/>\n",
                escape(curve.name),
                curve.class,
                x - 22.0,
                x - 6.0,
            );
            x -= 40.0;
        }
        svg
    }
}

/// The plot area: maps values to positions in a drawing.
pub(super) struct PlotArea {
    pub(super) x: [f64; 2],
    pub(super) y: [f64; 2],
    /// The size of the whole drawing, with its labels.
    pub(super) size: [f64; 2],
}

impl PlotArea {
    /// The horizontal margins: the drawing's width beyond that of the plot area.
    pub(super) const BESIDE: f64 = LEFT + RIGHT;
    /// The vertical margins: the drawing's height beyond that of the plot area.
    pub(super) const ABOVE_AND_BELOW: f64 = TOP + BOTTOM;

    /// The opening of the `svg` element. Its `data-axis` gives scripts the positions of both ends of the horizontal
    /// axis and their values.
    pub(super) fn begin(&self, name: &str) -> String {
        let [width, height] = self.size;
        let ([from, to], left, right) = (self.x, LEFT, width - RIGHT);
        format!(
            "<svg viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" height=\"{height:.0}\" role=\"img\" \
             aria-label=\"{}\" data-axis=\"{left} {right} {from} {to}\">\n",
            escape(name),
        )
    }

    pub(super) fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let share = |value: f64, [low, high]: [f64; 2]| (value - low) / (high - low);
        [
            LEFT + share(x, self.x) * (self.size[0] - Self::BESIDE),
            self.size[1] - BOTTOM - share(y, self.y) * (self.size[1] - Self::ABOVE_AND_BELOW),
        ]
    }

    pub(super) fn axes(&self) -> String {
        let mut svg = String::new();
        let [left, bottom] = self.at([self.x[0], self.y[0]]);
        let [right, top] = self.at([self.x[1], self.y[1]]);
        for y in ticks(self.y, ((bottom - top) / 34.0) as usize) {
            let at = self.at([self.x[0], y])[1];
            svg += &format!(
                "<line class=\"grid\" x1=\"{left:.1}\" y1=\"{at:.1}\" x2=\"{right:.1}\" y2=\"{at:.1}\"/>\
                 <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>\n",
                left - 6.0,
                at + 4.0,
                number(y),
            );
        }
        for x in ticks(self.x, ((right - left) / 90.0) as usize) {
            let at = self.at([x, self.y[0]])[0];
            svg += &format!(
                "<line class=\"axis\" x1=\"{at:.1}\" y1=\"{bottom:.1}\" x2=\"{at:.1}\" y2=\"{:.1}\"/>\
                 <text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>\n",
                bottom + 4.0,
                bottom + 17.0,
                number(x),
            );
        }
        svg + &format!(
            "<line class=\"axis\" x1=\"{left:.1}\" y1=\"{bottom:.1}\" x2=\"{right:.1}\" y2=\"{bottom:.1}\"/>\n"
        )
    }

    /// A line through points, interrupted at NaN, clamped to the bounds of the vertical axis.
    pub(super) fn curve(&self, points: &[[f64; 2]], class: &str) -> String {
        let mut path = String::new();
        let mut pen = 'M';
        for [x, y] in points {
            if !(x.is_finite() && y.is_finite()) {
                pen = 'M';
                continue;
            }
            let [x, y] = self.at([*x, y.clamp(self.y[0], self.y[1])]);
            path += &format!("{pen}{x:.1} {y:.1}");
            pen = 'L';
        }
        format!("<path class=\"curve {class}\" d=\"{path}\"/>\n")
    }
}

/// About `count` round values in a range, 1, 2 or 5 times a power of ten apart.
pub(super) fn ticks([low, high]: [f64; 2], count: usize) -> Vec<f64> {
    let rough = (high - low) / count.max(1) as f64;
    if !(rough > 0.0 && rough.is_finite()) {
        return Vec::new();
    }
    let power = 10_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|part| part * power).find(|step| *step >= 0.999 * rough);
    let step = step.unwrap_or(10.0 * power);
    let (first, last) = ((low / step - 1e-6).ceil() as i64, (high / step + 1e-6).floor() as i64);
    (first..=last).map(|i| i as f64 * step).collect()
}

/// A range with some margin around all finite values; at least `least` wide.
pub(super) fn range(values: impl Iterator<Item = f64>, least: f64) -> [f64; 2] {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for value in values.filter(|value| value.is_finite()) {
        (low, high) = (low.min(value), high.max(value));
    }
    if low > high {
        return [0.0, least];
    }
    let room = 0.06 * (high - low).max(least);
    let short = (0.5 * (least - (high - low))).max(0.0);
    [low - room - short, high + room + short]
}

/// A tick's label, without superfluous digits.
fn number(value: f64) -> String {
    // The rounding error of multiples of 0.1, and negative zero.
    let rounded = (value * 1e6).round() / 1e6 + 0.0;
    format!("{rounded}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::html::check;

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(ticks([0.0, 10.0], 5), [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
        assert_eq!(
            ticks([-0.3, 0.31], 6).iter().map(|tick| number(*tick)).collect::<Vec<_>>(),
            ["-0.2", "0", "0.2"]
        );
        assert_eq!(ticks([17.0, 123.0], 4), [50.0, 100.0]);
        for wrong in [[1.0, 1.0], [2.0, 1.0], [f64::NAN, 1.0], [0.0, f64::INFINITY]] {
            assert!(ticks(wrong, 5).is_empty(), "{wrong:?}");
        }
    }

    #[test]
    fn a_range_holds_its_values_and_is_never_empty() {
        let [low, high] = range([1.0, f64::NAN, 3.0, f64::INFINITY].into_iter(), 1.0);
        assert!(low < 1.0 && high > 3.0 && high < 4.0, "{low} {high}");
        let [low, high] = range([5.0; 3].into_iter(), 2.0);
        assert!(low <= 4.0 && high >= 6.0, "{low} {high}");
        assert_eq!(range(std::iter::empty(), 2.0), [0.0, 2.0]);
    }

    #[test]
    fn a_plot_is_well_formed_and_breaks_its_curves() {
        let curve = Curve { name: "a<b", class: "c0", points: vec![[0.0, 1.0], [1.0, f64::NAN], [2.0, 9.0]] };
        let plot = Plot {
            title: "A & B",
            unit: "m",
            x: [0.0, 2.0],
            y: [0.0, 4.0],
            size: [1000.0, 160.0],
            curves: vec![curve, Curve { name: "d", class: "c1", points: Vec::new() }],
            levels: vec![(2.0, "limit")],
            spans: vec![Span { from: 0.5, to: f64::INFINITY, class: "bad", name: "<why>".to_owned() }],
        };
        let svg = plot.svg();
        assert_eq!(check(&svg), Ok(()));
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        let path = svg.split("d=\"").nth(1).and_then(|rest| rest.split('"').next());
        // Both ends by themselves, the second at the upper bound.
        assert_eq!(path, Some("M52.0 108.0M986.0 24.0"), "{svg}");
    }
}
