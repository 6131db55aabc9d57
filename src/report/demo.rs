//! What the program does, on one page.

use image::RgbImage;
use image::imageops::thumbnail;

use super::flight::page::quantile;
use super::flight::{FlightFilm, curves, player};
use super::html::{data_uri, escape, figure, figures, page_with, paragraph, section, tile};
use crate::error::Result;
use crate::eval::FlowError;
use crate::frame::{FlowField, Image, PixelFormat, Size, colour_wheel, picture};
use crate::sim::Course;
use crate::sim::flight::{Cost, FRAME_S, FlightConfig, Outcome, Record};

/// What stands in the head of a page that was made of a demo.
pub(crate) const GENERATOR: &str = "<meta name=\"generator\" content=\"viewsphere demo\"/>";
/// No picture of the pair is wider in the page.
const WIDEST: u32 = 640;
const QUALITY: u8 = 85;
/// Width of the drawings of the curves.
const CURVES: f64 = 520.0;

/// The flow of a pair of pictures whose motion is known.
#[derive(Clone, Debug)]
pub struct DemoPair {
    /// The two pictures.
    pub frames: [Image; 2],
    /// The computed flow as arrows over the first one.
    pub arrows: Image,
    /// The computed flow as colours.
    pub flow: Image,
    /// The true flow as colours, to the same scale.
    pub truth: Image,
    /// The displacement in full colour, pixels.
    pub scale_px: f32,
    /// The length of the difference between the two, black to white.
    pub error: Image,
    /// The difference that is white, pixels.
    pub white_px: f32,
    /// How far the computed flow is from the true one.
    pub accuracy: FlowError,
    /// What computed it.
    pub adapter: String,
    /// What a frame takes in a stream of them: median and longest, milliseconds.
    pub frame_ms: [f64; 2],
}

/// A flight, or its beginning.
#[derive(Clone, Copy, Debug)]
pub struct DemoFlight<'a> {
    /// Where it led through.
    pub course: &'a Course,
    /// How it was flown.
    pub config: &'a FlightConfig,
    /// What drew the pictures and computed the flow.
    pub adapter: &'a str,
    /// Why that is another one than the pair's, if it is.
    pub why: Option<&'a str>,
    /// All its frames.
    pub records: &'a [Record],
    /// What each frame cost, in their order.
    pub costs: &'a [Cost],
    /// How it ended, if it did.
    pub outcome: Option<Outcome>,
    /// What there is to see.
    pub film: &'a FlightFilm,
}

/// What `viewsphere demo` shows: the flow of a pair, and a flight that is steered by flow.
#[derive(Clone, Copy, Debug)]
pub struct DemoReport<'a> {
    /// The pair.
    pub pair: &'a DemoPair,
    /// The flight.
    pub flight: DemoFlight<'a>,
}

/// What the parts of a frame cost, and what they are called.
const PARTS: [(&str, fn(&Cost) -> f64); 3] = [
    ("picture rendered", |cost| 1e3 * cost.sight.as_secs_f64()),
    ("picture to sectors", |cost| 1e3 * cost.pipeline.as_secs_f64()),
    ("sectors to command", |cost| 1e3 * cost.steer.as_secs_f64()),
];

impl DemoReport<'_> {
    /// Both on one page of HTML that needs nothing beside itself: its pictures are part of it.
    ///
    /// # Errors
    /// Those of a picture or a flow that contradicts itself.
    pub fn html(&self) -> Result<String> {
        let head = format!("{GENERATOR}\n{}", player::script());
        let mut body = "<p class=\"lead\">viewsphere measures how every pixel moves from one camera picture to the next (dense \
                        optical flow), tells from it what will be met in how many seconds, and steers an aircraft by that. This \
                        page shows it on made-up pictures, whose truth is known; all of it was computed on this machine when the \
                        page was made.</p>\n"
            .to_owned();
        body += &self.tiles();
        body += &section(
            "Flow of a pair of pictures",
            "The background turns and comes nearer; a disc in front of it moves to the right and up. Every picture is sampled from \
             the scene itself, so that the true flow is known in closed form.",
            &self.pair.html()?,
        );
        body += &section(
            "A flight by flow alone",
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
            (
                "flight",
                format!(
                    "camera of {}, {} × {} sectors, {:.0} pictures a second, {} frames",
                    flight.config.camera.size,
                    flight.config.pipeline.sphere.sectors[0],
                    flight.config.pipeline.sphere.sectors[1],
                    1.0 / FRAME_S,
                    flight.records.len(),
                ),
            ),
        ];
        let spread = |of: &dyn Fn(&Cost) -> f64| {
            let times: Vec<f64> = flight.costs.iter().map(of).collect();
            let [median, high] = [0.5, 0.99].map(|share| quantile(times.clone(), share).unwrap_or(f64::NAN));
            (median, format!("{median:.2} ms in the median, {high:.2} ms at the 99th percentile"))
        };
        rows.extend(PARTS.map(|(name, part)| (name, spread(&part).1)));
        let (median, text) = spread(&|cost| 1e3 * cost.total().as_secs_f64());
        rows.push(("all of a frame", format!("{text}; {:.0} frames a second", 1e3 / median)));
        let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        rows.push((
            "machine",
            format!("{} on {}, {threads} threads", std::env::consts::OS, std::env::consts::ARCH),
        ));
        rows.push(("program", format!("viewsphere {}", env!("CARGO_PKG_VERSION"))));
        rows
    }
}

impl DemoPair {
    fn html(&self) -> Result<String> {
        let e = &self.accuracy;
        let scale = format!("{:.1} px", self.scale_px);
        let pictures = [
            (&self.frames[0], "The first picture".to_owned(), "The first picture: gray texture and a disc"),
            (&self.frames[1], "The second picture".to_owned(), "The second picture, a little later"),
            (&self.arrows, "The computed flow as arrows".to_owned(), "Arrows over the first picture, one every 16 pixels"),
            (&self.flow, format!("The computed flow as colours, full at {scale}"), "Computed flow: hue is the direction"),
            (&self.truth, "The true flow, to the same scale".to_owned(), "True flow: nearly the same colours"),
            (
                &self.error,
                format!("Its error: black 0, white {} px and more", self.white_px),
                "Error of the flow: dark nearly everywhere, bright at the edge of the disc",
            ),
        ];
        let mut html = String::from("<div class=\"pictures\">\n");
        for (image, caption, alt) in &pictures {
            html += &embedded(image, alt, caption)?;
        }
        html += "</div>\n";
        let rows = [
            ("mean endpoint error", format!("{:.4} px", e.aee_px)),
            ("mean angular error", format!("{:.3}°", e.aae_deg)),
            ("more than 1 px off", format!("{:.2} % of {} pixels", 100.0 * e.r1, e.pixels)),
        ];
        html += &figures(&rows);
        let about = format!("Which colour is which direction; the rim is {scale}.");
        Ok(html + "<div class=\"key\">" + &embedded(&wheel()?, "The colour wheel of directions", &about)? + "</div>\n")
    }
}

impl DemoFlight<'_> {
    fn about(&self) -> String {
        format!(
            "A fixed wing of {:.1} m span flies through the made-up world “{}”, seed {}, at {} m/s. It has one camera, a gyro and an \
             airspeed sensor, and knows the direction of its goal; every picture is rendered where it has flown to. From the flow \
             of each pair follow the times to contact of all sectors, from these the arc that it flies next.",
            2.0 * self.config.radius_m,
            self.course.name,
            self.course.seed,
            self.config.speed_m_s,
        )
    }

    fn curves(&self) -> String {
        let about = "Time to contact ahead, as the view says and in truth, and the bank that is commanded and flown; positive is the \
                     right wing down. The line is the frame that is shown.";
        let curves = curves::contact_and_bank(self.records, CURVES).concat();
        format!("{}<div class=\"curves\">\n{curves}</div>\n", paragraph(about))
    }

    fn state(&self) -> String {
        let time_s = self.records.len() as f64 * FRAME_S;
        match self.outcome {
            Some(outcome) => outcome.to_string(),
            None => format!("{time_s:.0} s without a crash"),
        }
    }

    fn clearance_m(&self) -> f64 {
        self.records.iter().map(|record| record.clearance_m).fold(f64::INFINITY, f64::min)
    }

    /// From a picture to a command, in the median.
    fn onboard_ms(&self) -> Option<f64> {
        let onboard = |cost: &Cost| 1e3 * (cost.pipeline + cost.steer).as_secs_f64();
        quantile(self.costs.iter().map(onboard).collect(), 0.5)
    }
}

fn milliseconds(time_ms: Option<f64>) -> String {
    time_ms.map_or("–".to_owned(), |time_ms| format!("{time_ms:.1} ms"))
}

/// A picture that is part of the page.
fn embedded(image: &Image, alt: &str, caption: &str) -> Result<String> {
    let image = shrunk(image);
    let uri = data_uri("image/jpeg", &picture::encode_jpeg(&image, QUALITY)?);
    Ok(figure(&uri, image.size, alt, caption))
}

/// The picture in RGB, and no wider than [`WIDEST`].
fn shrunk(image: &Image) -> Image {
    let Size { width, height } = image.size;
    let data: Vec<u8> = match image.format {
        PixelFormat::Gray8 => image.data.iter().flat_map(|gray| [*gray; 3]).collect(),
        _ => image.data.clone(),
    };
    let whole = RgbImage::from_raw(width, height, data).unwrap_or_default();
    let (whole, size) = match width {
        ..=WIDEST => (whole, image.size),
        _ => {
            let size = Size::new(WIDEST, (height * WIDEST / width).max(1));
            (thumbnail(&whole, size.width, size.height), size)
        }
    };
    Image { size, format: PixelFormat::Rgb8, data: whole.into_raw() }
}

/// The colours of all directions, longest at the rim.
fn wheel() -> Result<Image> {
    const SIDE: u32 = 120;
    let centre = 0.5 * (SIDE - 1) as f32;
    let off = |at: u32| (at as f32 - centre) / centre;
    let rows = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| [off(x), off(y)]));
    // Beyond the rim there is nothing, which is white.
    let inside = |uv: [f32; 2]| if uv[0].hypot(uv[1]) <= 1.0 { uv } else { [0.0; 2] };
    let flow = FlowField { size: Size::new(SIDE, SIDE), data: rows.map(inside).collect() };
    Ok(colour_wheel(&flow, Some(1.0))?.0)
}

/// Three commands to go on with.
fn next() -> String {
    let commands = [
        ("Fly through another world to the end, with a log, a report and a video", "viewsphere fly --world wires --seed 2 -o flight/"),
        ("Compute the flow between two pictures of your own", "viewsphere flow a.png b.png -o flow.flo --color flow.png"),
        (
            "Get times to contact from your own camera and gyro, with a video of what is made of them",
            "viewsphere run flight.y4m --camera cam.yaml --gyro gyro.csv --overlay seen.y4m",
        ),
    ];
    let command = |(about, line): (&str, &str)| format!("{}<pre><code>{}</code></pre>\n", paragraph(about), escape(line));
    commands.into_iter().map(command).collect::<String>()
        + &paragraph("From the source folder, “cargo run --release --” stands for “viewsphere”; every command has a --help with examples.")
}
