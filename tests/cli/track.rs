//! `viewsphere track` as its users run it.

use std::fs;
use std::path::Path;

use tempfile::TempDir;
use viewsphere::frame::{Image, PixelFormat, Size};
use viewsphere::io::{picture, points};

use crate::need;
use crate::program::{Ended, program};

const SIZE: Size = Size::new(96, 72);

/// A folder of four frames of a texture that moves by (2, -1) px from each to the next, and of files with mistakes.
fn files() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for number in 0..4 {
        let pixel = |i: u32| {
            let x = f64::from(i % SIZE.width) - 2.0 * f64::from(number);
            let y = f64::from(i / SIZE.width) + f64::from(number);
            let waves = [(0.31, 0.12), (-0.17, 0.43), (0.52, -0.36), (0.07, 0.21), (-0.62, -0.28)];
            let sum: f64 = waves.iter().map(|(a, b)| (a * x + b * y).sin()).sum();
            (128.0 + 22.0 * sum).round() as u8
        };
        let data = (0..SIZE.pixels() as u32).map(pixel).collect();
        let image = Image { size: SIZE, format: PixelFormat::Gray8, data };
        picture::write_png(folder.path().join(format!("{number}.png")), &image).unwrap();
    }
    for (name, text) in [
        ("points.csv", "x,y\n40,30\n50.5,36.25\n"),
        ("outside.csv", "40,30\n96,3\n"),
        ("nan.csv", "40,NaN\n"),
        ("none.csv", "x,y\n"),
        ("three.csv", "x,y\n40,30\n50,36,9\n"),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

fn track(folder: &TempDir, args: &[&str]) -> Ended {
    program(folder.path(), &[&["track"], args].concat())
}

#[track_caller]
fn well(folder: &TempDir, args: &[&str]) -> String {
    let ended = track(folder, args);
    assert_eq!(ended.code, Some(0), "{args:?}: {}", ended.stderr);
    ended.stdout
}

#[track_caller]
fn refused(folder: &TempDir, args: &[&str], words: &[&str]) {
    let names = |folder: &Path| fs::read_dir(folder).unwrap().count();
    let before = names(folder.path());
    let ended = track(folder, args);
    assert_eq!(ended.code, Some(2), "{args:?}: {}", ended.stderr);
    assert!(ended.stdout.is_empty(), "{args:?}: {}", ended.stdout);
    let lines: Vec<&str> = ended.stderr.lines().filter(|line| !line.contains("computing on")).collect();
    assert_eq!(lines.len(), 1, "{args:?}: {}", ended.stderr);
    assert!(words.iter().all(|word| lines[0].contains(word)), "{args:?}: {words:?} in {}", lines[0]);
    assert_eq!(names(folder.path()), before, "{args:?}");
}

/// Frame, track, x, y and status of each line.
fn rows(csv: &str) -> Vec<(u32, u32, f64, f64, String)> {
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some("frame,track,x,y,status,fb_error_px,error"));
    let row = |line: &str| {
        let columns: Vec<&str> = line.split(',').collect();
        assert_eq!(columns.len(), 7, "{line}");
        let [x, y] = [2, 3].map(|i| columns[i].parse().unwrap());
        (columns[0].parse().unwrap(), columns[1].parse().unwrap(), x, y, columns[4].to_owned())
    };
    lines.map(row).collect()
}

#[test]
fn a_csv_of_tracks_and_a_summary() {
    let folder = files();
    let text = well(&folder, &["%d.png", "-o", "t.csv", "--forward-backward", "0.5", "--backend", "cpu"]);
    assert!(text.starts_with("4 frames of 96×72 on cpu\ntracks "), "{text}");
    let csv = fs::read_to_string(folder.path().join("t.csv")).unwrap();
    let rows = rows(&csv);
    let begun: Vec<_> = rows.iter().filter(|(.., status)| status == "new").collect();
    assert!(begun.len() > 20);
    let mut compared = 0;
    for (_, track, x, y, _) in begun
        .iter()
        .filter(|(frame, _, x, y, _)| *frame == 0 && (20.0..70.0).contains(x) && (20.0..52.0).contains(y))
    {
        let last = rows.iter().find(|(frame, id, ..)| *frame == 3 && id == track).expect("it stays inside");
        assert!((last.2 - x - 6.0).hypot(last.3 - y + 3.0) < 0.05, "{last:?}");
        compared += 1;
    }
    assert!(compared > 5, "{compared}");
    let again = well(&folder, &["%d.png", "-o", "-", "--forward-backward", "0.5", "--backend", "cpu"]);
    assert_eq!(again, csv, "the same bytes on two runs, in a file and on standard output");
    if need::gpu_if_any().is_some() {
        let gpu = ["%d.png", "-o", "-", "--forward-backward", "0.5", "--backend", "gpu"];
        assert_eq!(well(&folder, &gpu).lines().count(), csv.lines().count());
    }
}

#[test]
fn given_points_overlays_and_json() {
    let folder = files();
    let args = ["0.png", "1.png", "--points", "points.csv", "--backend", "cpu"];
    let csv = well(&folder, &[&args[..], &["-o", "-"]].concat());
    let rows = rows(&csv);
    assert_eq!(rows.len(), 4);
    assert_eq!((rows[1].2, rows[1].3), (50.5, 36.25));
    assert!((rows[3].2 - 52.5).hypot(rows[3].3 - 35.25) < 0.02, "{csv}");
    let json = well(&folder, &[&args[..], &["--json", "--overlay", "over", "--harris"]].concat());
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!((&json["frames"], &json["tracks"], &json["live"]), (&2.into(), &2.into(), &2.into()));
    assert_eq!(json["median_fb_error_px"], serde_json::Value::Null);
    let image = picture::read(folder.path().join("over/000001.png")).unwrap();
    assert_eq!((image.size, image.format), (SIZE, PixelFormat::Rgb8));
    well(&folder, &["%d.png", "--overlay", "o.y4m", "--backend", "cpu", "--max-corners", "9"]);
    let video = fs::read(folder.path().join("o.y4m")).unwrap();
    assert!(video.starts_with(b"YUV4MPEG2 W96 H72 F30:1"));
    let frames = video.windows(6).filter(|bytes| bytes == b"FRAME\n").count();
    assert_eq!(frames, 4);
    // The points of a result can be tracked again.
    assert_eq!(points::read(folder.path().join("points.csv")).unwrap().len(), 2);
}

#[test]
fn bad_input_is_one_line() {
    let folder = files();
    let pair = ["0.png", "1.png", "--backend", "cpu"];
    for (args, words) in [
        (&["no-%d.png"][..], &["no-%d.png", "number of matching files is 0"][..]),
        (&["0.png"], &["0.png", "number of frames is 1, expected at least 2"]),
        (&["0.png", "no.png", "-o", "t.csv"], &["no.png"]),
        (
            &["0.png", "1.png", "--points", "outside.csv"],
            &["outside.csv: a point is 96,3 in line 2", "inside the 96×72 of 0.png"],
        ),
        (&["0.png", "1.png", "--points", "nan.csv"], &["nan.csv", "line 1", "finite"]),
        (&["0.png", "1.png", "--points", "three.csv"], &["three.csv", "\"50,36,9\" in line 3", "no more"]),
        (&["0.png", "1.png", "--points", "none.csv"], &["none.csv", "number of points is 0"]),
        (&["0.png", "1.png", "--points", "missing.csv"], &["missing.csv"]),
    ] {
        refused(&folder, args, words);
    }
    for (args, words) in [
        (&["--window", "97x20"][..], &["--window is 97×20", "96×72"][..]),
        (&["--window", "2"], &["--window is 2×2"]),
        (&["--window", "big"], &["window is \"big\""]),
        (&["--epsilon", "NaN"], &["--epsilon is NaN"]),
        (&["--epsilon", "-1"], &["--epsilon is -1"]),
        (&["--iterations", "0"], &["--iterations is 0"]),
        (&["--levels", "99"], &["--levels is 99"]),
        (&["--min-eigenvalue", "NaN"], &["--min-eigenvalue is NaN"]),
        (&["--quality-level", "NaN"], &["--quality-level is NaN"]),
        (&["--min-distance", "-3"], &["--min-distance is -3"]),
        (&["--block-size", "0"], &["--block-size is 0"]),
        (&["--harris", "--k", "NaN"], &["--k is NaN"]),
        (&["--k", "0.1"], &["--harris"]),
        (&["--max-corners", "0"], &["\"0\"", "1 to 65535"]),
        (&["--forward-backward", "NaN"], &["--forward-backward is NaN"]),
        (
            &["--points", "points.csv", "--max-corners", "1"],
            &["points.csv: number of points is 2, expected at most --max-corners, 1"],
        ),
        (
            &["--max-corners", "5", "--min-tracks", "6"],
            &["--min-tracks is 6, expected at most --max-corners, 5"],
        ),
        (&["-o", "t.txt"], &["t.txt", ".csv"]),
        (&["-o", "missing/t.csv"], &["missing"]),
        (&["-o", "-", "--json"], &["--json"]),
        (&["--overlay", "-"], &["--overlay"]),
        (&["--overlay", "0.png"], &["0.png: extension is .png, expected .y4m or a folder"]),
        (&["--overlay", "o.mp4"], &["o.mp4: extension is .mp4", "ffmpeg -i o.y4m o.mp4"]),
        (
            &["-o", "t.csv", "--overlay", "t.csv/"],
            &["--overlay is t.csv/, expected a path other than that of -o"],
        ),
        (
            &["-o", "t.csv", "--overlay", "t.csv/a"],
            &["--overlay is t.csv/a, expected a path other than that of -o"],
        ),
        (&["--points", "points.csv", "-o", "points.csv"], &["-o", "points.csv"]),
    ] {
        refused(&folder, &[&pair[..], args].concat(), words);
    }
}
