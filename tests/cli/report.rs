//! The reports of a flight: its video and its page.

use viewsphere::Backend;
use viewsphere::frame::{Image, PixelFormat, Size};
use viewsphere::report::flight::{FlightReport, FlightVideo};
use viewsphere::sim::flight::{Flight, FlightConfig, Sensor, camera};
use viewsphere::sim::{Course, CourseKind};

/// The number of frames flown.
const FRAMES: usize = 40;

fn course(name: &str) -> Course {
    name.parse::<CourseKind>().unwrap().course(3).unwrap()
}

fn config(sensor: Sensor, faults: &[&str]) -> FlightConfig {
    let faults = faults.iter().map(|fault| fault.parse().unwrap()).collect();
    let mut config =
        FlightConfig { sensor, camera: camera(Size::new(160, 120)), faults, ..FlightConfig::default() };
    config.pipeline.sphere.sectors = [12, 9];
    config.pipeline.read_flow = true;
    config
}

/// The last frame of a video.
fn filmed(course: &Course, config: &FlightConfig) -> Image {
    let mut flight = Flight::new([Backend::Cpu, Backend::Cpu], course, config).unwrap();
    let mut video = FlightVideo::new(&flight).unwrap();
    let (size, mut last) = (video.size(), None);
    for _ in 0..FRAMES {
        let step = flight.step(|seen| {
            last = Some(video.draw(seen)?.clone());
            Ok(())
        });
        assert_eq!(step.unwrap(), None);
    }
    let last = last.unwrap();
    assert_eq!((last.size, last.format, last.data.len()), (size, PixelFormat::Rgb8, 3 * size.pixels()));
    last
}

/// The number of pixels of about a colour.
fn count(image: &Image, colour: [u8; 3]) -> usize {
    let near = |pixel: &&[u8; 3]| pixel.iter().zip(colour).all(|(a, b)| a.abs_diff(b) < 12);
    image.data.as_chunks::<3>().0.iter().filter(near).count()
}

const ARC: [u8; 3] = [70, 235, 200];
const SOLID: [u8; 3] = [122, 132, 150];
const WRONG: [u8; 3] = [255, 92, 92];

#[test]
fn a_video_shows_the_arc_the_world_and_what_is_wrong() {
    for sensor in [Sensor::Depth, Sensor::Images] {
        let image = filmed(&course("city"), &config(sensor, &[]));
        // A line of some 20 m in the map, the ribbon's edges, and the line in the map of danger.
        assert!(count(&image, ARC) > 300, "{sensor:?} {} {}", count(&image, ARC), count(&image, WRONG));
        // A house is 15 m wide, at 8 pixels per metre.
        assert!(count(&image, SOLID) > 2000, "{sensor:?} {}", count(&image, SOLID));
        assert_eq!(count(&image, WRONG), 0, "{sensor:?}");
    }
    let image = filmed(&course("city"), &config(Sensor::Images, &["gyro-lost:1"]));
    assert!(count(&image, WRONG) > 100 && count(&image, ARC) == 0);
}

#[test]
fn every_world_is_drawn() {
    for kind in CourseKind::all() {
        let course = kind.course(1).unwrap();
        let image = filmed(&course, &config(Sensor::Depth, &[]));
        assert!(count(&image, SOLID) > 20, "{}: {}", course.name, count(&image, SOLID));
    }
}

#[test]
fn a_page_needs_nothing_beside_itself_and_tells_the_flight() {
    let course = Course { name: "<city> & \"more\"".to_owned(), length_m: 40.0, ..course("city") };
    let config = config(Sensor::Images, &["black:1..1.5"]);
    let mut flight = Flight::new([Backend::Cpu, Backend::Cpu], &course, &config).unwrap();
    let (mut records, mut costs) = (Vec::new(), Vec::new());
    let summary = loop {
        let end = flight.step(|seen| {
            records.push(seen.record.clone());
            Ok(())
        });
        costs.push(flight.cost());
        if let Some(summary) = end.unwrap() {
            break summary;
        }
    };
    let report = FlightReport {
        course: &course,
        config: &config,
        backend: "the <CPU>",
        records: &records,
        summary: &summary,
        costs: &costs,
    };
    let html = report.html();
    assert!(html.contains("&lt;city&gt; &amp; &quot;more&quot;, seed 3") && !html.contains("<city>"));
    assert!(html.contains("<b>reached</b>") && html.contains("the &lt;CPU&gt;"));
    // The fault, and its effect on the cue, with the reason.
    assert!(html.contains("black:1..1.5") && html.contains("of the view is trusted"));
    for foreign in ["http:", "https:", "<script", "<link", "src=", "@import", "NaN", "inf\""] {
        assert!(!html.contains(foreign), "{foreign}");
    }
    for element in
        ["html", "head", "body", "main", "section", "table", "tr", "td", "svg", "g", "text", "clipPath"]
    {
        let [open, close] = [format!("<{element}"), format!("</{element}>")];
        let begins = |(at, _): &(usize, &str)| !html[at + open.len()..].starts_with(char::is_alphanumeric);
        let opened = html.match_indices(&open).filter(begins).count();
        assert_eq!(opened, html.matches(&close).count(), "{element}");
        assert!(opened > 0, "{element}");
    }
    assert_eq!(html.matches("<svg").count(), 8);
    let empty = FlightReport { costs: &[], ..report }.html();
    assert_eq!(empty.matches("<svg").count(), 7);
    let first = FlightReport { records: &records[..1], costs: &costs[..1], ..report }.html();
    assert!(!first.contains("NaN"));
}
