//! Bad input: one line on standard error, exit code 2, and no file written.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use tempfile::TempDir;
use viewsphere::frame::{FlowField, Image, PixelFormat, Plane, Size};
use viewsphere::io::{flo, npy, picture};

/// A folder of valid and invalid files.
fn files() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    for (name, width, value) in [("a.png", 40, 9), ("b.png", 40, 200), ("wide.png", 41, 9), ("s1.png", 40, 9)]
    {
        let size = Size::new(width, 33);
        let image = Image { size, format: PixelFormat::Gray8, data: vec![value; size.pixels()] };
        picture::write_png(at(name), &image).unwrap();
    }
    let size = Size::new(40, 33);
    let rgb = Image { size, format: PixelFormat::Rgb8, data: vec![7; 3 * size.pixels()] };
    picture::write_png(at("rgb.png"), &rgb).unwrap();
    let flow = FlowField { size, data: vec![[0.0; 2]; size.pixels()] };
    let bytes = flo::encode(&flow).unwrap();
    fs::write(at("good.flo"), &bytes).unwrap();
    fs::write(at("cut.flo"), &bytes[..bytes.len() - 1]).unwrap();
    let unknown = FlowField { size, data: vec![[f32::NAN; 2]; size.pixels()] };
    npy::write(at("unknown.npy"), &unknown).unwrap();
    npy::write_plane(at("dark.npy"), &Plane { size, data: vec![0.0; size.pixels()] }).unwrap();
    flo::write(at("small.flo"), &FlowField { size: Size::new(1, 1), data: vec![[0.0; 2]] }).unwrap();
    fs::write(at("text.png"), "hello").unwrap();
    fs::write(at("cut.y4m"), "YUV4MPEG2 W40 H33 Cmono\nFRAME\nabc").unwrap();
    fs::write(at("file"), "").unwrap();
    folder
}

fn tree(folder: &Path) -> Vec<(String, u64)> {
    let entry = |e: fs::DirEntry| (e.file_name().into_string().unwrap(), e.metadata().unwrap().len());
    let mut all: Vec<_> = fs::read_dir(folder).unwrap().map(|e| entry(e.unwrap())).collect();
    all.sort();
    all
}

#[track_caller]
fn refused(folder: &TempDir, args: &[&str], words: &[&str]) {
    let before = tree(folder.path());
    let output = Command::new(env!("CARGO_BIN_EXE_viewsphere"))
        .args(args)
        .current_dir(folder.path())
        .env_remove("XDG_RUNTIME_DIR")
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{args:?}: {stderr}");
    assert_eq!(stderr.lines().count(), 1, "{args:?}: {stderr}");
    assert!(output.stdout.is_empty(), "{args:?}");
    for word in words {
        assert!(stderr.contains(word), "{args:?}: {word} is missing in {stderr}");
    }
    assert_eq!(tree(folder.path()), before, "{args:?}");
}

#[test]
fn inputs() {
    let folder = files();
    for (args, words) in [
        (&["flow", "a.png", "no-such.png", "-o", "o.flo"][..], &["no-such.png"][..]),
        (&["flow", "a.png", "-o", "o"], &["a.png", "number of frames is 1, expected at least 2"]),
        (&["flow", "."], &["input is a folder, expected files, such as './*.png' or './%04d.png'"]),
        (&["flow", "a.png", "text.png", "-o", "o.flo"], &["text.png", "expected a PNG"]),
        (
            &["flow", "a.png", "b.png", "-o", "o.flo", "--algorithm", "farneback-tv", "--third-frame", "0.5"],
            &["a.png b.png", "number of frames is 2, expected at least 3 for a third frame"],
        ),
        (
            &["flow", "a.png", "b.png", "-o", "o.flo", "--algorithm", "farneback-tv", "--third-frame", "NaN"],
            &["--third-frame is NaN, expected 0 to 1"],
        ),
        (&["flow", "a.png", "wide.png", "-o", "o.flo"], &["wide.png", "41×33", "40×33 as in a.png"]),
        (&["flow", "a.png", "rgb.png", "-o", "o.flo"], &["rgb.png", "rgb8", "gray8 as in a.png"]),
        (&["flow", "frames/%04d.png", "-o", "o"], &["frames"]),
        (&["flow", "%04d.png", "-o", "o"], &["%04d.png", "number of matching files is 0"]),
        (&["flow", "s%d.png", "-o", "o"], &["s%d.png", "number of frames is 1"]),
        (&["flow", "cut.y4m", "-o", "o"], &["cut.y4m", "video is cut off"]),
        (&["flow", "-", "-o", "o"], &["standard input", "empty"]),
        (&["flow", "a.png", "b.png", "--raw", "4x4"], &["--raw", "input is -"]),
        (&["flow", "a.png", "b.png", "--init", "small.flo"], &["small.flo", "1×1", "40×33 as in a.png"]),
        (&["flow", "a.png", "b.png", "--init", "cut.flo"], &["cut.flo", "expected"]),
        (&["flow", "a.png", "b.png", "--mask", "wide.png"], &["wide.png", "41×33", "40×33 as in a.png"]),
        (&["eval", "--truth", "good.flo", "cut.flo"], &["cut.flo", "10571 bytes", "10572 bytes"]),
        (&["eval", "--truth", "good.flo", "small.flo"], &["small.flo", "1×1", "40×33 as in good.flo"]),
        (&["eval", "--truth", "good.flo", "good.pfm"], &["good.pfm", ".pfm", ".flo"]),
        (&["eval", "--truth", "good.flo", "unknown.npy"], &["unknown.npy", "no pixel is known", "good.flo"]),
        (&["eval", "--truth", "unknown.npy", "good.flo", "--json"], &["no pixel is known", "unknown.npy"]),
        (&["eval", "--truth", "good.flo", "good.flo", "--mask", "dark.npy"], &["no pixel inside dark.npy"]),
        (&["crosscheck", "a.png", "wide.png"], &["wide.png", "40×33 as in a.png"]),
        (&["crosscheck", "a.png"], &["2 values"]),
    ] {
        refused(&folder, args, words);
    }
}

#[test]
fn outputs() {
    let folder = files();
    let pair = ["flow", "a.png", "b.png", "-o"];
    for (args, words) in [
        (&["o.xyz"][..], &["o.xyz", ".xyz", ".flo"][..]),
        (&["o"], &["extension is missing"]),
        (&["missing/o.flo"], &["missing"]),
        (&["file/o.flo"], &["file"]),
        (&["file/folder/"], &["file"]),
        (&["o.flo", "--color", "c.jpg"], &["c.jpg", ".png"]),
        (&["o.flo", "--color", "missing/c.png"], &["missing"]),
        (&["o.flo", "--confidence", "c.flo"], &["c.flo", ".npy or .png"]),
        (&["o.png", "--color", "./o.png"], &["--color is ./o.png, expected a path other than that of -o"]),
        (&["o.flo", "--color", "a.png"], &["--color is a.png, expected a path other than that of the input"]),
        (&["o.flo", "--color", "c.mp4"], &["c.mp4: extension is .mp4, expected .png"]),
        (&["o.flo", "--color", "c.png", "--scale", "0"], &["--scale is 0"]),
        (&["o.flo", "--color", "c.png", "--scale", "NaN"], &["--scale is NaN"]),
        (&["o.flo", "--arrows", "r.png", "--arrow-gain", "-1"], &["--arrow-gain is -1"]),
        (&["o.flo", "--scale", "3"], &["--color"]),
        (&["-", "--json"], &["--json", "standard output"]),
        (&["o.flo", "--warm-start"], &["--warm-start"]),
    ] {
        refused(&folder, &[&pair[..], args].concat(), words);
    }
    let many = ["flow", "a.png", "b.png", "a.png"];
    for (args, words) in [
        (&["-o", "o.flo"][..], &["o.flo", "a folder"][..]),
        (&["-o", "file"], &["file"]),
        (&["-o", "-", "--format", "kitti"], &["kitti"]),
        (&["-o", "o", "--format", "kitti", "--color", "o"], &["--color is o,", "that of -o"]),
        (
            &["--color", "c.mp4"],
            &["c.mp4", "a folder, as the input is a sequence", "ffmpeg -i c/%06d.png c.mp4"],
        ),
        (&["-o", "o", "--init", "good.flo"], &["--init", "--warm-start"]),
        (&["--format", "flo"], &["--format", "-o"]),
    ] {
        refused(&folder, &[&many[..], args].concat(), words);
    }
    refused(
        &folder,
        &["flow", "?.png", "--color", "."],
        &["--color is ., expected a path other than that of the input"],
    );
    refused(&folder, &["demo", "-o", "file"], &["file"]);
    refused(&folder, &["demo", "-o", "file/demo"], &["file"]);
}

#[test]
fn parameters() {
    let folder = files();
    for (args, words) in [
        (&["--pyr-scale", "NaN"][..], &["--pyr-scale is NaN", "above 0 and below 1"][..]),
        (&["--pyr-scale", "-0.5"], &["--pyr-scale is -0.5"]),
        (&["--pyr-scale", "half"], &["--pyr-scale is \"half\""]),
        (&["--poly-sigma", "inf"], &["--poly-sigma is inf", "0 to 100"]),
        (&["--levels", "33"], &["--levels is 33", "0 to 32"]),
        (&["--levels", "-1"], &["--levels", "-1"]),
        (&["--winsize", "1"], &["--winsize is 1", "2 to 1024"]),
        (&["--iterations", "0"], &["--iterations is 0", "1 to 1000"]),
        (&["--poly-n", "33"], &["--poly-n is 33"]),
        (&["--update", "increment"], &["--iterations is 3", "1 with a box window of increments"]),
        (
            &["--preset", "best"],
            &["--preset is \"best\" with farneback", "or the algorithm farneback-tv, which has it"],
        ),
        (&["--window", "round"], &["round", "box, gaussian"]),
        (&["--backend", "tpu"], &["tpu", "gpu, cpu"]),
        (&["--no-such-flag"], &["--no-such-flag"]),
        (&["--backend", "cpu", "--adapter", "x"], &["--adapter is x", "--backend cpu"]),
    ] {
        refused(&folder, &[&["flow", "a.png", "b.png"][..], args].concat(), words);
        refused(&folder, &[&["demo", "--size", "40x33"][..], args].concat(), words);
    }
    for size in ["0x10", "10x0", "16385x1", "10", "axb", "-1x4", "99999999999x1"] {
        for command in ["demo", "bench", "crosscheck"] {
            refused(&folder, &[command, "--size", size], &[size.split('x').next().unwrap_or_default()]);
        }
    }
    refused(&folder, &["crosscheck", "--bounds", "NaN"], &["--bounds is NaN"]);
    refused(&folder, &["bench", "--frames", "1"], &["--frames is 1", "2 to 100000"]);
    refused(&folder, &["demo", "--adapter", "no such adapter"], &["no usable GPU adapter"]);
    refused(&folder, &["swim"], &["swim"]);
    refused(&folder, &["run", "a.png"], &["--camera <FILE>", "--fov-deg <DEGREES>"]);
    for command in
        [&["fly"][..], &["campaign", "--sensors", "depth"], &["simulate", "--seconds", "1"], &["demo"]]
    {
        refused(&folder, &[command, &["-o", "-"]].concat(), &["-o is -, expected a folder"]);
    }
    let late = ["fly", "--sensor", "depth", "--fault", "gyro-lost:1000"];
    refused(&folder, &late, &["gyro-lost:1000 in forest", "before the flight is given up, at "]);
    refused(&folder, &[], &["--help"]);
}
