//! What the program does, on one page.

mod flight;
mod pair;

pub use flight::DemoFlight;
pub use pair::DemoPair;

use super::flight::player;
use super::html::{escape, figures, page_with, paragraph, section, tile};
use crate::error::Result;
use crate::sim::flight::Outcome;

/// What stands in the head of a page that was made of a demo.
pub(crate) const GENERATOR: &str = "<meta name=\"generator\" content=\"viewsphere demo\"/>";

/// What `viewsphere demo` shows: the flow of a pair, and a flight that is steered by flow.
#[derive(Clone, Copy, Debug)]
pub struct DemoReport<'a> {
    /// The pair.
    pub pair: &'a DemoPair,
    /// The flight.
    pub flight: DemoFlight<'a>,
}

impl DemoReport<'_> {
    /// Both on one page of HTML that needs nothing beside itself: its pictures are part of it.
    ///
    /// # Errors
    /// Those of a picture or a flow that contradicts itself.
    pub fn html(&self) -> Result<String> {
        let head = format!("{GENERATOR}\n{}", player::script());
        let mut body = "<p class=\"lead\">viewsphere measures how every pixel moves from one camera picture to the next (dense \
                        optical flow), tells from it what will be met in how many seconds, and steers an aircraft by that.</p>\n"
            .to_owned();
        body += &paragraph(
            "This page shows it on made-up pictures, whose truth is known. All of it was computed on this machine when the page was \
             made.",
        );
        body += &self.tiles();
        body += &section(
            "Flow of a pair of pictures",
            "The background turns and comes nearer; a disc in front of it moves to the right and up. Every picture is sampled from \
             the scene itself, so that the true flow is known in closed form.",
            &self.pair.html()?,
        );
        body += &section(
            "A flight that is steered by flow",
            &self.flight.about(),
            &(player::player(self.flight.film) + &self.flight.curves()),
        );
        body += &section(
            "What it was computed on, and how fast",
            self.flight.why.unwrap_or_default(),
            &figures(&self.rows()),
        );
        body += &section("What to do next", "", &next());
        Ok(page_with("viewsphere demo", &head, &body))
    }

    fn tiles(&self) -> String {
        let Self { pair, flight } = self;
        let crashed = flight.outcome.is_some_and(|outcome| outcome != Outcome::Reached);
        let tiles = [
            tile("mean error of the flow", format_args!("{:.3} px", pair.accuracy.aee_px), ""),
            tile("flow of a pair", format_args!("{:.1} ms", pair.frame_ms[0]), ""),
            tile("camera to command", milliseconds(flight.onboard_ms()), ""),
            tile("flight", flight.state(), if crashed { "bad" } else { "good" }),
            tile("least clearance", format_args!("{:.1} m", flight.clearance_m()), ""),
        ];
        format!("<div class=\"tiles\">\n{}</div>\n", tiles.concat())
    }

    fn rows(&self) -> Vec<(&'static str, String)> {
        let Self { pair, flight } = self;
        let [median, longest] = pair.frame_ms;
        let size = pair.frames[0].size;
        let mut rows = vec![
            ("pair computed on", pair.adapter.clone()),
            (
                "pair",
                format!(
                    "{size}; {median:.2} ms a frame in the median ({:.0} frames a second), {longest:.2} ms at most",
                    1e3 / median
                ),
            ),
            ("flight computed on", flight.adapter.to_owned()),
            ("flight", flight.size()),
        ];
        rows.extend(flight.cost_rows());
        let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        rows.push((
            "machine",
            format!("{} on {}, {threads} threads", std::env::consts::OS, std::env::consts::ARCH),
        ));
        rows.push(("program", format!("viewsphere {}", env!("CARGO_PKG_VERSION"))));
        rows
    }
}

fn milliseconds(time_ms: Option<f64>) -> String {
    time_ms.map_or("–".to_owned(), |time_ms| format!("{time_ms:.1} ms"))
}

/// Three commands to go on with.
fn next() -> String {
    let commands = [
        (
            "Fly through another world to the end, with a log, a report and a video",
            "viewsphere fly --world wires --seed 2 -o flight/",
        ),
        (
            "Compute the flow between two pictures of your own",
            "viewsphere flow a.png b.png -o flow.flo --color flow.png",
        ),
        (
            "Get times to contact from your own camera and gyro, with a video of what is made of them",
            "viewsphere run flight.y4m --camera cam.yaml --gyro gyro.csv --overlay seen.y4m",
        ),
    ];
    let command = |(about, line): (&str, &str)| {
        format!("{}<pre><code>{}</code></pre>\n", paragraph(about), escape(line))
    };
    commands.into_iter().map(command).collect::<String>()
        + &paragraph(
            "From the source folder, “cargo run --release --” stands for “viewsphere”; every command has a --help with examples.",
        )
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::pair::tests::gray;
    use super::*;
    use crate::backend::Backend;
    use crate::frame::{FlowField, Size};
    use crate::report::flight::FlightFilm;
    use crate::report::html::check;
    use crate::sim::CourseKind;
    use crate::sim::flight::{Flight, FlightConfig, Sensor};

    #[test]
    fn the_page_is_well_formed_and_escapes_what_it_is_told() {
        let course = "wall".parse::<CourseKind>().unwrap().course(1).unwrap();
        let config = FlightConfig { sensor: Sensor::Depth, ..FlightConfig::default() };
        let mut flight = Flight::new([Backend::Cpu, Backend::Cpu], &course, &config).unwrap();
        let mut film = FlightFilm::new(&flight, 2).unwrap();
        let (mut records, mut costs) = (Vec::new(), Vec::new());
        for _ in 0..3 {
            let ended = flight.step(|seen| {
                records.push(seen.record.clone());
                film.add(seen)
            });
            assert_eq!(ended.unwrap(), None);
            costs.push(flight.cost());
        }
        let size = Size::new(40, 30);
        let flow = FlowField { size, data: vec![[1.0, 0.0]; size.pixels()] };
        let pair = DemoPair {
            frames: [gray(size), gray(size)],
            arrows: gray(size),
            flow: gray(size),
            truth: gray(size),
            scale_px: 1.0,
            error: gray(size),
            white_px: 1.0,
            accuracy: crate::eval::flow_error(&flow, &flow, None).unwrap(),
            adapter: "a <b> & \"c\"".to_owned(),
            frame_ms: [2.0, 3.0],
        };
        let flight = DemoFlight {
            course: &course,
            config: &config,
            adapter: "d",
            why: Some("<e>"),
            records: &records,
            costs: &costs,
            outcome: None,
            film: &film,
        };
        let page = DemoReport { pair: &pair, flight }.html().unwrap();
        assert_eq!(check(&page), Ok(()));
        assert!(page.contains("a &lt;b&gt; &amp; &quot;c&quot;") && page.contains("&lt;e&gt;"));
        // Two of frames 0 and 2 each, those of the one that is shown first, and those of the pair.
        assert_eq!(page.matches("data:image/jpeg").count(), 4 + 2 + 7);
        assert!(
            FlightFilm::new(&Flight::new([Backend::Cpu, Backend::Cpu], &course, &config).unwrap(), 0)
                .is_err()
        );
    }
}
