//! The player of a flight's film, for a page.

use super::film::{FlightFilm, Still};
use super::script::json;
use crate::frame::Size;
use crate::report::colours::{LATER, TIMES};
use crate::report::html::{data_uri, escape};

/// The player's script, as an element for a page's head.
pub(in crate::report) fn script() -> String {
    format!("<script type=\"module\">\n{}</script>\n", include_str!("player.js"))
}

/// The player with its film. A page can hold one.
pub(in crate::report) fn player(film: &FlightFilm) -> String {
    let stills = &film.stills;
    let shown = interesting(stills);
    let Some(still) = stills.get(shown) else { return "<p>No frame was drawn.</p>\n".to_owned() };
    let Size { width, height } = film.picture_size();
    let screen = |id: &str, jpeg: &[u8], over: &str, alt: &str, caption: &str| {
        let uri = data_uri("image/jpeg", jpeg);
        format!(
            "<figure class=\"{id}\"><div class=\"screen\"><img id=\"{id}\" src=\"{uri}\" width=\"{width}\" \
             height=\"{height}\" decoding=\"sync\" alt=\"{alt}\"/>{over}</div>\
             <figcaption>{caption}</figcaption></figure>\n"
        )
    };
    let flow = screen(
        "flow",
        &still.flow,
        "",
        "The camera's image in gray, with its flow in colours",
        "The camera's image and its flow: the hue is the direction, the saturation the length.",
    );
    let sectors = screen(
        "sectors",
        &still.sectors,
        "<canvas></canvas>",
        "The camera's image in gray, its sectors coloured by time to contact, with the chosen arc as a ribbon",
        "The sectors by time to contact. Cross: the direction of motion. Box: the threat with the earliest contact. Ribbon: the \
         chosen arc.",
    );
    let map = "<figure class=\"map\"><div class=\"screen\"><canvas id=\"map\" role=\"img\" aria-label=\"A map of the surroundings with obstacles, the \
               path flown and the chosen arc\"></canvas></div><figcaption>From above, the goal is up. Gray: solids. Rings: the \
               steering's obstacles, by time to contact. Blue: the path flown. Turquoise: the chosen arc.\
               </figcaption></figure>\n";
    let last = stills.len() - 1;
    format!(
        "<div class=\"controls\"><button type=\"button\" id=\"play\">Play</button>\
         <input type=\"range\" id=\"seek\" min=\"0\" max=\"{last}\" value=\"{shown}\" aria-label=\"Frame of the flight\"/>\
         <output id=\"clock\">{:.1} s</output></div>\n\
         <div class=\"player\">\n{flow}{sectors}{map}</div>\n{}\
         <div class=\"tiles\" id=\"readout\">\n{}</div>\n\
         <p>Space plays and pauses, the arrow keys step by one frame.</p>\n\
         <noscript><p>Without scripts the page shows only this frame, and no map.</p></noscript>\n\
         <script type=\"application/json\" id=\"film\">{}</script>\n",
        still.record.time_s,
        legend(),
        readout(still),
        json(film, shown, |still| texts(still).to_vec()),
    )
}

/// The frame shown first: the one with the steepest bank commanded by the view.
fn interesting(stills: &[Still]) -> usize {
    let bank = |still: &Still| {
        let seen = still.record.invalid.is_none();
        if seen { still.record.command.bank_rad.abs() } else { -1.0 }
    };
    let found = stills.iter().enumerate().max_by(|(_, a), (_, b)| bank(a).total_cmp(&bank(b)));
    found.map_or(0, |(at, _)| at)
}

/// The names of a frame's figures, in the order of the script.
const FIGURES: [&str; 5] =
    ["contact ahead", "true contact", "bank flown", "bank and climb of the arc", "clearance"];

fn texts(still: &Still) -> [String; FIGURES.len()] {
    let record = &still.record;
    let seconds = |time_s: Option<f64>| match time_s {
        Some(time_s) if time_s < 100.0 => format!("{time_s:.1} s"),
        _ => "–".to_owned(),
    };
    let degrees = |angle_rad: f64| {
        let rounded = angle_rad.to_degrees().round() + 0.0;
        format!("{}{}°", if rounded < 0.0 { "−" } else { "+" }, rounded.abs())
    };
    [
        seconds(record.contact_s),
        seconds(record.true_contact_s),
        degrees(record.roll_pitch_yaw_rad[0]),
        format!("{}, {}", degrees(record.command.bank_rad), degrees(record.command.climb_rad)),
        format!("{:.1} m", record.clearance_m),
    ]
}

fn readout(still: &Still) -> String {
    let tile = |(name, text): (&str, String)| {
        format!("<div class=\"tile\"><span>{name}</span><b>{}</b></div>\n", escape(text))
    };
    FIGURES.into_iter().zip(texts(still)).map(tile).collect()
}

/// The legend of the colours of times to contact.
fn legend() -> String {
    let key = |[r, g, b]: [u8; 3], text: String| {
        format!("<li><i style=\"background:rgb({r},{g},{b})\"></i>{text}</li>\n")
    };
    let near = TIMES.iter().map(|(limit, colour)| key(*colour, format!("within {limit} s")));
    let later = key(LATER, "later".to_owned());
    format!("<ul class=\"keys\" aria-label=\"Time to contact\">\n{}{later}</ul>\n", near.collect::<String>())
}
