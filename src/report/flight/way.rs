//! The path flown, from above.

use glam::DVec2;

use crate::report::footprint::Footprint;
use crate::report::html::escape;
use crate::report::plot::{PlotArea, WIDE};
use crate::sim::Course;
use crate::sim::flight::{Outcome, Record};

/// Clearances in metres, each with the CSS class of smaller ones. The last one covers the rest.
pub(super) const CLEARANCES: [(f64, &str); 5] =
    [(1.0, "s0"), (2.0, "s1"), (4.0, "s2"), (8.0, "s3"), (f64::INFINITY, "s4")];
/// The margins before the start, behind the end, and to the sides of the path, metres.
const BEFORE_M: f64 = 8.0;
const BEHIND_M: f64 = 15.0;
const ASIDE_M: f64 = 22.0;
/// The largest height of the drawing, pixels.
const HIGHEST: f64 = 620.0;

/// A drawing of the course with the path flown. The direction of the goal is to the right.
pub(super) fn svg(course: &Course, records: &[Record], outcome: Outcome) -> String {
    let (sin, cos) = course.goal_yaw_rad.sin_cos();
    let (ahead, left) = (DVec2::new(cos, sin), DVec2::new(sin, -cos));
    let start = course.start_ned_m.truncate();
    let along = |point: DVec2| [(point - start).dot(ahead), (point - start).dot(left)];
    let way: Vec<[f64; 2]> = records.iter().map(|record| along(record.position_ned_m.truncate())).collect();
    let bounds = |i: usize, from: f64| {
        let fold = |of: fn(f64, f64) -> f64| way.iter().map(|point| point[i]).fold(from, of);
        [fold(f64::min), fold(f64::max)]
    };
    let ([first, last], [lowest, highest]) = (bounds(0, 0.0), bounds(1, 0.0));
    let x = [first.min(0.0) - BEFORE_M, last.max(course.length_m) + BEHIND_M];
    let scale = (WIDE - PlotArea::BESIDE) / (x[1] - x[0]);
    let most = (HIGHEST - PlotArea::ABOVE_AND_BELOW) / scale;
    // A path that leads too far aside is cut around the middle of its range.
    let middle = 0.5 * (lowest + highest);
    let half = (0.5 * (highest - lowest) + ASIDE_M).min(0.5 * most);
    let y = [middle - half, middle + half];
    let frame = PlotArea { x, y, size: [WIDE, 2.0 * half * scale + PlotArea::ABOVE_AND_BELOW] };

    let mut svg = frame.begin("The path from above");
    let [[l, b], [r, t]] = [frame.at([x[0], y[0]]), frame.at([x[1], y[1]])];
    svg += &format!(
        "<clipPath id=\"inside\"><rect x=\"{l:.1}\" y=\"{t:.1}\" width=\"{:.1}\" height=\"{:.1}\"/></clipPath>\n",
        r - l,
        b - t
    );
    svg += &frame.axes();
    svg += "<g clip-path=\"url(#inside)\">\n";
    let centre = start + 0.5 * (x[0] + x[1]) * ahead + middle * left;
    let reach = (0.5 * (x[1] - x[0])).hypot(half);
    for surface in &course.world.surfaces {
        let footprint = Footprint::of(&surface.form(), -course.start_ned_m.z);
        if let Some(footprint) = footprint.filter(|footprint| footprint.is_near(centre, reach)) {
            svg += &solid(&footprint, |point| frame.at(along(point)), scale);
        }
    }
    let middle_line: Vec<_> = course.centre_line_m.iter().map(|point| along(*point)).collect();
    svg += &line(&frame, &middle_line, "level");
    let goal = [[course.length_m, y[0]], [course.length_m, y[1]]];
    svg += &line(&frame, &goal, "goal");
    for (part, class) in coloured(&way, records) {
        svg += &frame.curve(part, &format!("thick {class}"));
    }
    if let Some([x, y]) = way.first().map(|point| frame.at(*point)) {
        svg += &format!("<circle class=\"end\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\"/>\n");
    }
    if let Some([x, y]) = way.last().filter(|_| outcome == Outcome::Crashed).map(|point| frame.at(*point)) {
        let [x0, y0, x1, y1] = [x - 6.0, y - 6.0, x + 6.0, y + 6.0];
        svg += &format!(
            "<path class=\"end\" d=\"M{x0:.1} {y0:.1}L{x1:.1} {y1:.1}M{x0:.1} {y1:.1}L{x1:.1} {y0:.1}\"/>\n"
        );
    }
    svg += "</g>\n";
    svg += "<text class=\"title\" x=\"52\" y=\"14\">Metres towards the goal, and to the left of it</text>\n";
    svg + &legend() + "</svg>\n"
}

fn solid(footprint: &Footprint, place: impl Fn(DVec2) -> [f64; 2], scale: f64) -> String {
    match footprint {
        Footprint::Circle(centre, radius_m) => {
            let [x, y] = place(*centre);
            let r = (scale * radius_m).max(0.6);
            format!("<circle class=\"solid\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{r:.1}\"/>\n")
        }
        Footprint::Line(ends) => {
            let [[x0, y0], [x1, y1]] = ends.map(place);
            format!("<line class=\"solid\" x1=\"{x0:.1}\" y1=\"{y0:.1}\" x2=\"{x1:.1}\" y2=\"{y1:.1}\"/>\n")
        }
        Footprint::Polygon(corners) => {
            let points = corners.iter().map(|corner| place(*corner)).map(|[x, y]| format!("{x:.1},{y:.1} "));
            format!("<polygon class=\"solid\" points=\"{}\"/>\n", points.collect::<String>().trim_end())
        }
    }
}

fn line(frame: &PlotArea, points: &[[f64; 2]], class: &str) -> String {
    let place = |point: &[f64; 2]| {
        let [x, y] = frame.at(*point);
        format!("{x:.1},{y:.1} ")
    };
    let points: String = points.iter().map(place).collect();
    format!("<polyline class=\"{class}\" fill=\"none\" points=\"{}\"/>\n", points.trim_end())
}

/// The path in parts of one class each. Each part begins where the previous one ends.
fn coloured<'a>(way: &'a [[f64; 2]], records: &[Record]) -> Vec<(&'a [[f64; 2]], &'static str)> {
    let class = |record: &Record| {
        let found = CLEARANCES.iter().find(|(limit, _)| record.clearance_m < *limit);
        found.map_or(CLEARANCES[0].1, |(_, class)| class)
    };
    let classes: Vec<&str> = records.iter().map(class).collect();
    let mut first = 0;
    let mut parts = Vec::new();
    for part in classes.chunk_by(|a, b| a == b) {
        let end = first + part.len();
        parts.push((&way[first..(end + 1).min(way.len())], part[0]));
        first = end;
    }
    parts
}

/// The legend of the colours of clearances.
fn legend() -> String {
    let mut svg = String::new();
    let mut low = 0.0;
    for (i, (limit, class)) in CLEARANCES.iter().enumerate() {
        let name = match limit.is_finite() {
            true => format!("{low}–{limit} m"),
            false => format!("over {low} m"),
        };
        let x = 620.0 + 74.0 * i as f64;
        svg += &format!(
            "<line class=\"curve thick {class}\" x1=\"{x}\" y1=\"10\" x2=\"{}\" y2=\"10\"/>\
             <text x=\"{}\" y=\"14\">{}</text>\n",
            x + 16.0,
            x + 22.0,
            escape(name),
        );
        low = *limit;
    }
    svg + "<text x=\"612\" y=\"14\" text-anchor=\"end\">clearance</text>\n"
}
