//! The data of a film for the player's script.

use std::fmt::Display;

use super::film::{FlightFilm, Ring, Still};
use super::map::{MIDDLE, PATH, SOLID, SPAN_M, VEHICLE};
use crate::report::colours::{ARC, BACKGROUND, DIM, GOAL, LATER, TEXT, TIMES};
use crate::report::footprint::Footprint;
use crate::report::html::data_uri;
use crate::sim::flight::FRAME_S;

/// The film as JSON, with the `texts` of each frame, which must need no escapes. Positions are to the right and towards
/// the goal, in metres.
pub(super) fn json(film: &FlightFilm, shown: usize, texts: impl Fn(&Still) -> Vec<String>) -> String {
    let each = |of: &dyn Fn(&Still) -> String| list(film.stills.iter().map(of));
    let ground = &film.ground;
    let jpeg = |bytes: &[u8]| quoted(data_uri("image/jpeg", bytes));
    let members = [
        ("shown", shown.to_string()),
        ("interval", (film.every as f64 * FRAME_S).to_string()),
        ("span", SPAN_M.to_string()),
        ("vehicle", list(VEHICLE)),
        ("goal", format!("{:.1}", ground.length_m)),
        ("colours", colours()),
        ("times", list(TIMES.iter().map(|(_, colour)| css(*colour)).chain([css(LATER)]))),
        ("middle", flat(ground.centre_line_m.iter().map(|place| ground.offset_from_start(*place)))),
        ("shapes", shapes(film)),
        ("time", each(&|still| format!("{:.3}", still.record.time_s))),
        ("text", each(&|still| list(texts(still).into_iter().map(quoted)))),
        (
            "at",
            flat(
                film.stills
                    .iter()
                    .map(|still| ground.offset_from_start(still.record.position_ned_m.truncate())),
            ),
        ),
        (
            "nose",
            each(&|still| {
                let (sin, cos) = still.record.roll_pitch_yaw_rad[2].sin_cos();
                let [right, ahead] = ground.turned(glam::DVec2::new(cos, sin));
                format!("{:.3}", right.atan2(ahead))
            }),
        ),
        ("arc", each(&|still| flat(still.arc_m.iter().map(|place| ground.turned(*place))))),
        ("ribbon", each(&|still| flat(still.ribbon.iter().flatten().copied()))),
        ("rings", each(&|still| list(still.obstacles.iter().map(|ring| self::ring(film, ring))))),
        ("flow", each(&|still| jpeg(&still.flow))),
        ("sectors", each(&|still| jpeg(&still.sectors))),
    ];
    let members = members.map(|(name, value)| format!("\"{name}\":{value}"));
    format!("{{{}}}", members.join(",\n"))
}

/// The static shapes near the flown path, as far as they appear on the map.
fn shapes(film: &FlightFilm) -> String {
    let ground = &film.ground;
    let near = |footprint: &&Footprint| {
        film.stills.iter().any(|still| footprint.is_near(still.record.position_ned_m.truncate(), SPAN_M))
    };
    let shape = |footprint: &Footprint| match footprint {
        Footprint::Circle(centre, radius_m) => {
            let [right, ahead] = ground.offset_from_start(*centre);
            format!("[{right:.1},{ahead:.1},{radius_m:.2}]")
        }
        Footprint::Line(ends) => flat(ends.iter().map(|end| ground.offset_from_start(*end))),
        Footprint::Polygon(corners) => flat(corners.iter().map(|corner| ground.offset_from_start(*corner))),
    };
    list(ground.footprints.iter().filter(near).map(shape))
}

fn ring(film: &FlightFilm, ring: &Ring) -> String {
    let [right, ahead] = film.ground.turned(ring.off_m);
    format!("[{right:.1},{ahead:.1},{:.1},{}]", ring.radius_m, ring.time)
}

fn colours() -> String {
    let named = [
        ("background", BACKGROUND),
        ("solid", SOLID),
        ("middle", MIDDLE),
        ("goal", GOAL),
        ("path", PATH),
        ("arc", ARC),
        ("vehicle", TEXT),
        ("scale", DIM),
    ];
    format!("{{{}}}", named.map(|(name, colour)| format!("\"{name}\":{}", css(colour))).join(","))
}

fn css([r, g, b]: [u8; 3]) -> String {
    format!("\"rgb({r},{g},{b})\"")
}

fn quoted(text: String) -> String {
    format!("\"{text}\"")
}

fn list(items: impl IntoIterator<Item = impl Display>) -> String {
    let items: Vec<String> = items.into_iter().map(|item| item.to_string()).collect();
    format!("[{}]", items.join(","))
}

/// The coordinates of points, one point after the other.
fn flat(places: impl IntoIterator<Item = [f64; 2]>) -> String {
    list(places.into_iter().flatten().map(|coordinate| format!("{coordinate:.1}")))
}
