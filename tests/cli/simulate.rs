//! Data sets as the program writes them: their ground truth holds, and the other commands read them.

use std::fs;
use std::path::Path;
use std::process::Command;

use glam::{DMat3, DQuat, DVec3};
use serde_json::Value;
use tempfile::TempDir;
use viewsphere::camera::FRD_FROM_CAMERA;
use viewsphere::frame::FlowField;
use viewsphere::io::camera;
use viewsphere::io::gyro_log;
use viewsphere::io::{flo, npy, picture};

const SET: [&str; 12] = [
    "simulate",
    "--world",
    "city",
    "--seed",
    "3",
    "--seconds",
    "0.4",
    "--size",
    "96x72",
    "--backend",
    "cpu",
    "-o",
];
const ALL: [&str; 4] = ["--truth", "flow,depth,nearness,divergence,spherical,grid", "--grid", "9x5"];

fn run(folder: &Path, args: &[&str]) -> Result<String, String> {
    let mut command = Command::new(env!("CARGO_BIN_EXE_viewsphere"));
    let output = command.args(args).current_dir(folder).env_remove("XDG_RUNTIME_DIR").output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    if output.status.success() { Ok(text(output.stdout)) } else { Err(text(output.stderr)) }
}

fn simulated(more: &[&str]) -> (TempDir, Value) {
    let folder = tempfile::tempdir().unwrap();
    let args = [&SET[..], &["set/", "--json"], more].concat();
    let said = run(folder.path(), &args).unwrap();
    (folder, serde_json::from_str(&said).unwrap())
}

/// Rows of numbers below a header.
fn table(path: &Path) -> Vec<Vec<f64>> {
    let text = fs::read_to_string(path).unwrap();
    let row = |line: &str| line.split(',').map(|cell| cell.parse().unwrap()).collect();
    text.lines().skip(1).map(row).collect()
}

fn count(folder: &Path) -> usize {
    fs::read_dir(folder).unwrap().count()
}

#[test]
fn a_set_is_whole_and_its_truths_agree() {
    let (folder, said) = simulated(&ALL);
    let set = folder.path().join("set");
    assert_eq!((&said["frames"], &said["ended"]), (&Value::from(12), &Value::Null));
    assert_eq!(count(folder.path()), 1);
    for (name, files) in [("frames", 12), ("flow", 11), ("depth", 12), ("spherical", 12), ("grid", 12)] {
        assert_eq!(count(&set.join(name)), files, "{name}");
    }
    let camera = camera::read(set.join("camera.yaml")).unwrap();
    let poses = table(&set.join("poses.csv"));
    let pose = |row: &[f64]| {
        let turn = DQuat::from_xyzw(row[5], row[6], row[7], row[4]);
        (DVec3::new(row[1], row[2], row[3]), DMat3::from_quat(turn) * FRD_FROM_CAMERA)
    };
    let ((from, world_from_from), (to, world_from_to)) = (pose(&poses[3]), pose(&poses[4]));
    let depth = npy::read_plane(set.join("depth/000003.npy")).unwrap();
    let nearness = npy::read_plane(set.join("nearness/000003.npy")).unwrap();
    let flow = flo::read(set.join("flow/000003.flo")).unwrap();
    let (mut solid, mut sky) = (0, 0);
    for (i, (depth, nearness)) in depth.data.iter().zip(&nearness.data).enumerate() {
        if depth.is_infinite() {
            assert_eq!(*nearness, 0.0);
            sky += 1;
            continue;
        }
        // Each is rounded to an f32.
        assert!((depth * nearness - 1.0).abs() <= 2e-7, "{depth} {nearness}");
        if !FlowField::is_known(flow.data[i]) {
            continue;
        }
        // The flow by the depth and the poses of the files.
        let pixel = [(i % 96) as f64, (i / 96) as f64];
        let place = from + world_from_from * camera.ray(pixel).unwrap() * f64::from(*depth);
        let there = camera.project(world_from_to.transpose() * (place - to)).unwrap();
        let off = (0..2)
            .map(|c| f64::from(flow.data[i][c]) - (there[c] - pixel[c]))
            .fold(0.0, |a: f64, b| a.hypot(b));
        assert!(off <= 1e-4, "{pixel:?} {off}");
        solid += 1;
    }
    assert!(solid > 2000 && sky > 500, "{solid} {sky}");
    // The noisy samples lie around the true ones, from the first frame to the last.
    let [noisy, exact] = ["gyro.csv", "gyro_true.csv"].map(|name| gyro_log::read(set.join(name)).unwrap());
    assert_eq!((noisy.len(), exact.len()), (11 * 8 + 1, 11 * 8 + 1));
    let square: f64 =
        noisy.iter().zip(&exact).map(|(a, b)| (a.gyro_rad_s - b.gyro_rad_s).length_squared()).sum();
    let deviation = (square / (3.0 * noisy.len() as f64)).sqrt();
    // 3.4e-4 rad/s/√Hz at 240 Hz, of 267 values: within a fifth, which is more than four standard errors.
    assert!((deviation / (3.4e-4 * 240_f64.sqrt()) - 1.0).abs() < 0.2, "{deviation}");
    assert!(fs::read_to_string(set.join("README.md")).unwrap().contains("--world city --seed 3"));
}

#[test]
fn a_large_set_is_announced() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_viewsphere"));
    // It fails before it writes anything: the existing folder is not a data set.
    fs::create_dir_all(folder.path().join("set/x")).unwrap();
    let args = ["simulate", "--size", "2048x1024", "--seconds", "10", "-o", "set"];
    let output = command.args(args).current_dir(folder.path()).output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    // Image, flow and depth: 13 bytes for each of 2²¹ pixels.
    assert!(
        said.starts_with("viewsphere: up to 8.2 GB will be written: 300 frames of 2048×1024\n"),
        "{said}"
    );
}

#[test]
fn pictures_of_truths_have_their_colours_and_a_scale() {
    let (folder, said) = simulated(&["--truth", "nearness,divergence,depth", "--pictures", "--speed", "10"]);
    let set = folder.path().join("set");
    assert_eq!(said["full_colour"], "nearness ±0.1000 /m, divergence ±2.0000 /s");
    assert!(fs::read_to_string(set.join("README.md")).unwrap().contains("nearness ±0.1000 /m"));
    for (name, files) in [("nearness", 24), ("divergence", 24), ("depth", 12)] {
        assert_eq!(count(&set.join(name)), files, "{name}");
    }
    let nearness = npy::read_plane(set.join("nearness/000005.npy")).unwrap();
    let image = picture::read(set.join("nearness/000005.png")).unwrap();
    assert_eq!(image.size, nearness.size);
    for (pixel, nearness) in image.data.as_chunks::<3>().0.iter().zip(&nearness.data) {
        // The sky is white, and near surfaces are red.
        let expected = if *nearness == 0.0 { pixel == &[255; 3] } else { pixel[1] <= pixel[0] };
        assert!(expected, "{pixel:?} {nearness}");
    }
}

#[test]
fn the_other_commands_read_a_set() {
    let (folder, _) = simulated(&[]);
    let run = |args: &[&str]| run(folder.path(), args).unwrap();
    let own = run(&["eval", "--truth", "set/flow/000004.flo", "set/flow/000004.flo", "--json"]);
    let own: Value = serde_json::from_str(&own).unwrap();
    assert_eq!((own["aee_px"].as_f64(), own["density"].as_f64()), (Some(0.0), Some(1.0)));
    run(&["flow", "set/frames/%06d.png", "-o", "estimate/", "--backend", "cpu"]);
    let found = run(&["eval", "--truth", "set/flow/000004.flo", "estimate/000004.flo", "--json"]);
    let found: Value = serde_json::from_str(&found).unwrap();
    let still = FlowField { size: "96x72".parse().unwrap(), data: vec![[0.0; 2]; 96 * 72] };
    flo::write(folder.path().join("still.flo"), &still).unwrap();
    let still = run(&["eval", "--truth", "set/flow/000004.flo", "still.flo", "--json"]);
    let still: Value = serde_json::from_str(&still).unwrap();
    // The images move as the ground truth states: on average an estimate is nearer to it than zero flow only if it
    // follows it, and one of the wrong sign is twice as far away.
    let [found, still] = [found, still].map(|e| e["aee_px"].as_f64().unwrap());
    assert!(found < still, "{found} {still}");
    let said = run(&[
        "run",
        "set/frames/%06d.png",
        "--camera",
        "set/camera.yaml",
        "--times",
        "set/times.csv",
        "--gyro",
        "set/gyro.csv",
        "--camera-from-gyro",
        "frd",
        "--backend",
        "cpu",
        "--json",
    ]);
    let said: Value = serde_json::from_str(&said).unwrap();
    assert_eq!((&said["frames"], &said["invalid"]["gyro"]), (&Value::from(12), &Value::from(0)));
}

#[test]
fn the_same_command_makes_the_same_set_and_spares_what_is_there() {
    let (a, _) = simulated(&["--truth", "depth"]);
    let (b, _) = simulated(&["--truth", "depth"]);
    for name in ["frames/000007.png", "depth/000007.npy", "gyro.csv", "poses.csv", "README.md"] {
        let [a, b] = [&a, &b].map(|folder| fs::read(folder.path().join("set").join(name)).unwrap());
        assert!(a == b, "{name}");
    }
    let again = |more: &[&str]| run(a.path(), &[&SET[..], &["set"], more].concat());
    let text = again(&[]).unwrap_err();
    assert!(text.contains("-o is set, which is not empty") && text.trim().lines().count() <= 2, "{text}");
    again(&["--force", "--fps", "60"]).unwrap();
    assert_eq!(count(&a.path().join("set/frames")), 24);
    assert_eq!(count(a.path()), 1);
    // The camera's file would be removed with the folder.
    let own = ["simulate", "--seconds", "0.4", "--camera", "set/camera.yaml", "-o", "set", "--force"];
    let text = run(a.path(), &own).unwrap_err();
    assert!(text.contains("--camera is set/camera.yaml, expected a file outside set"), "{text}");
    // A folder that is not a data set is never replaced.
    fs::remove_file(a.path().join("set/poses.csv")).unwrap();
    let text = again(&["--force"]).unwrap_err();
    assert!(text.contains("which has no poses.csv"), "{text}");
    assert_eq!(picture::read(a.path().join("set/frames/000000.png")).unwrap().size.to_string(), "96×72");
}

#[test]
fn what_is_out_of_range_is_refused_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let text =
        run(folder.path(), &["simulate", "-o", "set", "--truth", "grid", "--grid", "0x4"]).unwrap_err();
    assert!(text.contains("0×4"), "{text}");
    let text = run(folder.path(), &["simulate", "-o", "/proc/set"]).unwrap_err();
    assert!(text.contains("/proc/set: "), "{text}");
    let text = run(folder.path(), &["simulate", "-o", "set", "--pictures"]).unwrap_err();
    assert!(text.contains("--pictures is on, expected divergence or nearness in --truth"), "{text}");
    for (flag, value, expected) in [
        ("--seconds", "0", "--seconds is 0, expected above 0 and at most 600"),
        ("--seconds", "nan", "--seconds is NaN"),
        ("--fps", "7", "--fps is 7, expected a divisor of 240"),
        ("--speed", "-1", "--speed is -1, expected 7."),
        (
            "--seconds",
            "0.01",
            "--seconds is 0.01, 0 frames at --fps 30, expected 2 frames and more, from 0.050 s on",
        ),
        ("--noise", "-1", "--noise is -1, expected 0 to 64 gray levels"),
        ("--gyro-noise", "-1", "--gyro-noise is -1, expected 0 to 1"),
        ("--gyro-noise", "1e300", "expected 0 to 1"),
        ("--gyro-bias", "1e5", "--gyro-bias is 100000 °/s, expected within ±2005 °/s"),
        ("--grid", "4x4", "--grid is 4x4, expected none without grid in --truth"),
        ("--fps", "-1", "-1"),
        ("--seed", "-1", "a whole number from 0 on"),
        ("--world", "moon", "moon"),
    ] {
        let text =
            run(folder.path(), &["simulate", "-o", "set", "--backend", "cpu", flag, value]).unwrap_err();
        assert!(text.contains(expected), "{flag} {value}: {text}");
        assert_eq!(count(folder.path()), 0, "{flag} {value}");
    }
}
