//! `viewsphere fly` as its users run it.

use std::fs;
use std::path::Path;

use serde_json::Value;
use viewsphere::frame::Image;
use viewsphere::io::Y4mReader;
use viewsphere::sim::CourseKind;

use crate::program::{Ended, program, refused};

/// A wall that is reached soon, and passed soon.
const WALL: &str = "wall:distance=40:width=20:incidence=0:offset=6:past=5";

/// The time between frames.
const FRAME_S: f64 = 1.0 / 30.0;

/// Half a second of flight beside a pole.
const YARD: &str = r#"{
  "format": "viewsphere course", "version": 1, "name": "yard <1>", "seed": 5,
  "start_ned_m": [0, 0, -10], "length_m": 6, "altitude_m": [2, 30],
  "surfaces": [{"kind": "ground"}, {"kind": "cylinder", "base_m": [20, 5, 0], "top_m": [20, 5, -25], "radius_m": 1}]
}"#;

/// Flies into folder `name`.
fn fly(folder: &Path, name: &str, args: &[&str]) -> Ended {
    let first = ["fly", "--world", WALL, "--body", "turn", "--no-video", "-o", name];
    program(folder, &[&first, args].concat())
}

/// The file names in a folder.
fn names(folder: &Path) -> Vec<String> {
    let entries = folder.read_dir().unwrap();
    let mut names: Vec<_> =
        entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// The objects of a log: the header, the frames, the end.
#[track_caller]
fn log(folder: &Path, name: &str) -> (Value, Vec<Value>, Value) {
    let text = fs::read_to_string(folder.join(name).join("flight.jsonl")).unwrap();
    assert!(text.ends_with('\n'));
    let mut lines: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let (end, header) = (lines.pop().unwrap(), lines.remove(0));
    (header, lines, end)
}

#[test]
fn the_log_tells_the_flight_from_beginning_to_end() {
    let folder = tempfile::tempdir().unwrap();
    let ended = fly(folder.path(), "a", &["--sensor", "depth", "--seed", "3", "--fault", "gyro-lost:1..1.5"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stdout.starts_with("outcome    reached after "), "{}", ended.stdout);
    let (header, frames, end) = log(folder.path(), "a");
    for (name, value) in [
        ("viewsphere", env!("CARGO_PKG_VERSION")),
        ("world", "wall:distance=40:width=20:incidence=0:offset=6:past=5"),
        ("policy", "arc"),
        ("danger", "nearness"),
        ("sensor", "depth"),
        ("size", "320x240"),
        ("body", "turn"),
        ("gusts", "none"),
        ("faults", "gyro-lost:1..1.5"),
    ] {
        assert_eq!(header[name], value, "{name}");
    }
    assert_eq!((&header["seed"], &header["backends"]), (&Value::from(3), &Value::Null));
    for (number, frame) in frames.iter().enumerate() {
        assert_eq!(frame["frame"], number);
        let time_s = frame["time_s"].as_f64().unwrap();
        // Exactly: a fault that begins at 1 s begins with frame 30.
        assert!(time_s == number as f64 / 30.0 && header["frame_s"] == FRAME_S);
        for vector in ["position_ned_m", "velocity_ned_m_s", "roll_pitch_yaw_rad", "rate_body_rad_s"] {
            assert_eq!(frame[vector].as_array().unwrap().len(), 3, "{vector}");
        }
        // A command takes effect one frame after its image.
        let decided = number.checked_sub(1).map_or(&Value::Null, |before| &frames[before]["command"]);
        assert!(number == 0 || &frame["acting"] == decided, "{frame}");
        // The gyro's log must cover both frames of a pair: the first frame after the gap has no cue either.
        let lost = (1.0..1.5 + 2.0 * FRAME_S).contains(&time_s);
        let after = (1.5..1.5 + 2.0 * FRAME_S).contains(&time_s);
        assert!(after || frame["invalid"].is_string() == (number == 0 || lost), "{frame}");
        assert_eq!(frame["source"] == "cue", frame["invalid"].is_null(), "{frame}");
    }
    assert_eq!(end["outcome"], "reached");
    assert!(end["progress_m"].as_f64().unwrap() >= header["length_m"].as_f64().unwrap());
    let least_m = frames.iter().map(|frame| frame["clearance_m"].as_f64().unwrap()).fold(f64::MAX, f64::min);
    assert!(end["least_clearance_m"].as_f64().unwrap() <= least_m && least_m > 0.6);
    let timing: Value =
        serde_json::from_str(&fs::read_to_string(folder.path().join("a/timing.json")).unwrap()).unwrap();
    assert_eq!(timing["frames"], frames.len());
    assert!(timing["total_ms"]["median"].as_f64().unwrap() > 0.0);
    let page = fs::read_to_string(folder.path().join("a/report.html")).unwrap();
    for told in
        [WALL, "seed 3", "policy arc over nearness by true depth", "gyro-lost:1..1.5", "<b>reached</b>"]
    {
        assert!(page.contains(told), "{told}");
    }
    assert_eq!(names(&folder.path().join("a")), ["flight.jsonl", "report.html", "timing.json"]);
}

#[test]
fn a_video_shows_every_frame_and_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("yard.json"), YARD).unwrap();
    fs::create_dir(folder.join("a")).unwrap();
    for sensor in [&["--sensor", "depth"][..], &["--backend", "cpu", "--size", "240x180"]] {
        // A file of an earlier flight with --measure.
        fs::write(folder.join("a/flight.jsonl"), "{\"viewsphere\":\"0.1.0\"}\n").unwrap();
        fs::write(folder.join("a/divergence.png"), "").unwrap();
        let args = [&["fly", "--world-file", "yard.json", "--body", "turn", "-o", "a"], sensor].concat();
        let ended = program(folder, &args);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        assert!(ended.stdout.contains("video of"), "{}", ended.stdout);
        let (header, frames, _) = log(folder, "a");
        assert_eq!((&header["world"], &header["seed"]), (&"yard <1>".into(), &5.into()));
        let files = ["flight.jsonl", "flight.y4m", "report.html", "timing.json"];
        assert_eq!(names(&folder.join("a")), files);
        let page = fs::read_to_string(folder.join("a/report.html")).unwrap();
        assert!(page.contains("yard &lt;1&gt;, seed 5"), "{page}");
        let bytes = fs::read(folder.join("a/flight.y4m")).unwrap();
        let mut video = Y4mReader::new(&bytes[..], "flight.y4m").unwrap();
        assert_eq!(video.rate(), Some((10, 1)));
        let (mut image, mut before) = (Image::default(), Image::default());
        while video.next_frame(&mut image).unwrap() {
            assert_ne!(image, before);
            before.clone_from(&image);
        }
        assert_eq!(video.frames_read(), frames.len().div_ceil(3) as u64);
        // The same flight again without --measure, into the same folder: files left by the first one would be mistaken
        // for the second's.
        let whole = fs::read(folder.join("a/flight.jsonl")).unwrap();
        assert!(matches!(program(folder, &args).code, Some(0)));
        assert!(bytes == fs::read(folder.join("a/flight.y4m")).unwrap(), "{sensor:?}");
        let ended = program(folder, &[&args[..], &["--no-video"]].concat());
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        assert_eq!(names(&folder.join("a")), ["flight.jsonl", "report.html", "timing.json"]);
        assert!(whole == fs::read(folder.join("a/flight.jsonl")).unwrap(), "{sensor:?}");
    }
}

#[test]
fn files_that_no_flight_has_written_are_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("yard.json"), YARD).unwrap();
    let args = ["fly", "--world-file", "yard.json", "--sensor", "depth", "--quiet", "-o", "a"];
    for name in ["report.html", "flight.y4m", "flight.jsonl"] {
        fs::create_dir_all(folder.join("a")).unwrap();
        fs::write(folder.join("a").join(name), "mine").unwrap();
        let ended = program(folder, &[&args[..], &["--no-video"]].concat());
        assert_eq!((ended.code, ended.stderr.lines().count()), (Some(2), 1), "{}", ended.stderr);
        assert!(ended.stderr.contains(name), "{}", ended.stderr);
        assert_eq!(fs::read_to_string(folder.join("a").join(name)).unwrap(), "mine");
        assert_eq!(names(&folder.join("a")), [name]);
        fs::remove_dir_all(folder.join("a")).unwrap();
    }
}

#[test]
fn a_video_that_cannot_be_finished_leaves_no_part_of_it() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("yard.json"), YARD).unwrap();
    fs::create_dir_all(folder.join("a/flight.y4m")).unwrap();
    let args = ["fly", "--world-file", "yard.json", "--sensor", "depth", "--quiet", "-o", "a"];
    let ended = program(folder, &args);
    assert_eq!((ended.code, ended.stderr.lines().count()), (Some(2), 1), "{}", ended.stderr);
    assert!(ended.stderr.contains("flight.y4m"), "{}", ended.stderr);
    assert_eq!(names(&folder.join("a")), ["flight.y4m"]);
}

#[test]
fn a_world_that_cannot_be_saved_leaves_no_folder() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::create_dir(folder.join("here")).unwrap();
    for (world, output) in
        [("none/world.json", "a/b"), ("here", "a"), ("here", "here"), ("a/flight.jsonl", "a")]
    {
        let ended = fly(folder, output, &["--sensor", "depth", "--save-world", world]);
        assert_eq!((ended.code, ended.stderr.lines().count()), (Some(2), 1), "{}", ended.stderr);
        assert_eq!(names(folder), ["here"], "{world}");
    }
}

#[test]
fn a_world_that_was_saved_is_flown_as_the_one_it_was_made_of() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let flown = fly(folder, "a", &["--sensor", "depth", "--seed", "4", "--save-world", "a/world.json"]);
    assert_eq!(flown.code, Some(0), "{}", flown.stderr);
    let args = ["fly", "--world-file", "a/world.json", "--body", "turn", "--no-video", "--sensor", "depth"];
    let again = program(folder, &[&args[..], &["-o", "b"]].concat());
    assert_eq!(again.code, Some(0), "{}", again.stderr);
    let [a, b] = ["a", "b"].map(|name| fs::read(folder.join(name).join("flight.jsonl")).unwrap());
    assert!(a == b);
}

#[test]
fn a_world_file_that_is_missing_or_wrong_is_an_error_of_one_line() {
    refused(&["fly", "--world-file", "none.json"], &["none.json"]);
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (from, to, words) in [
        ("}]\n}", "}]", "course file is broken"),
        ("\"length_m\": 6", "\"length_m\": -6", "length_m is -6"),
        ("\"kind\": \"ground\"", "\"kind\": \"sea\"", "kind is \"sea\" in surface 0"),
        ("-10]", "10]", "start_ned_m"),
    ] {
        assert!(YARD.contains(from), "{from}");
        fs::write(folder.join("yard.json"), YARD.replacen(from, to, 1)).unwrap();
        let ended = program(folder, &["fly", "--world-file", "yard.json", "--sensor", "depth"]);
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{words}");
        assert_eq!(ended.stderr.lines().count(), 1, "{}", ended.stderr);
        assert!(ended.stderr.contains("yard.json: ") && ended.stderr.contains(words), "{}", ended.stderr);
        assert_eq!(names(folder), ["yard.json"]);
    }
    // Inputs are not overwritten.
    fs::write(folder.join("flight.jsonl"), YARD).unwrap();
    let ended = program(folder, &["fly", "--world-file", "flight.jsonl", "--sensor", "depth", "-o", "."]);
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    assert_eq!(fs::read_to_string(folder.join("flight.jsonl")).unwrap(), YARD);
}

#[test]
fn every_world_is_told_of() {
    let folder = tempfile::tempdir().unwrap();
    for command in ["fly", "simulate"] {
        let help = program(folder.path(), &[command, "--help"]).stdout;
        for kind in CourseKind::all() {
            let name = kind.name();
            let words = help.split(|c: char| !c.is_alphanumeric() && c != '-');
            assert!(words.into_iter().any(|word| word == name), "{command}: {name}");
        }
    }
}

#[test]
fn every_policy_flies_and_only_those_that_avoid_get_past() {
    let folder = tempfile::tempdir().unwrap();
    for (policy, code) in [("none", 1), ("balance", -1), ("potential", -1), ("heading", 0), ("arc", 0)] {
        let ended =
            fly(folder.path(), policy, &["--sensor", "depth", "--policy", policy, "--quiet", "--json"]);
        assert!(ended.stderr.is_empty(), "{}", ended.stderr);
        let end: Value = serde_json::from_str(&ended.stdout).unwrap();
        assert_eq!(end, log(folder.path(), policy).2);
        let reached = end["outcome"] == "reached";
        assert_eq!(ended.code, Some(i32::from(!reached)), "{policy}");
        // The simple policies need not succeed, only report how they ended.
        assert!(code < 0 || ended.code == Some(code), "{policy}: {end}");
    }
    assert_eq!(log(folder.path(), "none").2["outcome"], "crashed");
}

#[test]
fn the_same_seed_gives_the_same_log_and_another_one_another() {
    let folder = tempfile::tempdir().unwrap();
    let flights = [
        ("depth", vec!["--sensor", "depth"]),
        ("flow", vec!["--truth-flow", "--gusts", "light", "--vanes"]),
        ("noisy", vec!["--sensor", "noisy-flow", "--danger", "blend"]),
        ("images", vec!["--backend", "cpu", "--size", "240x180", "--fault", "dropped=0.2:0.5", "--measure"]),
    ];
    for (name, args) in flights {
        let twice = ["a", "b", "c"].map(|run| {
            let seed = if run == "c" { "9" } else { "8" };
            let to = format!("{name}_{run}");
            let ended = fly(folder.path(), &to, &[&args[..], &["--seed", seed, "--quiet"]].concat());
            assert!(matches!(ended.code, Some(0 | 1)), "{}", ended.stderr);
            fs::read(folder.path().join(to).join("flight.jsonl")).unwrap()
        });
        assert!(twice[0] == twice[1], "{name}");
        assert!(twice[0] != twice[2], "{name}");
    }
}

#[test]
fn pictures_that_fail_are_said_in_the_log() {
    let folder = tempfile::tempdir().unwrap();
    let args = [
        "--backend",
        "cpu",
        "--size",
        "240x180",
        "--seed",
        "8",
        "--fault",
        "nan:1..1.2",
        "--fault",
        "black:2..2.5",
    ];
    let ended = fly(folder.path(), "a", &args);
    assert!(matches!(ended.code, Some(0 | 1)), "{}", ended.stderr);
    let (header, frames, _) = log(folder.path(), "a");
    assert_eq!(header["faults"], "nan:1..1.2+black:2..2.5");
    assert_eq!(header["backends"], serde_json::json!(["cpu", "cpu"]));
    let during = |from_s: f64, until_s: f64| {
        frames.iter().filter(move |frame| {
            let time_s = frame["time_s"].as_f64().unwrap();
            (from_s..until_s).contains(&time_s)
        })
    };
    assert!(during(1.0, 1.2).count() == 6 && during(2.0, 2.5).count() == 15);
    assert!(during(1.0, 1.2).all(|frame| frame["invalid"].is_string()), "{frames:?}");
    // From the first frame on, and for as long as the fault lasts.
    let reasons: Vec<&str> = during(2.0, 2.5).map(|frame| frame["invalid"].as_str().unwrap()).collect();
    assert!(reasons[0].contains("is trusted"), "{reasons:?}");
    assert!(
        reasons[1..].iter().all(|why| *why == "the image is identical to the previous one"),
        "{reasons:?}"
    );
    assert!(during(2.45, 2.5).all(|frame| frame["source"] == "recovery"));
    assert!(during(0.5, 1.0).all(|frame| frame["invalid"].is_null()));
}

#[test]
fn what_is_measured_changes_nothing_of_the_flight() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["--backend", "cpu", "--size", "160x120", "--seed", "8", "--quiet"];
    let plain = fly(folder.path(), "plain", &args);
    assert_eq!(plain.stderr, "", "it was to be quiet");
    let ended = fly(folder.path(), "measured", &[&args[..], &["--measure", "--picture-at", "1.5"]].concat());
    assert_eq!(plain.code, ended.code, "{}", ended.stderr);
    assert!(ended.stdout.contains("divergence at 1.50 s, full colour at ±2 /s"), "{}", ended.stdout);
    let picture = viewsphere::io::picture::read(folder.path().join("measured/divergence.png")).unwrap();
    // Two images of 40 by 30 cells, 4 pixels each, 8 pixels between them and a scale of 30 below.
    assert_eq!(picture.size, "328x150".parse().unwrap());
    assert!(!folder.path().join("plain/divergence.png").exists());
    let [(header, frames, end), (other_header, mut measured, mut measured_end)] =
        ["plain", "measured"].map(|name| log(folder.path(), name));
    assert_eq!(header, other_header);
    for frame in &mut measured {
        let figures = std::mem::take(&mut frame["measured"]);
        assert_eq!(figures.is_null(), frame["invalid"].is_string(), "{frame}");
        assert!(figures.is_null() || figures["trusted"].as_f64().unwrap() > 0.1, "{figures}");
    }
    assert!(measured_end["measured"]["trusted_error_px"].as_f64().unwrap() < 0.3, "{measured_end}");
    measured_end["measured"] = Value::Null;
    assert!((frames, end) == (measured, measured_end));
}

#[test]
fn what_cannot_be_flown_is_an_error_of_one_line_and_leaves_nothing() {
    let fly = |args: &[&str], words: &[&str]| {
        refused(&[&["fly", "--backend", "cpu", "--world", WALL], args].concat(), words);
    };
    refused(&["fly", "--world", "moon"], &["moon", "wall"]);
    refused(&["fly", "--world", "wall:width=x"], &["wall", "width"]);
    fly(&["--speed", "0"], &["--speed is 0, expected 7.", "m/s"]);
    fly(&["--speed", "-3"], &["--speed is -3, expected 7.", "m/s"]);
    fly(&["--speed", "-3", "--body", "turn"], &["--speed is -3, expected 0.1 to 1000 m/s"]);
    fly(&["--policy", "bee"], &["bee", "balance"]);
    fly(&["--danger", "wolf"], &["wolf", "nearness"]);
    fly(&["--sensor", "radar"], &["radar", "depth"]);
    fly(&["--size", "320"], &["320", "WIDTHxHEIGHT"]);
    fly(&["--latency-frames", "31"], &["--latency-frames", "\"31\"", "a whole number from 0 to 30"]);
    fly(&["--fault", "fire"], &["fire", "frozen"]);
    fly(&["--fault", "black:3..2"], &["fault", "3 to 2"]);
    fly(&["--fault", "black", "--sensor", "depth"], &["black:0 with the sensor depth"]);
    fly(&["--fault", "device-lost"], &["device-lost:0 on the CPU"]);
    fly(&["--wind", "1,2"], &["wind", "1,2"]);
    for wind in ["1,2,inf", "nan,0,0", "1e9,0,0", "0,-101,0", "1e300,0,0"] {
        fly(&["--wind", wind], &["wind", wind, "within ±100 m/s"]);
    }
    fly(&["--speed", "500"], &["--speed is 500, expected 7.", "level"]);
    fly(&["--size", "1x1"], &["--size is 1×1, expected at least 2×2"]);
    fly(&["--size", "16384x2"], &["16384×2", "rectangle"]);
    fly(&["--fault", "gyro-bias=5", "--sensor", "depth"], &["gyro-bias=5:0 with the sensor depth"]);
    fly(&["--fault", "gyro-bias=1e300"], &["gyro bias", "2005"]);
    fly(&["--truth-flow", "--sensor", "depth"], &["--truth-flow"]);
    fly(&["--world-file", "a.json"], &["--world-file", "--world"]);
    refused(&["fly", "--world-file", "a.json", "--seed", "1"], &["--world-file", "--seed"]);
    refused(&["fly", "--world-file", "a.json", "--save-world", "b.json"], &["--save-world"]);
    fly(&["--measure", "--sensor", "flow"], &["measure", "the sensor flow", "images"]);
    fly(&["--picture-at", "1"], &["--measure"]);
    fly(&["--measure", "--picture-at", "NaN"], &["--picture-at", "NaN"]);
    fly(&["--fov-deg", "150"], &["--fov-deg is 150, expected 20 to 120"]);
    fly(&["--steer", "radius_m"], &["--steer is \"radius_m\", expected NAME=VALUE"]);
    fly(&["--steer", "colour=3"], &["steering parameter is \"colour\", expected reading, post_m, "]);
    fly(&["--steer", "memory_s=-1"], &["memory_s is -1, expected 0 to 10"]);
    fly(&["--adapter", "x"], &["--adapter", "--backend cpu"]);
    fly(&["--adapter", "x", "--sensor", "depth"], &["--adapter", "--backend cpu"]);
    refused(&["fly", "--world", "forest:radius=1:radius=2"], &["radius=2", "each parameter once"]);
    fly(&["--seed", "-1"], &["--seed", "\"-1\"", "a whole number from 0 on", "see viewsphere fly --help"]);
    fly(&["--seed", "1.5"], &["--seed", "a whole number from 0 on"]);
    fly(&["--latency-frames", "-1"], &["--latency-frames", "\"-1\"", "a whole number from 0 to 30"]);
    fly(&["--measure", "--picture-at", "-1"], &["--picture-at is -1"]);
    fly(&["--size", "-1x2"], &["'-1'", "a negative number is not expected here; see viewsphere fly"]);
    fly(&["-o", "/proc/x/y", "--sensor", "depth"], &["/proc/x/y: "]);
}
