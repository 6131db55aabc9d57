//! The program as its users run it: its files, its output and its exit codes.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;
use tempfile::TempDir;
use viewsphere::eval::Scene;
use viewsphere::frame::{FlowField, Image, PixelFormat, Size};
use viewsphere::io::{Y4mWriter, flo, npy, picture, read_flow};

use crate::feed::feed;
use crate::need::{self, Without};

const SIZE: Size = Size::new(72, 50);

/// The result of a run.
struct Ended {
    code: Option<i32>,
    stdout: Vec<u8>,
    stderr: String,
}

impl Ended {
    fn text(&self) -> String {
        String::from_utf8(self.stdout.clone()).unwrap()
    }

    #[track_caller]
    fn well(self) -> Self {
        assert_eq!(self.code, Some(0), "{}", self.stderr);
        self
    }

    #[track_caller]
    fn json(self) -> Value {
        serde_json::from_slice(&self.well().stdout).unwrap()
    }
}

fn run_with(folder: &Path, args: &[&str], stdin: &[u8], no_driver: bool) -> Ended {
    let mut command = Command::new(env!("CARGO_BIN_EXE_viewsphere"));
    command.args(args).current_dir(folder);
    if no_driver {
        command.env("VK_DRIVER_FILES", "/dev/null").env("VK_ICD_FILENAMES", "/dev/null");
    }
    let output = feed(&mut command, stdin);
    let stderr = String::from_utf8(output.stderr).unwrap();
    Ended { code: output.status.code(), stdout: output.stdout, stderr }
}

fn run(folder: &TempDir, args: &[&str]) -> Ended {
    run_with(folder.path(), args, b"", false)
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// A folder with frames `0.png` to `3.png`.
fn frames() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let scene = Scene::new(SIZE).unwrap();
    for number in 0..4 {
        picture::write_png(folder.path().join(format!("{number}.png")), &scene.frame(number)).unwrap();
    }
    folder
}

fn field(folder: &TempDir, name: &str) -> FlowField {
    read_flow(folder.path().join(name)).unwrap()
}

#[test]
fn two_pictures_give_the_flow_between_them() {
    let folder = frames();
    let args = [
        "flow",
        "0.png",
        "1.png",
        "--backend",
        "cpu",
        "-o",
        "a.flo",
        "--color",
        "c.png",
        "--arrows",
        "r.png",
    ];
    let ended = run(&folder, &args).well();
    assert!(ended.text().starts_with("colour scale: "), "{}", ended.text());
    assert_eq!(ended.stderr, "viewsphere: computing on the CPU\n");
    let (truth, flow) = (Scene::new(SIZE).unwrap().flow(0), field(&folder, "a.flo"));
    let error = viewsphere::eval::flow_error(&truth, &flow, None).unwrap();
    assert!(error.aee_px < 0.3, "{error:?}");
    for name in ["c.png", "r.png"] {
        let image = picture::read(folder.path().join(name)).unwrap();
        assert_eq!((image.size, image.format), (SIZE, PixelFormat::Rgb8), "{name}");
    }
    for name in ["b.npy", "b.png"] {
        run(&folder, &["flow", "0.png", "1.png", "-o", name]).well();
        let other = field(&folder, name);
        let close =
            |(a, b): (&[f32; 2], &[f32; 2])| (a[0] - b[0]).abs() <= 0.01 && (a[1] - b[1]).abs() <= 0.01;
        assert!(flow.data.iter().zip(&other.data).all(close), "{name}");
    }
    let stdout = run(&folder, &["flow", "0.png", "1.png", "-o", "-"]).well().stdout;
    assert_eq!(stdout, fs::read(folder.path().join("a.flo")).unwrap());
}

#[test]
fn an_algorithm_that_needs_a_stream_says_so_for_a_pair() {
    let folder = frames();
    let told = |args: &[&str]| {
        let all = [&["flow", "--backend", "cpu", "--algorithm", "flow-filter"], args].concat();
        run(&folder, &all)
            .well()
            .stderr
            .contains("flow-filter uses earlier pairs of its stream: a pair alone")
    };
    assert!(told(&["0.png", "1.png"]));
    assert!(!told(&["0.png", "1.png", "--quiet"]) && !told(&["%d.png"]));
}

#[test]
fn the_confidence_is_low_where_there_is_nothing_to_see() {
    let folder = frames();
    for number in 0..2 {
        let mut image = Scene::new(SIZE).unwrap().frame(number);
        image.data.chunks_mut(72).for_each(|row| row[..36].fill(128));
        picture::write_png(folder.path().join(format!("half{number}.png")), &image).unwrap();
    }
    let args = ["flow", "half0.png", "half1.png", "--backend", "cpu", "--confidence"];
    assert!(run(&folder, &[&args[..], &["c.npy"]].concat()).well().text().is_empty());
    let plane = npy::read_plane(folder.path().join("c.npy")).unwrap();
    assert_eq!(plane.size, SIZE);
    let at = |x: usize| plane.data[25 * 72 + x];
    assert!(at(8) < 0.1 && at(54) > 0.5 && at(54) <= 1.0, "{} {}", at(8), at(54));
    run(&folder, &[&args[..], &["c.png"]].concat()).well();
    let image = picture::read(folder.path().join("c.png")).unwrap();
    assert_eq!(image.data[25 * 72 + 54], (255.0 * at(54)).round() as u8);
}

#[test]
fn nothing_asked_for_is_a_summary() {
    let folder = frames();
    let before = names(folder.path());
    let text = run(&folder, &["flow", "0.png", "1.png", "--backend", "cpu"]).well().text();
    assert!(
        text.starts_with("1 pair of 72×50 on CPU") && text.contains("mean") && text.contains("ms"),
        "{text}"
    );
    let json = run(&folder, &["flow", "0.png", "1.png", "--backend", "cpu", "--json"]).json();
    assert_eq!((&json["pairs"], &json["width"]), (&1.into(), &72.into()));
    assert!(json["max_flow_px"].as_f64().unwrap() > 0.3 && json["median_ms"].as_f64().unwrap() > 0.0);
    assert_eq!(names(folder.path()), before);
}

#[test]
fn a_video_gives_the_same_bytes_as_its_frames() {
    let folder = frames();
    run(&folder, &["flow", "%d.png", "-o", "pictures/", "--color", "colours", "--backend", "cpu"]).well();
    assert_eq!(names(&folder.path().join("pictures")), ["000000.flo", "000001.flo", "000002.flo"]);
    assert_eq!(names(&folder.path().join("colours")), ["000000.png", "000001.png", "000002.png"]);
    let scene = Scene::new(SIZE).unwrap();
    let mut video = Y4mWriter::new(Vec::new(), "a.y4m", SIZE, PixelFormat::Gray8, (25, 1)).unwrap();
    let mut raw = Vec::new();
    for number in 0..4 {
        video.write_frame(&scene.frame(number).frame().unwrap()).unwrap();
        raw.extend(scene.frame(number).data);
    }
    let video = video.finish().unwrap();
    fs::write(folder.path().join("a.y4m"), &video).unwrap();
    run(&folder, &["flow", "a.y4m", "-o", "file"]).well();
    run_with(folder.path(), &["flow", "-", "-o", "stream"], &video, false).well();
    run_with(folder.path(), &["flow", "-", "--raw", "72x50", "-o", "raw"], &raw, false).well();
    run(&folder, &["flow", "1.png", "2.png", "-o", "pair.flo"]).well();
    for number in 0..3 {
        let read = |of: &str| fs::read(folder.path().join(of).join(format!("{number:06}.flo"))).unwrap();
        for of in ["file", "stream", "raw"] {
            assert!(read("pictures") == read(of), "{of} {number}");
        }
    }
    let second = fs::read(folder.path().join("pictures/000001.flo")).unwrap();
    assert!(second == fs::read(folder.path().join("pair.flo")).unwrap());
}

#[test]
fn a_beginning_can_be_given() {
    let folder = frames();
    flo::write(folder.path().join("init.flo"), &Scene::new(SIZE).unwrap().flow(0)).unwrap();
    let plain = ["flow", "0.png", "1.png", "--iterations", "1", "-o", "a.flo", "--backend", "cpu"];
    run(&folder, &plain).well();
    run(&folder, &[&plain[..6], &["b.flo", "--init", "init.flo"]].concat()).well();
    assert_ne!(field(&folder, "a.flo"), field(&folder, "b.flo"));
    run(&folder, &["flow", "?.png", "-o", "cold"]).well();
    run(&folder, &["flow", "?.png", "-o", "warm", "--warm-start"]).well();
    assert_eq!(field(&folder, "cold/000000.flo"), field(&folder, "warm/000000.flo"));
    assert_ne!(field(&folder, "cold/000002.flo"), field(&folder, "warm/000002.flo"));
}

#[test]
fn wide_and_coloured_pixels_are_read() {
    let folder = frames();
    for number in 0..2 {
        let gray = Scene::new(SIZE).unwrap().frame(number);
        let wide = gray.data.iter().flat_map(|v| (u16::from(*v) * 257).to_ne_bytes()).collect();
        let rgb = gray.data.iter().flat_map(|v| [*v; 3]).collect();
        let name = |kind: &str| folder.path().join(format!("{kind}{number}.png"));
        picture::write_png(name("wide"), &Image { size: SIZE, format: PixelFormat::Gray16, data: wide })
            .unwrap();
        picture::write_png(name("rgb"), &Image { size: SIZE, format: PixelFormat::Rgb8, data: rgb }).unwrap();
    }
    run(&folder, &["flow", "0.png", "1.png", "-o", "gray.flo"]).well();
    for kind in ["wide", "rgb"] {
        run(&folder, &["flow", &format!("{kind}0.png"), &format!("{kind}1.png"), "-o", "b.flo"]).well();
        let (gray, other) = (field(&folder, "gray.flo"), field(&folder, "b.flo"));
        // White is 255 in every format; a product with 1/257 may round.
        let error = viewsphere::eval::flow_error(&gray, &other, None).unwrap();
        assert!(error.aee_px < 1e-4, "{kind} {error:?}");
    }
}

#[test]
fn a_field_is_judged() {
    let folder = tempfile::tempdir().unwrap();
    let size = Size::new(2, 1);
    let write = |name: &str, data| flo::write(folder.path().join(name), &FlowField { size, data }).unwrap();
    write("truth.flo", vec![[0.0, 0.0], [1.0, 0.0]]);
    write("a.flo", vec![[3.0, 4.0], [1.0, 0.0]]);
    let json = run(&folder, &["eval", "--truth", "truth.flo", "a.flo", "--json"]).json();
    assert_eq!((&json["aee_px"], &json["r1"], &json["pixels"]), (&2.5.into(), &0.5.into(), &2.into()));
    let mask = Image { size, format: PixelFormat::Gray8, data: vec![0, 255] };
    picture::write_png(folder.path().join("mask.png"), &mask).unwrap();
    let text = run(&folder, &["eval", "--truth", "truth.flo", "a.flo", "--mask", "mask.png"]).well().text();
    assert!(text.starts_with("endpoint error  mean 0.0000 px") && text.contains("(1 pixels"), "{text}");
}

#[test]
fn the_executors_are_compared_and_a_breach_ends_with_1() {
    if need::gpu().is_none() {
        return;
    }
    let folder = frames();
    let json = run(&folder, &["crosscheck", "--size", "65x47", "--json"]).json();
    assert_eq!((&json["breaches"], &json["width"]), (&0.into(), &65.into()));
    let steps = json["steps"].as_array().unwrap();
    assert!(steps.len() > 10 && steps.iter().all(|step| step["share_of_bound"].as_f64().unwrap() <= 1.0));
    let own = |step: &&serde_json::Value| step["bound_own"]["median"].as_f64().is_some_and(|px| px < 1e-4);
    assert!(
        steps.iter().filter(own).count() > 0
            && steps.iter().filter(own).all(|step| step["kernel"] == "solve")
    );
    assert!(json["flow"]["max"].as_f64().unwrap() < 1e-2, "{}", json["flow"]);
    let text = run(&folder, &["crosscheck", "0.png", "1.png", "--steps"]).well().text();
    assert!(text.contains("every value of every step") && text.contains("solve (frame 1, level 0"), "{text}");
    assert!(text.contains("confidence (frame 1, confidence): confidence"), "{text}");
    // Bit-identical results are not promised: the last digit of a division or a square root depends on the driver.
    let ended = run(&folder, &["crosscheck", "0.png", "1.png", "--bounds", "0"]);
    let differs = !ended.text().contains("first step with any difference: none");
    assert_eq!(ended.code, Some(i32::from(differs)));
    assert_eq!(ended.text().contains("FAILED"), differs, "{}", ended.text());
}

#[test]
fn adapters_are_listed() {
    let folder = tempfile::tempdir().unwrap();
    let json = run(&folder, &["devices", "--json"]).json();
    if let Some(gpu) = need::gpu_if_any() {
        let adapters = json["adapters"].as_array().unwrap();
        let found = adapters.iter().find(|a| a["name"] == *gpu.adapter().name).unwrap();
        assert_eq!(found["usable"], true);
        assert!(run(&folder, &["devices"]).well().text().contains(&gpu.adapter().name));
    }
    assert!(json["cpu_threads"].as_u64().unwrap() > 0);
}

#[test]
fn times_are_taken() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["bench", "--size", "40x33", "33x40", "--frames", "3", "--backend", "cpu"];
    let json = run(&folder, &[&args[..], &["--json"]].concat()).json();
    let sizes: Vec<u64> = json.as_array().unwrap().iter().map(|r| r["width"].as_u64().unwrap()).collect();
    assert_eq!(sizes, [40, 33]);
    for result in json.as_array().unwrap() {
        assert!(result["frame_ms"]["median"].as_f64().unwrap() > 0.0);
        assert!(result["copy_gb_s"].as_f64().unwrap() > 0.0);
        let kernels = result["kernels"].as_array().unwrap();
        assert!(kernels.iter().any(|k| k["kernel"] == "solve" && k["steps"].as_u64().unwrap() > 0));
    }
    assert!(run(&folder, &args).well().text().contains("of copy"));
}

#[test]
fn requests_are_answered_one_a_line() {
    let folder = frames();
    let params = r#"{"pyr_scale":0.5,"levels":3,"winsize":15,"iterations":3,"poly_n":5,"poly_sigma":1.2,"window":"box"}"#;
    let request = |b: &str, stream: bool, flow: &str| {
        format!(
            r#"{{"a":"0.png","b":"{b}","backend":"cpu","params":{params},"repeat":2,"stream":{stream},"flow":{flow}}}"#
        )
    };
    let lines = [
        request("1.png", false, r#""one.flo""#),
        "nonsense".to_owned(),
        request("9.png", false, "null"),
        request("1.png", true, r#""two.flo""#),
    ];
    let ended = run_with(folder.path(), &["bench", "--serve"], lines.join("\n").as_bytes(), false).well();
    let answers: Vec<Value> = ended.text().lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(answers.len(), 4);
    for i in [0, 3] {
        assert_eq!(
            (answers[i]["wall_ms"].as_array().unwrap().len(), &answers[i]["error"]),
            (2, &Value::Null)
        );
        assert!(answers[i]["adapter"].as_str().unwrap().starts_with("CPU"));
    }
    assert!(answers[1]["error"].as_str().unwrap().starts_with("request is "));
    assert!(answers[2]["error"].as_str().unwrap().starts_with("9.png: "));
    run(&folder, &["flow", "0.png", "1.png", "-o", "a.flo", "--backend", "cpu"]).well();
    assert_eq!(field(&folder, "one.flo"), field(&folder, "a.flo"));
    assert_eq!(field(&folder, "two.flo"), field(&folder, "a.flo"));
}

#[test]
fn the_demo_needs_no_gpu_and_says_what_it_computes_on() {
    let folder = tempfile::tempdir().unwrap();
    let ended =
        run_with(folder.path(), &["demo", "--size", "96x72", "--seconds", "0.1", "-o", "d"], b"", true)
            .well();
    let text = ended.text();
    for word in ["mean endpoint error", "frames per second", "images     in d"] {
        assert!(text.contains(word), "{text}");
    }
    for name in [
        "arrows.png",
        "color.png",
        "confidence.png",
        "error.png",
        "flow.flo",
        "frame_0.png",
        "frame_1.png",
        "truth.png",
    ] {
        assert!(folder.path().join("d").join(name).is_file(), "{name}");
    }
    if has_adapter_without_vulkan(folder.path(), Without::Part) {
        return;
    }
    assert!(text.starts_with("backend    CPU"), "{text}");
    assert!(
        ended.stderr.starts_with("viewsphere: computing on the CPU; no usable GPU adapter"),
        "{}",
        ended.stderr
    );
}

#[test]
fn without_a_driver_a_gpu_is_refused_with_what_to_install() {
    let folder = tempfile::tempdir().unwrap();
    if has_adapter_without_vulkan(folder.path(), Without::Nothing) {
        return;
    }
    let ended = run_with(folder.path(), &["demo", "--backend", "gpu"], b"", true);
    assert_eq!((ended.code, ended.stderr.lines().count()), (Some(2), 1), "{}", ended.stderr);
    assert!(
        ended.stderr.contains("install") && ended.stderr.contains("mesa-vulkan-drivers"),
        "{}",
        ended.stderr
    );
    assert!(names(folder.path()).is_empty());
}

/// Metal, Direct3D or OpenGL, where they are compiled in.
fn has_adapter_without_vulkan(folder: &Path, without: Without) -> bool {
    let json = run_with(folder, &["devices", "--json"], b"", true).json();
    let has = !json["adapters"].as_array().unwrap().is_empty();
    let none = if has { Err(format!("there are {}", json["adapters"])) } else { Ok(()) };
    need::found("no adapter besides Vulkan's", none, without).is_none()
}

#[test]
fn every_help_has_examples() {
    let folder = tempfile::tempdir().unwrap();
    for command in ["run", "flow", "track", "undistort", "crosscheck", "eval", "bench", "devices", "demo"] {
        let text = run(&folder, &[command, "--help"]).well().text();
        assert!(text.contains(&format!("Examples:\n  viewsphere {command}")), "{text}");
    }
    assert!(run(&folder, &["--help"]).well().text().contains("Examples:"));
    assert!(run(&folder, &["--version"]).well().text().starts_with("viewsphere "));
}
