//! The files that an interrupted program leaves.
#![cfg(unix)]

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// A world for one second of flight.
const YARD: &str = r#"{
  "format": "viewsphere course", "version": 1, "name": "yard", "seed": 5,
  "start_ned_m": [0, 0, -10], "length_m": 12, "altitude_m": [2, 30],
  "surfaces": [{"kind": "ground"}]
}"#;

/// The file names in a folder; empty if it does not exist.
fn names(folder: &Path) -> Vec<String> {
    let entries = folder.read_dir().into_iter().flatten();
    let mut names: Vec<_> =
        entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// Whether a partial video is among them.
fn has_part(names: &[String]) -> bool {
    names.iter().any(|name| name.starts_with(".flight.y4m.") && name.ends_with(".tmp"))
}

/// Starts a flight into folder `a`.
fn fly(folder: &Path, args: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_viewsphere"));
    command.args(["fly", "--sensor", "depth", "--quiet", "-o", "a"]).args(args).current_dir(folder);
    command.stdout(Stdio::null()).spawn().unwrap()
}

/// Starts a long flight, and waits until its video has begun.
fn begun(folder: &Path) -> Child {
    let mut flight = fly(folder, &["--world", "forest:length=1000"]);
    let since = Instant::now();
    while !has_part(&names(&folder.join("a"))) {
        assert!(since.elapsed().as_secs() < 60 && flight.try_wait().unwrap().is_none());
        sleep(Duration::from_millis(5));
    }
    flight
}

/// A short flight into the same folder.
fn next(folder: &Path, more: &[&str]) -> Vec<String> {
    fs::write(folder.join("yard.json"), YARD).unwrap();
    let mut flight = fly(folder, &[&["--world-file", "yard.json"], more].concat());
    assert_eq!(flight.wait().unwrap().code(), Some(0));
    names(&folder.join("a"))
}

#[test]
fn what_a_killed_flight_has_left_goes_with_the_next_one() {
    for more in [&[][..], &["--no-video"]] {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let mut killed = begun(folder);
        // While the first flight runs, its partial video stays.
        assert!(has_part(&next(folder, more)));
        killed.kill().unwrap();
        killed.wait().unwrap();
        let video: &[&str] = if more.is_empty() { &["flight.y4m"] } else { &[] };
        let all = [&["flight.jsonl"], video, &["report.html", "timing.json"]].concat();
        assert_eq!(next(folder, more), all);
    }
}

#[test]
fn a_flight_that_is_stopped_leaves_nothing() {
    for signal in ["-INT", "-TERM"] {
        let folder = tempfile::tempdir().unwrap();
        let mut stopped = begun(folder.path());
        let sent = Command::new("kill").args([signal, &stopped.id().to_string()]).status().unwrap();
        assert!(sent.success());
        assert_eq!(stopped.wait().unwrap().code(), Some(130), "{signal}");
        assert_eq!(names(&folder.path().join("a")), [""; 0], "{signal}");
    }
}

/// Starts to track frames that come through a pipe, and waits until both results have begun.
fn tracking(folder: &Path) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_viewsphere"));
    let args =
        ["track", "-", "--raw", "64x48", "-o", "t.csv", "--overlay", "o.y4m", "--backend", "cpu", "--quiet"];
    command.args(args).current_dir(folder).stdin(Stdio::piped()).stdout(Stdio::null());
    let mut tracking = command.spawn().unwrap();
    // The pipe stays open, so that a third frame is waited for.
    tracking.stdin.as_mut().unwrap().write_all(&[90; 2 * 64 * 48]).unwrap();
    let since = Instant::now();
    while names(folder).len() < 2 {
        assert!(since.elapsed().as_secs() < 60 && tracking.try_wait().unwrap().is_none());
        sleep(Duration::from_millis(5));
    }
    tracking
}

#[test]
fn tracking_that_is_stopped_leaves_nothing() {
    for signal in ["-INT", "-TERM", "-HUP"] {
        let folder = tempfile::tempdir().unwrap();
        let mut stopped = tracking(folder.path());
        let sent = Command::new("kill").args([signal, &stopped.id().to_string()]).status().unwrap();
        assert!(sent.success());
        assert_eq!(stopped.wait().unwrap().code(), Some(130), "{signal}");
        assert_eq!(names(folder.path()), [""; 0], "{signal}");
    }
}

#[test]
fn what_killed_tracking_has_left_goes_with_the_next_one() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mut killed = tracking(folder);
    killed.kill().unwrap();
    killed.wait().unwrap();
    assert!(names(folder).iter().all(|name| name.ends_with(".tmp")), "{:?}", names(folder));
    let mut next = tracking(folder);
    drop(next.stdin.take());
    assert_eq!(next.wait().unwrap().code(), Some(0));
    assert_eq!(names(folder), ["o.y4m", "t.csv"]);
}
