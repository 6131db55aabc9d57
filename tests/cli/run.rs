//! `viewsphere run` as its users run it.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;
use tempfile::TempDir;
use viewsphere::camera::{Camera, Lens};
use viewsphere::eval::Scene;
use viewsphere::frame::{Image, PixelFormat, Size};
use viewsphere::io::camera::{self, Format};
use viewsphere::io::{Y4mReader, Y4mWriter, picture};

use crate::feed::feed;
use crate::need::{self, Without};

const SIZE: Size = Size::new(96, 72);
const FRAMES: u32 = 8;

/// The result of a run.
struct Ended {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

impl Ended {
    #[track_caller]
    fn well(self) -> Self {
        assert_eq!(self.code, Some(0), "{}", self.stderr);
        self
    }

    /// The lines of JSON, without what differs between runs.
    #[track_caller]
    fn lines(&self) -> Vec<Value> {
        let line = |line: &str| {
            let mut value: Value = serde_json::from_str(line).unwrap();
            assert!(value["timing"]["latency_ms"].as_f64().unwrap() > 0.0, "{line}");
            value.as_object_mut().unwrap().remove("timing");
            value
        };
        self.stdout.lines().map(line).collect()
    }

    /// The frames that were invalid, and the kind of the reason.
    fn invalid(&self) -> Vec<(u64, String)> {
        let of = |line: &Value| {
            let number = line["frame"].as_u64().unwrap();
            assert_eq!(line["valid"].as_bool(), Some(line["invalid_kind"].is_null()));
            line["invalid_kind"].as_str().map(|kind| (number, kind.to_owned()))
        };
        self.lines().iter().filter_map(of).collect()
    }
}

fn run_with(folder: &Path, args: &[&str], stdin: &[u8]) -> Ended {
    let mut command = Command::new(env!("CARGO_BIN_EXE_viewsphere"));
    command.args(["run", "--backend", "cpu"]).args(args).current_dir(folder);
    let output = feed(&mut command, stdin);
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    Ended { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
}

fn run(folder: &TempDir, args: &[&str]) -> Ended {
    run_with(folder.path(), args, b"")
}

#[track_caller]
fn refused(folder: &TempDir, args: &[&str], words: &[&str]) {
    let ended = run(folder, args);
    assert_eq!(ended.code, Some(2), "{args:?}: {}", ended.stderr);
    assert!(ended.stdout.is_empty(), "{args:?}: {}", ended.stdout);
    assert_eq!(ended.stderr.lines().count(), 1, "{args:?}: {}", ended.stderr);
    assert!(words.iter().all(|word| ended.stderr.contains(word)), "{args:?}: {words:?} in {}", ended.stderr);
}

fn video(frames: impl Iterator<Item = Image>) -> Vec<u8> {
    let mut video = Y4mWriter::new(Vec::new(), "a.y4m", SIZE, PixelFormat::Gray8, (30, 1)).unwrap();
    frames.for_each(|frame| video.write_frame(&frame.frame().unwrap()).unwrap());
    video.finish().unwrap()
}

/// A folder with an approaching, rotating scene: images, a video, raw bytes.
fn flight() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let scene = Scene::new(SIZE).unwrap();
    let frames: Vec<Image> = (0..FRAMES).map(|number| scene.frame(number)).collect();
    for (number, frame) in frames.iter().enumerate() {
        picture::write_png(folder.path().join(format!("{number:02}.png")), frame).unwrap();
    }
    fs::write(folder.path().join("raw"), frames.iter().flat_map(|f| f.data.clone()).collect::<Vec<_>>())
        .unwrap();
    fs::write(folder.path().join("a.y4m"), video(frames.into_iter())).unwrap();
    folder
}

fn write(folder: &TempDir, name: &str, text: &str) {
    fs::write(folder.path().join(name), text).unwrap();
}

#[test]
fn pictures_videos_and_streams_give_the_same_lines() {
    let folder = flight();
    let end = ["--fov-deg", "90", "--json-lines", "--sector-detail", "--sectors", "8x6"];
    let args = |input: &[&'static str]| [input, &end[..]].concat();
    let lines = run(&folder, &args(&["a.y4m"])).well().lines();
    assert_eq!(lines.len(), FRAMES as usize);
    for (number, line) in lines.iter().enumerate() {
        assert_eq!(line["frame"], number);
        assert!((line["time_s"].as_f64().unwrap() - number as f64 / 30.0).abs() < 1e-8, "{line}");
        assert_eq!(line["valid"], number > 0, "{line}");
        for list in ["ttc_s", "ttc_early_s", "ttc_late_s", "coverage", "confidence", "nearness_rate_hz"] {
            assert_eq!(line["sectors"][list].as_array().unwrap().len(), 48, "{list}");
        }
    }
    assert_eq!(lines[0]["invalid"], "no previous frame");
    assert!(lines[0]["sectors"]["ttc_s"].as_array().unwrap().iter().all(Value::is_null));
    assert!(lines[3]["sectors"]["ttc_s"].as_array().unwrap().iter().any(Value::is_f64), "{}", lines[3]);
    let [left, top] =
        ["azimuth_deg", "elevation_deg"].map(|name| lines[3]["sectors"][name][0].as_f64().unwrap());
    assert!((left + 45.0).abs() < 0.01 && (top - 36.87).abs() < 0.01, "{left} {top}");
    let raw = fs::read(folder.path().join("raw")).unwrap();
    let y4m = fs::read(folder.path().join("a.y4m")).unwrap();
    write(&folder, "t.csv", &(0..FRAMES).map(|n| format!("{}\n", f64::from(n) / 30.0)).collect::<String>());
    assert_eq!(run(&folder, &args(&["%02d.png"])).well().lines(), lines);
    assert_eq!(run(&folder, &args(&["*.png", "--times", "t.csv"])).well().lines(), lines);
    assert_eq!(run_with(folder.path(), &args(&["-"]), &y4m).well().lines(), lines);
    assert_eq!(run_with(folder.path(), &args(&["-", "--raw", "96x72"]), &raw).well().lines(), lines);
    let slow = run(&folder, &args(&["a.y4m", "--fps", "10", "--start-s", "-5"])).well().lines();
    assert_eq!((&slow[2]["time_s"], &slow[2]["valid"]), (&Value::from(-4.8), &Value::from(true)));
}

#[test]
fn what_ffmpeg_pipes_is_the_same() {
    let folder = flight();
    let args = ["-loglevel", "error", "-i", "a.y4m", "-f", "yuv4mpegpipe", "-strict", "-1", "-"];
    let output = Command::new("ffmpeg").args(args).current_dir(folder.path()).output();
    let Some(output) = need::found("ffmpeg", output, Without::Nothing) else { return };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let lines = run(&folder, &["a.y4m", "--fov-deg", "90", "--json-lines"]).well().lines();
    let piped = run_with(folder.path(), &["-", "--fov-deg", "90", "--json-lines"], &output.stdout).well();
    assert_eq!(piped.lines(), lines);
}

/// A gyro's log at 200 Hz over the flight, each sample as `line` writes it.
fn gyro_log(line: impl Fn(usize) -> Option<String>) -> String {
    let samples: String = (0..60).filter_map(|i| line(i).map(|line| line + "\n")).collect();
    format!("time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s\n{samples}")
}

fn still(i: usize) -> String {
    format!("{},0.01,0,0", i as f64 * 0.005 - 0.01)
}

#[test]
fn a_gyro_spoils_the_frames_that_it_does_not_cover_and_no_others() {
    let folder = flight();
    let first = (0, "first".to_owned());
    let cases: [(&str, String, &[u64], &str); 6] = [
        ("whole", gyro_log(|i| Some(still(i))), &[], ""),
        // Frames 2 and 3 are at 0.0667 and 0.1 s, sample 22 at 0.1 s.
        ("gap", gyro_log(|i| (!(17..=21).contains(&i)).then(|| still(i))), &[], ""),
        (
            "hole",
            gyro_log(|i| (!(10..=21).contains(&i)).then(|| still(i))),
            &[2, 3],
            "no gyro sample between",
        ),
        (
            "nan",
            gyro_log(|i| Some(if i == 19 { "0.085,nan,0,0".to_owned() } else { still(i) })),
            &[3],
            "finite",
        ),
        (
            "back",
            gyro_log(|i| Some(if i == 19 { "0.01,0,0,0".to_owned() } else { still(i) })),
            &[3],
            "times must rise",
        ),
        ("short", gyro_log(|i| (i < 30).then(|| still(i))), &[5, 6, 7], "not covered"),
    ];
    for (name, log, spoilt, reason) in cases {
        write(&folder, "gyro.csv", &log);
        let args =
            ["a.y4m", "--fov-deg", "90", "--json-lines", "--gyro", "gyro.csv", "--gyro-bias", "0.01,0,0"];
        let ended = run(&folder, &args).well();
        let spoilt: Vec<_> = spoilt.iter().map(|number| (*number, "gyro".to_owned())).collect();
        assert_eq!(
            ended.invalid(),
            [std::slice::from_ref(&first), &spoilt[..]].concat(),
            "{name}: {}",
            ended.stdout
        );
        let lines = ended.lines();
        for (number, _) in &spoilt {
            let line = &lines[*number as usize];
            assert!(line["invalid"].as_str().unwrap().contains(reason), "{name}: {line}");
            assert!(line["threat"].is_null(), "{name}: {line}");
            assert!(line["sectors"]["ttc_s"].as_array().unwrap().iter().all(Value::is_null), "{name}");
        }
        assert!(ended.stderr.contains("1 first"), "{name}: {}", ended.stderr);
    }
    // A camera whose clock started at another time.
    write(&folder, "gyro.csv", &gyro_log(|i| Some(still(i))));
    let args = ["a.y4m", "--fov-deg", "90", "--json-lines", "--gyro", "gyro.csv", "--start-s", "100"];
    assert_eq!(run(&folder, &args).well().invalid().len(), FRAMES as usize);
    let shifted = [&args[..], &["--gyro-offset-s", "100"]].concat();
    assert_eq!(run(&folder, &shifted).well().invalid(), [first]);
}

#[test]
fn the_turn_is_taken_out_in_every_way() {
    let folder = flight();
    write(&folder, "gyro.csv", &gyro_log(|i| Some(still(i))));
    for more in [&["--derotation", "after"][..], &["--derotation", "primed", "--camera-from-gyro", "frd"]] {
        let args = [&["a.y4m", "--fov-deg", "90", "--json-lines", "--gyro", "gyro.csv"][..], more].concat();
        assert_eq!(run(&folder, &args).well().invalid().len(), 1, "{more:?}");
    }
}

#[test]
fn a_camera_file_and_a_mask_are_used_and_must_fit() {
    let folder = flight();
    let lens = Lens::new(&[-0.2, 0.03, 0.0, 0.0]).unwrap();
    let good = Camera { size: SIZE, f_u: 60.0, f_v: 60.0, u_0: 47.5, v_0: 35.5, lens };
    camera::write(folder.path().join("cam.yaml"), &good, Format::OpenCv).unwrap();
    let small = Camera { size: Size::new(48, 36), u_0: 23.5, v_0: 17.5, ..good };
    camera::write(folder.path().join("small.yaml"), &small, Format::Kalibr).unwrap();
    let mut mask = Image { size: SIZE, format: PixelFormat::Gray8, data: vec![255; SIZE.pixels()] };
    mask.data[36 * 96..].fill(0);
    picture::write_png(folder.path().join("mask.png"), &mask).unwrap();
    let args = ["a.y4m", "--camera", "cam.yaml", "--json-lines", "--mask", "mask.png", "--sectors", "4x4"];
    let lines = run(&folder, &args).well().lines();
    let coverage: Vec<f64> =
        lines[4]["sectors"]["coverage"].as_array().unwrap().iter().map(|c| c.as_f64().unwrap()).collect();
    assert!(
        coverage[5] >= 0.8 && coverage[6] >= 0.8 && coverage[12..].iter().all(|c| *c == 0.0),
        "{coverage:?}"
    );
    for (args, words) in [
        (&["a.y4m", "--camera", "small.yaml"][..], &["a.y4m", "96×72", "48×36 as in small.yaml"][..]),
        (&["a.y4m", "--camera", "mask.png"], &["mask.png"]),
        (&["a.y4m", "--camera", "cam.yaml", "--mask", "none.png"], &["none.png"]),
    ] {
        refused(&folder, args, words);
    }
}

#[test]
fn no_input_is_overwritten() {
    let folder = flight();
    let before = fs::read(folder.path().join("a.y4m")).unwrap();
    for overlay in ["a.y4m", "./a.y4m"] {
        let args = ["a.y4m", "--fov-deg", "90", "--quiet", "--overlay", overlay];
        refused(&folder, &args, &["--overlay is", "a.y4m, expected a path other than"]);
    }
    assert_eq!(fs::read(folder.path().join("a.y4m")).unwrap(), before);
}

#[test]
fn a_video_that_is_cut_off_is_processed_to_its_last_whole_frame() {
    let folder = flight();
    let bytes = fs::read(folder.path().join("a.y4m")).unwrap();
    fs::write(folder.path().join("cut.y4m"), &bytes[..bytes.len() - 100]).unwrap();
    for realtime in [&[][..], &["--realtime"]] {
        let args = [&["cut.y4m", "--fov-deg", "90", "--json-lines"][..], realtime].concat();
        let ended = run(&folder, &args);
        assert_eq!(ended.code, Some(2), "{}", ended.stderr);
        assert_eq!(ended.lines().last().unwrap()["frame"], FRAMES - 2, "{}", ended.stderr);
        let last = ended.stderr.lines().last().unwrap();
        assert!(last.contains("cut.y4m: video is cut off after 7 whole frames"), "{}", ended.stderr);
    }
}

#[test]
fn an_overload_drops_frames_and_counts_them() {
    let folder = flight();
    let scene = Scene::new(SIZE).unwrap();
    let frames: Vec<Image> = (0..FRAMES).map(|number| scene.frame(number)).collect();
    let bytes = video((0..200).map(|i| frames[i % frames.len()].clone()));
    fs::write(folder.path().join("long.y4m"), &bytes).unwrap();
    let args = ["--fov-deg", "90", "--preset", "accurate", "--realtime"];
    let file = [&["long.y4m", "--fps", "20000", "--json"][..], &args].concat();
    let stream = [&["-", "--json"][..], &args].concat();
    for ended in [run(&folder, &file), run_with(folder.path(), &stream, &bytes)] {
        let summary: Value = serde_json::from_str(&ended.well().stdout).unwrap();
        let [frames, dropped] = ["frames", "dropped"].map(|name| summary[name].as_u64().unwrap());
        assert!(dropped > 0 && frames >= 2 && frames + dropped == 200, "{summary}");
    }
    // At a low frame rate nothing is dropped, as there is time for each frame.
    let slow = ["a.y4m", "--fps", "4", "--fov-deg", "90", "--realtime", "--json", "--preset", "fast"];
    let summary: Value = serde_json::from_str(&run(&folder, &slow).well().stdout).unwrap();
    assert_eq!((&summary["frames"], &summary["dropped"]), (&FRAMES.into(), &0.into()), "{summary}");
}

#[test]
fn an_overlay_shows_every_frame_and_is_whole_or_not_there() {
    let folder = flight();
    let bytes = fs::read(folder.path().join("a.y4m")).unwrap();
    fs::write(folder.path().join("cut.y4m"), &bytes[..bytes.len() - 100]).unwrap();
    let frames = |name: &str| {
        let bytes = fs::read(folder.path().join(name)).unwrap();
        let mut video = Y4mReader::new(&bytes[..], name).unwrap();
        assert_eq!((video.size(), video.rate()), (SIZE, Some((30, 1))), "{name}");
        let mut image = Image::default();
        while video.next_frame(&mut image).unwrap() {}
        assert!(image.data.iter().max() > image.data.iter().min(), "{name}");
        video.frames_read()
    };
    run(&folder, &["a.y4m", "--fov-deg", "90", "--quiet", "--overlay", "o.y4m"]).well();
    assert_eq!(frames("o.y4m"), u64::from(FRAMES));
    write(&folder, "gyro.csv", &gyro_log(|i| Some(still(i))));
    let args = ["a.y4m", "--fov-deg", "90", "--quiet", "--gyro", "gyro.csv", "--overlay"];
    run(&folder, &[&args[..], &["plain.y4m"]].concat()).well();
    run(&folder, &[&args[..], &["level.y4m", "--level", "-5,10"]].concat()).well();
    let bytes = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert!(frames("level.y4m") == u64::from(FRAMES) && bytes("level.y4m") != bytes("plain.y4m"));
    // The overlay holds the frames processed before the end of a truncated video.
    assert_eq!(run(&folder, &["cut.y4m", "--fov-deg", "90", "--overlay", "c.y4m"]).code, Some(2));
    assert_eq!(frames("c.y4m"), u64::from(FRAMES - 1));
    for (path, words) in [
        ("o.mp4", &["o.mp4", "expected .y4m"][..]),
        ("missing/o.y4m", &["missing"]),
        ("./", &["--overlay", "a folder, expected .y4m"]),
        ("-", &["--overlay is -", "--quiet"]),
    ] {
        refused(&folder, &["a.y4m", "--fov-deg", "90", "--overlay", path], words);
    }
    let names = fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
    assert!(names.into_iter().all(|name| !name.ends_with(".tmp")));
}

#[test]
fn a_summary_is_what_is_left_without_lines() {
    let folder = flight();
    let quiet = run(&folder, &["a.y4m", "--fov-deg", "90", "--quiet"]).well();
    assert!(quiet.stdout.is_empty());
    let words = ["8 frames, 7 valid", "1 first", "0 dropped", "median", "frames/s on CPU"];
    assert!(words.iter().all(|word| quiet.stderr.contains(word)), "{}", quiet.stderr);
    let json = run(&folder, &["a.y4m", "--fov-deg", "90", "--json"]).well();
    let summary: Value = serde_json::from_str(&json.stdout).unwrap();
    assert_eq!((&summary["frames"], &summary["valid"]), (&8.into(), &7.into()));
    assert_eq!((&summary["invalid"]["first"], &summary["invalid"]["gyro"]), (&1.into(), &0.into()));
    assert!(
        summary["latency_p99_ms"].as_f64().unwrap() > 0.0 && summary["frames_per_s"].as_f64().unwrap() > 0.0
    );
    let text = run(&folder, &["a.y4m", "--fov-deg", "90"]).well().stdout;
    assert_eq!(text.lines().count(), FRAMES as usize);
    assert!(text.starts_with("     0      0.000 s  invalid: no previous frame\n"), "{text}");
}

#[test]
fn what_does_not_belong_together_is_refused() {
    let folder = flight();
    write(&folder, "two.csv", "0\n0.1\n");
    write(&folder, "words.csv", "0\nsoon\n");
    write(&folder, "gyro.csv", "hello\n");
    let fov = ["--fov-deg", "90"];
    for (args, words) in [
        (&["a.y4m"][..], &["--camera"][..]),
        (&["a.y4m", "--fov-deg", "180"], &["--fov-deg is 180", "1 to 170"]),
        (&["a.y4m", "--fov-deg", "NaN"], &["--fov-deg is NaN"]),
        (&["none.y4m", fov[0], fov[1]], &["none.y4m"]),
        (&["*.png", fov[0], fov[1], "--times", "two.csv"], &["two.csv", "is 2, expected 8"]),
        (&["*.png", fov[0], fov[1], "--times", "words.csv"], &["words.csv", "\"soon\" in line 2"]),
        (&["a.y4m", fov[0], fov[1], "--gyro", "gyro.csv"], &["gyro.csv", "hello"]),
        (&["a.y4m", fov[0], fov[1], "--gyro-bias", "0,0,0"], &["--gyro"]),
        (&["a.y4m", fov[0], fov[1], "--gyro", "gyro.csv", "--gyro-bias", "0,0"], &["3 numbers"]),
        (
            &["a.y4m", fov[0], fov[1], "--gyro", "gyro.csv", "--camera-from-gyro", "1,0,0,0,1,0,0,0,2"],
            &["--camera-from-gyro is"],
        ),
        (
            &["a.y4m", fov[0], fov[1], "--overlay", "o.y4m", "--gyro", "gyro.csv", "--level", "0,95"],
            &["--level is 95", "-90 to 90 degrees of pitch"],
        ),
        (&["a.y4m", fov[0], fov[1], "--overlay", "o.y4m", "--level", "0,0"], &["--gyro"]),
        (&["a.y4m", fov[0], fov[1], "--sectors", "300x1"], &["--sectors is 300"]),
        (&["a.y4m", fov[0], fov[1], "--within-s", "0"], &["--within-s is 0", "above 0"]),
        (&["a.y4m", fov[0], fov[1], "--fps", "0"], &["0.001 to 1000000"]),
        (&["a.y4m", fov[0], fov[1], "--start-s", "inf"], &["--start-s is inf"]),
        (&["a.y4m", fov[0], fov[1], "--quiet", "--json-lines"], &["--json-lines"]),
    ] {
        refused(&folder, args, words);
    }
    // A mismatch between a video and its list of times shows only at the end.
    let ended = run(&folder, &["a.y4m", fov[0], fov[1], "--times", "two.csv"]);
    assert_eq!((ended.code, ended.stdout.lines().count()), (Some(2), 2));
    assert!(
        ended.stderr.lines().last().unwrap().contains("two.csv: number of frame times is 2"),
        "{}",
        ended.stderr
    );
}
