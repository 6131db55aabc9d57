use std::path::Path;

use glam::{DMat3, DVec2, DVec3};
use proptest::prelude::*;

use super::*;
use crate::error::Result;
use crate::sim::course::{Course, CourseKind, MAX_SURFACES};
use crate::sim::{Surface, World};

const YARD: &str = r#"{
  "format": "viewsphere course", "version": 1, "name": "yard",
  "start_ned_m": [0, 0, -10], "length_m": 120, "altitude_m": [2, 30],
  "surfaces": [
    {"kind": "ground"},
    {"kind": "wall", "from_m": [80, -20], "to_m": [90, 30], "height_m": 40},
    {"kind": "cylinder", "base_m": [40, 5, 0], "top_m": [40, 5, -25], "radius_m": 0.3},
    {"kind": "box", "centre_m": [60, -15, -10], "edges_m": [12, 16, 20], "yaw_rad": 0.5}
  ]
}"#;

fn load(text: &str) -> Result<Course> {
    decode(Path::new("a.json"), text.as_bytes())
}

/// The message for the example with one thing replaced.
fn error(from: &str, to: &str) -> String {
    assert!(YARD.contains(from), "{from}");
    load(&YARD.replacen(from, to, 1)).unwrap_err().to_string()
}

#[test]
fn a_file_by_hand_is_read() {
    let course = load(YARD).unwrap();
    let expected = Course {
        name: "yard".to_owned(),
        seed: 0,
        world: World {
            surfaces: vec![
                Surface::plane(DVec3::ZERO, DVec3::NEG_Z).unwrap(),
                Surface::rectangle(
                    DVec3::new(85.0, 5.0, -20.0),
                    DVec3::new(5.0, 25.0, 0.0),
                    DVec3::new(0.0, 0.0, -20.0),
                )
                .unwrap(),
                Surface::cylinder(DVec3::new(40.0, 5.0, 0.0), DVec3::new(40.0, 5.0, -25.0), 0.3).unwrap(),
                Surface::cuboid(
                    DVec3::new(60.0, -15.0, -10.0),
                    DMat3::from_rotation_z(0.5),
                    DVec3::new(12.0, 16.0, 20.0),
                )
                .unwrap(),
            ],
            up_world: DVec3::NEG_Z,
        },
        start_ned_m: DVec3::new(0.0, 0.0, -10.0),
        start_yaw_rad: 0.0,
        goal_yaw_rad: 0.0,
        length_m: 120.0,
        altitude_m: [2.0, 30.0],
        centre_line_m: vec![],
    };
    assert_eq!(course, expected);
}

#[test]
fn the_example_that_is_shown_is_read() {
    let page = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/worlds.md"));
    let example = page.split("```json\n").nth(1).unwrap().split("```").next().unwrap();
    assert_eq!(load(example).unwrap(), load(YARD).unwrap());
}

#[test]
fn the_courses_of_all_kinds_are_read_as_they_were_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("course.json");
    for kind in CourseKind::all() {
        for seed in [0, 5, u64::MAX] {
            let course = kind.course(seed).unwrap();
            write(&path, &course).unwrap();
            assert_eq!(read(&path).unwrap(), course, "{kind} {seed}");
        }
    }
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1, "a temporary file remains");
}

#[test]
fn what_is_wrong_is_named_with_its_place() {
    let cases = [
        ("\"viewsphere course\"", "\"gazebo\"", "format is \"gazebo\", expected \"viewsphere course\""),
        ("\"version\": 1", "\"version\": 2", "version is 2, expected 1"),
        (
            "\"version\": 1",
            "\"version\": \"1\"",
            "version is \"1\", expected a whole number from 0 to 2^64 - 1",
        ),
        (
            "\"name\": \"yard\"",
            "\"name\": \"a\\nb\"",
            "name is \"a\\nb\", expected a line of 1 to 200 characters",
        ),
        ("\"name\": \"yard\",", "", "name is missing, expected exactly one"),
        (
            "\"name\": \"yard\"",
            "\"nam\": \"yard\"",
            "member is \"nam\", expected format, version, name, seed, ",
        ),
        ("\"name\"", "\"gaol\": 3, \"name\"", "member is \"gaol\", expected format, version, name, seed, "),
        ("120", "0", "length_m is 0, expected above 0 to 1000000"),
        ("120", "1e300", "length_m is 1e300, expected a number within ±1000000"),
        ("120", "NaN", "course file is broken: expected value at line 3 column 43, expected JSON"),
        ("120", "1e999", "course file is broken: number out of range at line 3"),
        ("[2, 30]", "[30, 2]", "altitude_m is 30 to 2, expected a band with the lower end first"),
        ("[2, 30]", "[2]", "altitude_m is of length 1, expected an array of length 2"),
        (
            "-10]",
            "10]",
            "start_ned_m is [0, 0, 10], -10 m from the nearest surface, expected a position outside all surfaces",
        ),
        (
            "-10]",
            "-31]",
            "start_ned_m is [0, 0, -31], at an altitude of 31 m, expected one within altitude_m, 2 to 30 m",
        ),
        ("\"version\": 1", "\"version\": 1, \"version\": 1", "version is given twice, expected exactly one"),
        ("0.3", "0.3, \"radius_m\": 0.4", "radius_m is given twice in surface 2, expected exactly one"),
        (
            "\"ground\"",
            "\"cone\"",
            "kind is \"cone\" in surface 0, expected ground, plane, wall, rectangle, cylinder, box",
        ),
        ("\"ground\"", "3", "kind is 3 in surface 0, expected the name of a kind"),
        (
            "{\"kind\": \"ground\"}",
            "\"ground\"",
            "surface is \"ground\" in surface 0, expected an object in braces",
        ),
        (", \"radius_m\": 0.3", "", "radius_m is missing in surface 2, expected exactly one"),
        ("0.3", "-0.3", "cylinder radius is -0.3 in surface 2, expected above 0 m and finite"),
        ("-25]", "0]", "cylinder axis is [0, 0, 0] in surface 2, expected a finite vector that is not 0"),
        (
            "[12, 16, 20]",
            "[12, 16, null]",
            "edges_m[2] is null in surface 3, expected a number within ±1000000",
        ),
        (
            "\"yaw_rad\"",
            "\"roll_rad\"",
            "member is \"roll_rad\" in surface 3, expected kind, centre_m, edges_m, yaw_rad, axes",
        ),
        (
            "\"yaw_rad\": 0.5",
            "\"axes\": [[1, 0, 0], [0, 1, 0]]",
            "axes is of length 2 in surface 3, expected an array of length 3",
        ),
        (
            "\"yaw_rad\": 0.5",
            "\"axes\": [[2, 0, 0], [0, 1, 0], [0, 0, 1]]",
            "world_from_box is [[2, 0, 0], [0, 1, 0], [0, 0, 1]] in surface 3, expected a rotation",
        ),
        ("\"surfaces\": [", "\"surfaces\": 3, \"rest\": [", "surfaces is 3, expected an array in brackets"),
        (
            "\"yaw_rad\": 0.5",
            "\"yaw_rad\": 0.5, \"axes\": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]",
            "yaw_rad is 0.5 beside axes in surface 3, expected at most one of the two",
        ),
        (
            "\"yaw_rad\": 0.5",
            "\"yaw_rad\": null",
            "yaw_rad is null in surface 3, expected a number within ±1000000",
        ),
        (
            "{\"kind\": \"ground\"}",
            "[\"ground\"]",
            "surface is an array in surface 0, expected an object in braces",
        ),
        ("0.3", "1e999", "surface is broken: number out of range in surface 2, expected JSON"),
        ("]\n}", "]\n", "course file is broken: EOF while parsing an object at line"),
    ];
    let mut wrong = vec![];
    for (from, to, expected) in cases {
        let found = error(from, to);
        if !found.starts_with(&format!("a.json: {expected}")) || found.contains('\n') {
            wrong.push(found);
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn a_file_that_is_no_object_is_refused() {
    for (text, found) in [("", "broken: EOF"), ("[]", "an array"), ("3", "3"), (" \"yard\"", "\"yard\"")] {
        let message = load(text).unwrap_err().to_string();
        assert!(message.starts_with(&format!("a.json: course file is {found}")), "{message}");
    }
    let message = load("[\"viewsphere course\", 1]").unwrap_err().to_string();
    assert_eq!(message, "a.json: course file is an array, expected an object in braces");
}

/// The members of another version do not matter: its version is the error.
#[test]
fn another_version_is_named_first() {
    assert_eq!(error("\"version\": 1", "\"version\": 2, \"fog\": []"), "a.json: version is 2, expected 1");
}

#[test]
fn a_file_that_is_written_has_a_line_for_each_surface() {
    let text = encode(&load(YARD).unwrap()).unwrap();
    assert!(text.starts_with("{\n  \"format\": \"viewsphere course\",\n  \"version\": 1,\n"), "{text}");
    assert!(text.contains("\n  \"start_ned_m\": [0.0, 0.0, -10.0],\n"), "{text}");
    assert!(
        text.contains("\n  \"surfaces\": [\n    {\"kind\": \"ground\"},\n    {\"kind\": \"rectangle\", "),
        "{text}"
    );
    assert!(text.ends_with("}\n  ]\n}\n") && !text.contains("centre_line_m"), "{text}");
    let bent = Course { centre_line_m: vec![DVec2::ZERO, DVec2::X], ..load(YARD).unwrap() };
    let text = encode(&bent).unwrap();
    assert!(text.contains("\n  \"centre_line_m\": [\n    [0.0, 0.0],\n    [1.0, 0.0]\n  ],\n"), "{text}");
    let empty = Course { world: World { surfaces: vec![], ..bent.world }, ..bent };
    assert!(encode(&empty).unwrap().ends_with("\"surfaces\": []\n}\n"));
}

#[test]
fn what_is_too_large_is_refused() {
    let many = "{\"kind\": \"ground\"}, ".repeat(MAX_SURFACES) + "{\"kind\": \"ground\"}";
    let found = error("{\"kind\": \"ground\"}", &many);
    assert_eq!(found, "a.json: surfaces is 16388, expected at most 16384");
    let found = decode(Path::new("a.json"), &vec![b' '; (16 << 20) + 1]).unwrap_err().to_string();
    assert_eq!(found, "a.json: file length is over 16777216 bytes, expected at most 16777216 bytes");
    let found = error("yard", &"a".repeat(1000));
    assert!(found.len() < 200, "{found}");
}

#[test]
fn what_could_not_be_read_is_not_written() {
    let good = load(YARD).unwrap();
    let mut far = good.clone();
    far.world.surfaces.push(Surface::plane(DVec3::Z * 2e6, DVec3::NEG_Z).unwrap());
    let cases = [
        (Course { length_m: f64::NAN, ..good.clone() }, "length_m is NaN"),
        (Course { start_yaw_rad: f64::INFINITY, ..good.clone() }, "start_yaw_rad is inf"),
        (Course { centre_line_m: vec![DVec2::ZERO], ..good.clone() }, "centre_line_m is 1 points"),
        (Course { name: String::new(), ..good.clone() }, "name is \"\""),
        (Course { start_ned_m: DVec3::NAN, ..good }, "start_ned_m is [NaN, NaN, NaN]"),
        (far, "world is one whose surface 4 is too far away, expected within ±1000000 m"),
    ];
    for (course, expected) in cases {
        let found = encode(&course).unwrap_err().to_string();
        assert!(found.starts_with(expected), "{found}");
    }
}

fn vector() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(prop_oneof![-1e3..1e3, -1e-9..1e-9, Just(0.0)]).prop_map(DVec3::from)
}

fn any_surface() -> impl Strategy<Value = Surface> {
    let made = (0..4, vector(), vector(), vector(), 1e-3..1e3_f64, -4.0..4.0_f64).prop_map(
        |(kind, a, b, c, size, turn)| match kind {
            0 => Surface::plane(a, b),
            1 => Surface::rectangle(a, b, b.cross(c)),
            2 => Surface::cylinder(a, b, size),
            _ => Surface::cuboid(a, DMat3::from_axis_angle(b.normalize_or(DVec3::Z), turn), c.abs() + size),
        },
    );
    made.prop_filter_map("not a surface", Result::ok)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_number_is_read_as_it_was_written(
        surfaces in prop::collection::vec(any_surface(), 0..6),
        centre_line in prop::collection::vec(prop::array::uniform2(-1e6..1e6_f64), 2..5),
        seed in any::<u64>(),
        name in "[^\\p{Cc}]{1,20}",
        numbers in (-7.0..7.0_f64, -7.0..7.0_f64, 1e-6..1e6_f64, 0.0..100.0_f64, 100.0..200.0_f64),
        start in vector(),
        climbed in 0.0..=1.0_f64,
    ) {
        let (start_yaw_rad, goal_yaw_rad, length_m, low, high) = numbers;
        // A start outside the band would be an error.
        let start = DVec3 { z: -(low + climbed * (high - low)).min(high), ..start };
        let world = World { surfaces, up_world: DVec3::NEG_Z };
        prop_assume!(world.clearance_m(start) > 0.0);
        let course = Course {
            name, seed, world, start_ned_m: start, start_yaw_rad, goal_yaw_rad, length_m, altitude_m: [low, high],
            centre_line_m: centre_line.into_iter().map(DVec2::from).collect(),
        };
        let Ok(text) = encode(&course) else { return Ok(()) };
        prop_assert_eq!(load(&text).unwrap(), course);
    }

    #[test]
    fn noise_never_panics(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let _ = decode(Path::new("a"), &bytes);
    }

    #[test]
    fn a_file_that_is_cut_or_changed_never_panics(at in 0..YARD.len(), byte in any::<u8>(), word in 0..9_usize) {
        let mut bytes = YARD.as_bytes().to_vec();
        let _ = decode(Path::new("a"), &bytes[..at]);
        let words = ["1e308", "-0", "null", "[]", "{}", "\"\"", "18446744073709551616", "1e-320", "true"];
        let replaced = [&bytes[..at], words[word].as_bytes(), &bytes[at + 1..]].concat();
        let _ = decode(Path::new("a"), &replaced);
        bytes[at] = byte;
        let _ = decode(Path::new("a"), &bytes);
    }
}
