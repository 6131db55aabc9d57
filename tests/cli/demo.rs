//! `viewsphere demo` as its users run it.

use std::fs;
use std::path::Path;

use crate::program::{Ended, program, refused};
use serde_json::Value;

const FILES: [&str; 9] = [
    "arrows.png",
    "color.png",
    "confidence.png",
    "error.png",
    "flow.flo",
    "frame_0.png",
    "frame_1.png",
    "index.html",
    "truth.png",
];

/// A second of flight on the CPU.
fn demo(folder: &Path, args: &[&str]) -> Ended {
    let first = ["demo", "--size", "160x120", "--seconds", "1", "--backend", "cpu"];
    program(folder, &[&first, args].concat())
}

#[test]
fn the_page_shows_the_pair_and_the_flight_and_needs_nothing_beside_itself() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let ended = demo(folder, &["-o", "d"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert_eq!(ended.stdout.lines().last(), Some("d/index.html"), "{}", ended.stdout);
    // Without a terminal, progress is plain lines without control characters.
    for text in [&ended.stdout, &ended.stderr] {
        assert!(!text.contains(['\r', '\u{1b}']), "{text:?}");
    }
    let said: Vec<&str> = ended.stderr.lines().collect();
    let expected = [
        "viewsphere: computing on the CPU",
        "viewsphere: the flow of a pair of 160×120",
        "viewsphere: flying: 0 of 1 s",
    ];
    assert_eq!(said, expected);
    let mut names: Vec<_> = (folder.join("d").read_dir().unwrap())
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    assert_eq!(names, FILES);

    let page = fs::read_to_string(folder.join("d/index.html")).unwrap();
    // No addresses, except those of embedded images and of the SVG namespace.
    for (at, _) in page.match_indices("src=\"").chain(page.match_indices("href=")) {
        assert!(page[at..].starts_with("src=\"data:image/"), "{}", &page[at..at + 60]);
    }
    for outside in ["http:", "https:", "url(\"", "@import", "<link", "<iframe"] {
        assert!(!page.contains(outside), "{outside}");
    }
    // The backend and the figures, as in the output.
    let figure = |name: &str| {
        let line = ended.stdout.lines().find(|line| line.starts_with(name));
        line.unwrap_or_else(|| panic!("{name}: {}", ended.stdout)).split_whitespace().collect::<Vec<_>>()
    };
    let backend = figure("backend")[1..].join(" ");
    let [endpoint, angular] = [figure("accuracy")[4], figure("accuracy")[9]];
    for told in [&backend, &format!("{endpoint} px"), angular.trim_end_matches(','), "city", "seed 4"] {
        assert!(page.contains(told), "{told}");
    }
    // Thirty frames, a second at 30 Hz, of two images each; the frame shown first; and the pair's images.
    assert_eq!(page.matches("\"data:image/jpeg;base64,").count(), 60 + 2 + 7);
}

#[test]
fn as_json_the_figures_stand_alone() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["--json", "--quiet", "--world", "wall:distance=40", "--seed", "3", "--seconds", "0.2"];
    let first = ["demo", "--size", "96x72", "--backend", "cpu"];
    let ended = program(folder.path(), &[&first[..], &args].concat());
    assert_eq!((ended.code, ended.stderr.as_str()), (Some(0), ""));
    let told: Value = serde_json::from_str(&ended.stdout).unwrap();
    assert_eq!((&told["width"], &told["page"]), (&96.into(), &"demo/index.html".into()));
    let flight = &told["flight"];
    assert_eq!((&flight["seed"], &flight["timing"]["frames"]), (&3.into(), &6.into()));
    assert_eq!((&flight["why"], &flight["outcome"]), (&Value::Null, &Value::Null));
    let [error_px, clearance_m] =
        [&told["accuracy"]["aee_px"], &flight["least_clearance_m"]].map(|value| value.as_f64().unwrap());
    // Zero flow has an error of some 0.4 px at this size, and the wall is 40 m ahead.
    assert!(error_px < 0.2 && (5.0..40.0).contains(&clearance_m), "{told}");
}

#[test]
fn a_demo_replaces_what_a_demo_wrote_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for name in ["index.html", "color.png"] {
        fs::create_dir(folder.join("d")).unwrap();
        fs::write(folder.join("d").join(name), "<p>mine</p>").unwrap();
        let ended = demo(folder, &["-o", "d"]);
        assert_eq!((ended.code, ended.stderr.lines().count()), (Some(2), 1), "{}", ended.stderr);
        assert!(ended.stderr.contains(&format!("a folder with d/{name}")), "{}", ended.stderr);
        assert_eq!(fs::read_to_string(folder.join("d").join(name)).unwrap(), "<p>mine</p>");
        assert_eq!(folder.join("d").read_dir().unwrap().count(), 1);
        fs::remove_dir_all(folder.join("d")).unwrap();
    }
    for _ in 0..2 {
        let ended = program(folder, &["demo", "--size", "32x24", "--seconds", "0.1", "--backend", "cpu"]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    }
}

#[test]
fn what_cannot_be_shown_is_refused() {
    for (args, words) in [
        (&["--seconds", "0"][..], &["--seconds is 0", "0.1 to 120"][..]),
        (&["--seconds", "NaN"], &["--seconds is NaN"]),
        (&["--seconds", "-3"], &["--seconds is -3"]),
        (&["--seconds", "121"], &["--seconds is 121"]),
        (&["--world", "moon"], &["moon", "forest"]),
        (&["--world", "city:length=-1"], &["length"]),
        (&["--seed", "x"], &["\"x\""]),
    ] {
        refused(&[&["demo", "--backend", "cpu"][..], args].concat(), words);
    }
}
