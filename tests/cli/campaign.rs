//! `viewsphere campaign` as its users run it.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::program::{Ended, program, refused};

/// A wall that is reached soon, and passed soon.
const WALL: &str = "wall:distance=40:width=20:incidence=0:past=5";
/// Settings that are cheap to fly.
const CHEAP: [&str; 6] = ["--sensors", "depth", "--body", "turn", "--sizes", "96x72"];

fn campaign(folder: &Path, name: &str, args: &[&str]) -> Ended {
    let all = [&["campaign", "--worlds", WALL, "-o", name], &CHEAP[..], args].concat();
    program(folder, &all)
}

#[track_caller]
fn well(ended: Ended) -> Ended {
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended
}

fn read(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap()
}

/// The files that a campaign wrote.
fn files(folder: &Path, name: &str) -> [String; 4] {
    ["results.jsonl", "table.csv", "table.json", "report.html"]
        .map(|file| read(folder, &format!("{name}/{file}")))
}

#[test]
fn threads_and_shards_do_not_change_what_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let args = ["--policies", "none,arc", "--seeds", "0..4"];
    let with = |more: &[&'static str]| [&args[..], more].concat();
    let one = well(campaign(folder, "one", &with(&["--jobs", "1"])));
    let three = well(campaign(folder, "three", &with(&["--jobs", "3"])));
    assert_eq!(files(folder, "one"), files(folder, "three"));
    assert_eq!(one.stdout, three.stdout);
    for shard in ["1/3", "2/3", "3/3"] {
        let name = format!("part_{}", &shard[..1]);
        well(campaign(folder, &name, &with(&["--shard", shard])));
        let lines = read(folder, &format!("{name}/results.jsonl")).lines().count();
        assert!((3..=4).contains(&lines), "{shard}: {lines}");
    }
    let merged =
        well(program(folder, &["campaign", "merge", "part_3", "part_1", "part_2", "part_1", "-o", "merged"]));
    assert_eq!(files(folder, "one"), files(folder, "merged"));
    assert_eq!(one.stdout, merged.stdout);
}

#[test]
fn an_empty_shard_is_told_and_other_files_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let args = ["--seeds", "0..2", "--shard", "3/3"];
    let ended = well(campaign(folder, "part", &args));
    assert!(ended.stderr.contains("shard 3/3 of 2 flights is empty"), "{}", ended.stderr);
    assert!(well(campaign(folder, "part", &[&args[..], &["--quiet"]].concat())).stderr.is_empty());
    fs::create_dir(folder.join("foreign")).unwrap();
    fs::write(folder.join("foreign/report.html"), "my own").unwrap();
    let ended = campaign(folder, "foreign", &args);
    let words = ["-o is a folder with foreign/report.html", "the results.jsonl of an earlier campaign"];
    assert!(
        ended.code == Some(2) && words.iter().all(|word| ended.stderr.contains(word)),
        "{}",
        ended.stderr
    );
    assert_eq!(read(folder, "foreign/report.html"), "my own");
}

#[test]
fn the_table_counts_what_the_flights_say() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let args = ["--policies", "arc,none", "--speeds", "8,12", "--seeds", "2..5", "--json"];
    let printed = well(campaign(folder, "a", &args)).stdout;
    let [results, csv, json, page] = files(folder, "a");
    assert_eq!(printed, json);
    let rows = serde_json::from_str::<Value>(&json).unwrap()["rows"].as_array().unwrap().clone();
    let keys: Vec<(&str, f64)> = rows
        .iter()
        .map(|row| (row["policy"].as_str().unwrap(), row["speed_m_s"].as_f64().unwrap()))
        .collect();
    assert_eq!(keys, [("none", 8.0), ("none", 12.0), ("arc", 8.0), ("arc", 12.0)]);
    assert_eq!(csv.lines().count(), 5);
    // A column for what differs between rows; the rest is stated once.
    assert!(page.contains("<h2>12 flights</h2>") && page.contains("sensor depth, danger nearness"), "{page}");
    let rows_shown = ["none", "arc"].map(|policy| page.matches(&format!(">{policy}</td>")).count());
    assert_eq!(rows_shown, [2, 2], "{page}");
    assert!(!page.contains(">depth</td>"), "{page}");
    let flights: Vec<Value> =
        results.lines().skip(1).map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(flights.len(), 12);
    for row in &rows {
        let of_row = flights.iter().filter(|flight| {
            ["world", "policy", "speed_m_s", "sensor", "size", "faults"]
                .iter()
                .all(|key| flight[key] == row[key])
        });
        let count = |outcome: &str| of_row.clone().filter(|f| f["flown"]["outcome"] == outcome).count();
        assert_eq!((&row["flights"], of_row.clone().count()), (&Value::from(3), 3), "{row}");
        for (field, outcome) in [
            ("reached", "reached"),
            ("crashed", "crashed"),
            ("left_band", "left-band"),
            ("timed_out", "timed-out"),
        ] {
            assert_eq!(row[field], count(outcome), "{row}");
        }
        assert_eq!(row["success"].as_f64().unwrap(), count("reached") as f64 / 3.0);
    }
    // The wall is straight ahead unless it is offset.
    assert!(rows[2]["reached"].as_u64().unwrap() > rows[0]["reached"].as_u64().unwrap(), "{json}");
}

#[test]
fn settings_are_compared_on_the_same_seeds() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    well(campaign(folder, "a", &["--policies", "arc,none", "--seeds", "0..4"]));
    well(campaign(folder, "b", &["--seeds", "1..5", "--steer", "radius_m=1.5,memory_s=2"]));
    let compare = |args: &[&str]| program(folder, &[&["campaign", "compare"], args].concat());
    let rows = |args: &[&str]| {
        let rows = serde_json::from_str::<Value>(&well(compare(args)).stdout).unwrap();
        rows.as_array().unwrap().clone()
    };
    let of = rows(&["a", "--first", "policy=none", "--second", "policy=arc", "--json"]);
    assert_eq!(of.len(), 1);
    let table: Value = serde_json::from_str(&read(folder, "a/table.json")).unwrap();
    let reached = |row: usize| table["rows"][row]["reached"].as_u64().unwrap();
    assert_eq!(
        (&of[0]["pairs"], &of[0]["reached"]),
        (&Value::from(4), &Value::from([reached(0), reached(1)]))
    );
    let of = rows(&["a", "b", "--json"]);
    assert_eq!((of.len(), &of[0]["pairs"]), (1, &Value::from(3)));
    let text = well(compare(&["a", "b"])).stdout;
    assert!(text.starts_with("setting") && text.contains("only second"), "{text}");
    for (args, words) in [
        (vec!["a"], "SECOND is missing"),
        (vec!["a", "none"], "none/results.jsonl"),
        (
            vec!["a", "b", "--first", "policy=arc", "--second", "policy=balance"],
            "results is 8 and 4, expected at least one",
        ),
        (vec!["a", "--first", "colour=red"], "NAME=VALUE with one of world, sensor"),
    ] {
        let ended = compare(&args);
        assert!(ended.code == Some(2) && ended.stderr.contains(words), "{args:?}: {}", ended.stderr);
    }
}

#[test]
fn a_campaign_goes_on_where_it_was_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    well(campaign(folder, "whole", &["--seeds", "0..4"]));
    let whole = files(folder, "whole");
    well(campaign(folder, "cut", &["--seeds", "0..3"]));
    let path = folder.join("cut/results.jsonl");
    let text = fs::read_to_string(&path).unwrap();
    fs::write(&path, &text[..text.len() - 10]).unwrap();
    let ended = well(campaign(folder, "cut", &["--seeds", "0..4"]));
    assert!(ended.stderr.contains("incomplete last line"), "{}", ended.stderr);
    assert!(ended.stderr.contains("4 flights, 2 already done"), "{}", ended.stderr);
    assert_eq!(files(folder, "cut"), whole);
    let again = well(campaign(folder, "cut", &["--seeds", "0..4"]));
    assert!(again.stderr.contains("4 flights, 4 already done"), "{}", again.stderr);
    assert_eq!(files(folder, "cut"), whole);
    // Results with another wind do not belong to the campaign; neither file may change.
    let ended = campaign(folder, "cut", &["--seeds", "0..4", "--wind", "1,0,0"]);
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""));
    assert!(
        ended.stderr.contains("configuration") && ended.stderr.contains("wind 1,0,0"),
        "{}",
        ended.stderr
    );
    assert_eq!(files(folder, "cut"), whole);
}

#[test]
fn what_does_not_belong_together_is_not_merged() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    well(campaign(folder, "a", &["--seeds", "0..2"]));
    well(campaign(folder, "wind", &["--seeds", "2..4", "--wind", "1,0,0"]));
    fs::create_dir(folder.join("changed")).unwrap();
    let changed = read(folder, "a/results.jsonl").replacen("\"path_m\":", "\"path_m\":1", 1);
    fs::write(folder.join("changed/results.jsonl"), changed).unwrap();
    for (other, words) in [
        ("wind", "wind/results.jsonl: configuration"),
        ("changed", "changed/results.jsonl: result is that of wall:"),
        ("missing", "missing/results.jsonl"),
    ] {
        let ended = program(folder, &["campaign", "merge", "a", other, "-o", "merged"]);
        assert_eq!((ended.code, ended.stderr.lines().count()), (Some(2), 1), "{}", ended.stderr);
        assert!(ended.stderr.contains(words), "{}", ended.stderr);
        assert!(!folder.join("merged").exists());
    }
    let ended = program(folder, &["campaign", "merge", "a", "-o", "a"]);
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
}

#[test]
fn a_flight_that_failed_is_an_error_until_it_was_flown() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    well(campaign(folder, "whole", &["--seeds", "0..2"]));
    well(campaign(folder, "a", &["--seeds", "0..1"]));
    let path = folder.join("a/results.jsonl");
    let text = fs::read_to_string(&path).unwrap();
    let flown = text.lines().last().unwrap().replacen("\"seed\":0", "\"seed\":1", 1);
    let (job, _) = flown.split_once("\"flown\"").unwrap();
    fs::write(&path, format!("{text}{job}\"error\":\"out of memory\"}}\n")).unwrap();
    let ended = campaign(folder, "a", &["--seeds", "0..1"]);
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    let error = ended.stderr.lines().last().unwrap();
    assert!(
        error.contains("failed is 1, expected none; the first is ") && error.ends_with("/1: out of memory"),
        "{error}"
    );
    // The table is printed nevertheless, and counts the failure separately.
    assert!(!ended.stdout.is_empty());
    let table: Value = serde_json::from_str(&read(folder, "a/table.json")).unwrap();
    assert_eq!((&table["rows"][0]["flights"], &table["rows"][0]["failed"]), (&1.into(), &1.into()));
    well(campaign(folder, "a", &["--seeds", "0..2"]));
    assert_eq!(files(folder, "a"), files(folder, "whole"));
}

#[test]
fn pictures_are_flown_by_too() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let args = [
        "campaign",
        "--worlds",
        WALL,
        "--sizes",
        "240x180",
        "--body",
        "turn",
        "--backend",
        "cpu",
        "--seeds",
        "1",
    ];
    let faults = ["--faults", "none,black:1..1.5+gyro-lost:2..2.1", "-o", "a"];
    well(program(folder, &[&args[..], &faults].concat()));
    let lines: Vec<Value> = (read(folder, "a/results.jsonl").lines().skip(1))
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(lines.len(), 2);
    assert!(lines.iter().all(|line| line["adapter"] == "cpu" && line["flown"].is_object()));
    let invalid = |faults: &str| {
        let line = lines.iter().find(|line| line["faults"] == faults).unwrap();
        line["flown"]["invalid"].as_f64().unwrap()
    };
    assert!(invalid("black:1..1.5+gyro-lost:2..2.1") > invalid("none"), "{lines:?}");
}

#[test]
fn what_cannot_be_flown_is_an_error_of_one_line_and_leaves_nothing() {
    let campaign = |args: &[&str], words: &[&str]| {
        refused(&[&["campaign", "--worlds", WALL], &CHEAP[..], args].concat(), words);
    };
    refused(&["campaign", "--worlds", "wall,moon"], &["moon", "wall"]);
    refused(&["campaign", "--worlds", "wall:width=900"], &["width", "900"]);
    campaign(&["--policies", "arc,bee"], &["bee", "balance"]);
    campaign(&["--seeds", "5..5"], &["seeds", "5..5", "LAST above FIRST"]);
    campaign(&["--seeds", "-1..3"], &["seeds", "-1..3"]);
    campaign(&["--seeds", "0..99999999999999999999"], &["seeds", "each from 0 to 18446744073709551615"]);
    campaign(&["--seeds", "x"], &["seeds", "x"]);
    campaign(&["--seeds", "0..99999999999"], &["number of flights"]);
    campaign(&["--speeds", "12,-1"], &["--speeds is -1, expected 0.1 to 1000 m/s"]);
    refused(&["campaign", "--sensors", "depth", "--speeds", "12,500"], &["--speeds is 500", "level"]);
    campaign(&["--wind", "1e9,0,0"], &["wind", "1e9,0,0", "within ±100 m/s"]);
    campaign(&["--latencies", "1,31"], &["--latencies", "\"31\"", "a whole number from 0 to 30"]);
    campaign(&["--latencies", "-1"], &["--latencies", "\"-1\"", "a whole number from 0 to 30"]);
    campaign(&["--sizes", "96x72,1x1"], &["--sizes is 1×1, expected at least 2×2"]);
    campaign(&["--faults", "none,black"], &["black:0 with the sensor depth"]);
    campaign(&["--faults", "gyro-bias=5"], &["gyro-bias=5:0 with the sensor depth"]);
    campaign(&["--shard", "0/3"], &["shard", "0/3"]);
    campaign(&["--jobs", "0"], &["--jobs", "\"0\"", "a whole number from 1 to 4096"]);
    campaign(&["--jobs", "-1"], &["--jobs", "\"-1\"", "from 1 to 4096; see viewsphere campaign --help"]);
    campaign(&["--adapter", "x", "--backend", "cpu"], &["--adapter", "--backend cpu"]);
    campaign(&["--jobs", "100000"], &["--jobs", "100000"]);
    refused(&["campaign", "merge", "-o", "a"], &["FOLDER", "see viewsphere campaign merge --help"]);
    refused(&["campaign", "merge", "nowhere", "-o", "a"], &["nowhere"]);
}
