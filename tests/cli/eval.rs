//! `viewsphere eval` on data sets as its users run it.

use std::fs;
use std::path::Path;

use serde_json::Value;
use viewsphere::eval::Scene;
use viewsphere::frame::{FlowField, Image, PixelFormat, Plane, Size, UNKNOWN_FLOW};
use viewsphere::io::{flo, kitti, npy, picture};

use crate::program::{Ended, program};

pub(crate) const SIZE: Size = Size::new(48, 40);
/// Pixels with a wrong truth.
const WRONG: usize = 48;
/// Cheap and certain: on the CPU, without times.
const CHEAP: [&str; 4] = ["--backend", "cpu", "--repeats", "0"];

pub(crate) fn eval(folder: &Path, args: &[&str]) -> Ended {
    program(folder, &[&["eval"], args, &CHEAP].concat())
}

#[track_caller]
pub(crate) fn well(ended: Ended) -> Ended {
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended
}

pub(crate) fn read(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap()
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

fn write_frame(path: &Path, image: &Image) {
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    picture::write_png(path, image).unwrap();
}

/// A set of two pairs by Middlebury's convention. The truth of the last row is wrong by 2 px, so that there are bad pixels.
pub(crate) fn middlebury(folder: &Path) {
    let scene = Scene::new(SIZE).unwrap();
    for (name, number) in [("One", 0), ("Two", 5)] {
        let own = folder.join(name);
        write_frame(&own.join("frame10.png"), &scene.frame(number));
        write_frame(&own.join("frame11.png"), &scene.frame(number + 1));
        let mut truth = scene.flow(number);
        truth.data[SIZE.pixels() - WRONG..].iter_mut().for_each(|[u, _]| *u += 2.0);
        flo::write(own.join("flow10.flo"), &truth).unwrap();
    }
}

#[test]
fn figures_are_those_of_the_single_form() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    middlebury(&at.join("mb"));
    let outputs = ["--json", "all.json", "--csv", "all.csv", "--html", "all.html"];
    let args = [
        &["--data", "mb", "--run", "farneback,farneback-tv:fast", "--baseline", "farneback-tv:fast"],
        &outputs[..],
    ];
    let ended = well(eval(at, &args.concat()));
    assert!(
        ended.stdout.contains("mb, 2 pairs") && ended.stdout.contains("farneback-tv:fast"),
        "{}",
        ended.stdout
    );
    assert!(ended.stderr.contains("4/4 mb/Two farneback-tv:fast on cpu: AEE"), "{}", ended.stderr);
    let table = json(&read(at, "all.json"));
    let pairs = table["pairs"].as_array().unwrap();
    assert_eq!(pairs.len(), 4);
    let frames = ["mb/Two/frame10.png", "mb/Two/frame11.png"];
    well(program(at, &["flow", frames[0], frames[1], "-o", "two.flo", "--backend", "cpu"]));
    let one = well(program(at, &["eval", "--truth", "mb/Two/flow10.flo", "two.flo", "--json"]));
    let two = pairs.iter().find(|row| row["pair"] == "Two" && row["run"] == "farneback:default").unwrap();
    assert_eq!(two["errors"]["all"], json(&one.stdout));
    // Ratios are to the baseline, and the confidence has a curve from all alarms to none.
    let base = pairs.iter().find(|row| row["pair"] == "Two" && row["run"] == "farneback-tv:fast").unwrap();
    let ratio = |row: &Value| {
        row["errors"]["all"]["aee_px"].as_f64().unwrap() / base["errors"]["all"]["aee_px"].as_f64().unwrap()
    };
    assert!(
        (two["ratios"]["aee"].as_f64().unwrap() - ratio(two)).abs() < 1e-12 && base["ratios"]["aee"] == 1.0
    );
    let (bad, area) = (&two["confidence"]["bad"], &two["confidence"]["everywhere"]["area"]);
    let least = WRONG as f64 / SIZE.pixels() as f64;
    assert!(bad.as_f64().is_some_and(|bad| bad >= least && bad < 0.5), "{bad}");
    assert!(area.as_f64().is_some_and(|area| area > 0.0 && area < 1.0), "{area}");
    assert_eq!((&two["time"], &two["confidence"]["sky"]["area"]), (&Value::Null, &Value::Null));
    let csv = read(at, "all.csv");
    let columns = csv.lines().next().unwrap().split(',').count();
    // Two pairs, the set and the total, each with two runs.
    assert!(csv.lines().count() == 9 && csv.lines().all(|line| line.split(',').count() == columns), "{csv}");
    let html = read(at, "all.html");
    assert_eq!((html.matches("data:image/png").count(), html.matches("data:image/jpeg").count()), (4, 4));
}

#[test]
fn every_kind_of_set_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let scene = Scene::new(SIZE).unwrap();
    let (frames, flow) = ([scene.frame(0), scene.frame(1)], scene.flow(0));
    let put = |names: [&str; 2]| {
        names.iter().zip(&frames).for_each(|(name, frame)| write_frame(&at.join(name), frame))
    };
    let folder_of = |name: &str| fs::create_dir_all(at.join(name)).unwrap();
    // KITTI: the upper half is occluded.
    put(["kitti/training/image_2/000007_10.png", "kitti/training/image_2/000007_11.png"]);
    ["flow_occ", "flow_noc"].iter().for_each(|name| folder_of(&format!("kitti/training/{name}")));
    kitti::write(at.join("kitti/training/flow_occ/000007_10.png"), &flow).unwrap();
    let mut visible: FlowField = flow.clone();
    visible.data[..SIZE.pixels() / 2].fill([UNKNOWN_FLOW; 2]);
    kitti::write(at.join("kitti/training/flow_noc/000007_10.png"), &visible).unwrap();
    // Sintel: the first row must not be used.
    put(["mpi/training/clean/alley/frame_0001.png", "mpi/training/clean/alley/frame_0002.png"]);
    ["flow", "invalid"].iter().for_each(|name| folder_of(&format!("mpi/training/{name}/alley")));
    flo::write(at.join("mpi/training/flow/alley/frame_0001.flo"), &flow).unwrap();
    let mut data = vec![0; SIZE.pixels()];
    data[..SIZE.width as usize].fill(255);
    let invalid = Image { size: SIZE, format: PixelFormat::Gray8, data };
    picture::write_png(at.join("mpi/training/invalid/alley/frame_0001.png"), &invalid).unwrap();
    // A simulated set: the left half is sky.
    put(["sim/frames/000000.png", "sim/frames/000001.png"]);
    ["flow", "depth"].iter().for_each(|name| folder_of(&format!("sim/{name}")));
    flo::write(at.join("sim/flow/000000.flo"), &flow).unwrap();
    let half = |i: usize| if i % 48 < 24 { f32::INFINITY } else { 5.0 };
    let depth = Plane { size: SIZE, data: (0..SIZE.pixels()).map(half).collect() };
    npy::write_plane(at.join("sim/depth/000000.npy"), &depth).unwrap();
    put(["yos/yos09.png", "yos/yos10.png"]);
    flo::write(at.join("yos/flow09.flo"), &flow).unwrap();
    put(["one/a.png", "one/b.png"]);
    flo::write(at.join("one/truth.flo"), &flow).unwrap();
    let ended = well(eval(at, &["--data", ".", "--run", "farneback", "--json", "--quiet"]));
    assert!(ended.stderr.is_empty(), "{}", ended.stderr);
    let table = json(&ended.stdout);
    let pixels = |set: &str, class: &str| {
        let row = table["pairs"].as_array().unwrap().iter().find(|row| row["set"] == set).unwrap();
        row["errors"][class]["pixels"].as_u64()
    };
    let all = SIZE.pixels() as u64;
    for set in ["one", "yos"] {
        assert_eq!(pixels(set, "all"), Some(all), "{set}");
    }
    assert_eq!((pixels("kitti", "occluded"), pixels("kitti", "visible")), (Some(all / 2), Some(all / 2)));
    assert_eq!(pixels("mpi", "all"), Some(all - 48));
    assert_eq!(pixels("sim", "all"), Some(all / 2));
    assert!(
        pixels("sim", "sky").is_some_and(|sky| sky > 0 && sky <= all / 2) && pixels("one", "sky").is_none()
    );
    let only = well(eval(at, &["--data", ".", "--kind", "kitti", "--run", "farneback", "--json", "--quiet"]));
    assert_eq!(json(&only.stdout)["sets"].as_array().unwrap().len(), 1);
}

#[test]
fn the_literatures_errors_stand_beside_ours() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let scene = Scene::new(SIZE).unwrap();
    for number in [8, 9, 10] {
        write_frame(&at.join(format!("set/yos{number:02}.png")), &scene.frame(number));
    }
    flo::write(at.join("set/flow09.flo"), &scene.flow(9)).unwrap();
    let table = ["--data", "set", "--table", "yosemite"];
    let ended = well(eval(at, &[&table[..], &["--run", "farneback-tv:fast"]].concat()));
    let rows = |needle: &str| ended.stdout.lines().filter(|line| line.contains(needle)).count();
    assert_eq!([rows("(quoted)"), rows("farneback-tv:fast")], [7, 2], "{}", ended.stdout);
    // Every preset of every algorithm, unless some are named.
    let all = well(eval(at, &[&table[..], &["--algorithm", "farneback"]].concat())).stdout;
    for preset in ["fast", "default", "accurate", "increment", "affine"] {
        assert!(all.contains(&format!("farneback:{preset}")), "{preset}: {all}");
    }
    middlebury(&at.join("mb"));
    let ended = eval(at, &["--data", "mb", "--table", "yosemite"]);
    assert!(ended.code == Some(2) && ended.stderr.contains("yosNN.png"), "{}", ended.stderr);
}

#[test]
fn results_are_resumed_and_shards_merged() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    middlebury(&at.join("mb"));
    let runs = ["--data", "mb", "--run", "farneback-tv:fast,farneback", "-o"];
    let whole = well(eval(at, &[&runs[..], &["whole"]].concat()));
    let files = ["results.jsonl", "table.csv", "table.json", "report.html"];
    let content = |name: &str| files.map(|file| read(at, &format!("{name}/{file}")));
    let before = content("whole");
    // Nothing is left to do; the second time the last line was cut off.
    let again = well(eval(at, &[&runs[..], &["whole"]].concat()));
    assert!(again.stderr.contains("4 evaluations on 2 pairs, 4 already done"), "{}", again.stderr);
    assert_eq!((content("whole"), &again.stdout), (before.clone(), &whole.stdout));
    fs::write(at.join("whole/results.jsonl"), &before[0][..before[0].len() - 30]).unwrap();
    let repaired = well(eval(at, &[&runs[..], &["whole"]].concat()));
    assert!(repaired.stderr.contains("incomplete last line") && repaired.stderr.contains("3 already done"));
    assert_eq!(content("whole"), before);
    // What is added to the runs is added to the results.
    for shard in ["1/2", "2/2"] {
        well(eval(at, &[&runs[..], &[&format!("part_{}", &shard[..1]), "--shard", shard]].concat()));
    }
    assert!(read(at, "part_1/results.jsonl").lines().count() == 3);
    let merged = well(program(at, &["eval", "merge", "part_2", "part_1", "part_2", "-o", "merged"]));
    assert_eq!((content("merged"), merged.stdout), (before, whole.stdout));
}

#[test]
fn a_pair_that_cannot_be_read_fails_alone() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    middlebury(&at.join("mb"));
    for (name, damage) in [("Cut", "cut"), ("Missing", "missing"), ("Small", "small")] {
        let own = at.join("mb").join(name);
        fs::create_dir_all(&own).unwrap();
        for file in ["frame10.png", "frame11.png", "flow10.flo"] {
            fs::copy(at.join("mb/One").join(file), own.join(file)).unwrap();
        }
        match damage {
            "cut" => fs::write(own.join("frame10.png"), "no image").unwrap(),
            "missing" => fs::remove_file(own.join("frame11.png")).unwrap(),
            _ => {
                let size = Size::new(2, 2);
                flo::write(own.join("flow10.flo"), &FlowField { size, data: vec![[0.0; 2]; 4] }).unwrap();
            }
        }
    }
    let args = ["--data", "mb", "--run", "farneback-tv:fast", "--quiet", "-o", "out"];
    let ended = eval(at, &args);
    assert_eq!(ended.code, Some(2));
    let lines: Vec<&str> = ended.stderr.lines().collect();
    let expected = [
        ["mb/Cut", "mb/Cut/frame10.png: content is ", "expected a PNG"],
        [
            "mb/Missing",
            "mb/Missing/frame11.png: image is missing",
            "expected the second frame of the pair Missing",
        ],
        ["mb/Small", "mb/Small/flow10.flo: size is 2×2", "expected 48×40 as in mb/Small/frame10.png"],
        ["number of evaluations that failed is 3", "expected none", "mb/Cut/farneback-tv:fast/cpu"],
    ];
    assert_eq!(lines.len(), expected.len(), "{}", ended.stderr);
    for (line, words) in lines.iter().zip(expected) {
        assert!(words.iter().all(|word| line.contains(word)), "{line}");
    }
    // Each place where results are read tells the reason.
    let reason = "mb/Missing/frame11.png: image is missing";
    for file in ["table.csv", "table.json", "report.html"] {
        assert!(read(at, &format!("out/{file}")).contains(reason), "{file}");
    }
    assert!(
        ended.stdout.contains(&format!("failed  Missing with farneback-tv:fast: {reason}")),
        "{}",
        ended.stdout
    );
    // The others have their figures, and once the files are whole, only what failed is tried again.
    assert!(ended.stdout.contains("mb, 5 pairs") && ended.stdout.contains("failed"), "{}", ended.stdout);
    for name in ["Cut", "Missing", "Small"] {
        for file in ["frame10.png", "frame11.png", "flow10.flo"] {
            fs::copy(at.join("mb/One").join(file), at.join("mb").join(name).join(file)).unwrap();
        }
    }
    let again = well(eval(at, &["--data", "mb", "--run", "farneback-tv:fast", "-o", "out"]));
    assert!(again.stderr.contains("5 evaluations on 5 pairs, 2 already done"), "{}", again.stderr);
    assert!(!again.stdout.contains("failed"), "{}", again.stdout);
}

#[test]
fn more_shards_than_pairs_leave_empty_ones_that_merge() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    middlebury(&at.join("mb"));
    let runs = ["--data", "mb", "--run", "farneback-tv:fast", "-o"];
    for number in ["1", "2", "3"] {
        let shard = format!("{number}/3");
        let ended = well(eval(at, &[&runs[..], &[&format!("part_{number}"), "--shard", &shard]].concat()));
        let told = ended.stderr.contains("shard 3/3 of 2 pairs is empty");
        assert_eq!(told, number == "3", "{}", ended.stderr);
        assert_eq!(ended.stdout == "no results\n", number == "3", "{}", ended.stdout);
    }
    let empty = json(&read(at, "part_3/table.json"));
    assert_eq!((&empty["baseline"], &empty["pairs"]), (&Value::Null, &Value::Array(Vec::new())));
    let quiet = well(eval(at, &[&runs[..], &["part_3", "--shard", "3/3", "--quiet"]].concat()));
    assert!(quiet.stderr.is_empty(), "{}", quiet.stderr);
    let merged =
        well(program(at, &["eval", "merge", "part_3", "part_1", "part_2", "-o", "merged", "--json"]));
    assert_eq!(json(&merged.stdout)["pairs"].as_array().unwrap().len(), 2);
    let ended = program(at, &["eval", "merge", "part_1", "-o", "again", "--baseline", "farneback"]);
    let words = ["--baseline is farneback:default", "one of the runs: farneback-tv:fast"];
    assert!(
        ended.code == Some(2) && words.iter().all(|word| ended.stderr.contains(word)),
        "{}",
        ended.stderr
    );
    assert!(!at.join("again").exists());
}

#[test]
fn a_preset_runs_the_algorithms_that_have_it_and_each_backend_once() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    middlebury(&at.join("mb"));
    let args = ["eval", "--data", "mb", "--pairs", "One", "--preset", "affine", "--repeats", "0", "--json"];
    let ended = well(program(at, &[&args[..], &["--backend", "cpu,cpu"]].concat()));
    let rows = json(&ended.stdout)["total"].clone();
    let runs: Vec<&str> = rows.as_array().unwrap().iter().map(|row| row["run"].as_str().unwrap()).collect();
    assert_eq!(runs, ["farneback:affine"]);
    assert!(ended.stderr.contains("1 evaluation on 1 pair"), "{}", ended.stderr);
}
