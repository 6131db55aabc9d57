//! What `viewsphere eval` refuses: one line on standard error, and nothing is written.

use std::fs;

use viewsphere::eval::Scene;
use viewsphere::io::flo;

use crate::eval::{SIZE, eval, middlebury, read, well};
use crate::program::program;

#[test]
fn flags_of_the_other_form_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    middlebury(&at.join("mb"));
    let truth = "mb/One/flow10.flo";
    let single = ["eval", "--truth", truth, truth];
    assert_eq!(program(at, &single).code, Some(0));
    for flags in [&["--csv", "x.csv"][..], &["--html", "x.html"], &["-o", "x"], &["--run", "farneback"]] {
        let ended = program(at, &[&single, flags].concat());
        assert!(ended.code == Some(2) && ended.stderr.contains("--data"), "{flags:?}: {}", ended.stderr);
    }
    let ended = eval(at, &["--data", "mb", "--run", "farneback:fast", "--mask", "none.png"]);
    assert!(ended.code == Some(2) && ended.stderr.contains("--truth"), "{}", ended.stderr);
}

#[test]
fn results_of_other_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    middlebury(&at.join("mb"));
    let args = ["--data", "mb", "--run", "farneback-tv:fast", "-o", "out"];
    well(eval(at, &args));
    let flow = Scene::new(SIZE).unwrap().flow(3);
    flo::write(at.join("mb/Two/flow10.flo"), &flow).unwrap();
    let ended = eval(at, &args);
    assert_eq!(ended.code, Some(2));
    let words = ["out/results.jsonl", "digest of the files of mb/Two", "another folder"];
    assert!(words.iter().all(|word| ended.stderr.contains(word)), "{}", ended.stderr);
    // Merging them with results of the new files is refused, too.
    well(eval(at, &["--data", "mb", "--run", "farneback-tv:fast", "-o", "new"]));
    let ended = program(at, &["eval", "merge", "out", "new", "-o", "both"]);
    assert_eq!(ended.code, Some(2));
    assert!(ended.stderr.contains("mb/Two/farneback-tv:fast/cpu with input"), "{}", ended.stderr);
}

#[test]
fn what_is_wrong_on_the_command_line_is_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    middlebury(&at.join("mb"));
    fs::create_dir(at.join("empty")).unwrap();
    fs::create_dir(at.join("foreign")).unwrap();
    fs::write(at.join("foreign/table.csv"), "my own").unwrap();
    let cases: [(&[&str], &[&str]); 23] = [
        (&[], &["what to evaluate is missing", "--truth FILE", "--data FOLDER"]),
        (&["--truth", "mb/One/flow10.flo"], &["flow field to evaluate is missing"]),
        (&["--data", "empty"], &["empty: data set is none", "frame10.png"]),
        (&["--data", "nowhere"], &["nowhere", "No such file"]),
        (&["--data", "mb", "--kind", "sintel"], &["mb: data set is none", "frame_NNNN"]),
        (&["--data", "mb", "--kind", "middleburg"], &["middleburg", "sintel"]),
        (&["--data", "mb", "--run", "farneback:fastest"], &["preset", "fastest"]),
        (
            &["--data", "mb", "--algorithm", "farneback", "--preset", "fine"],
            &["--preset is fine with farneback"],
        ),
        (&["--data", "mb", "--preset", "finest"], &["--preset is \"finest\"", "a preset of an algorithm"]),
        (&["--data", "mb", "--run", "farneback:poly-n=5:poly_n=7"], &["each parameter once"]),
        (
            &["--data", "mb", "--run", "farneback", "--baseline", "farneback-tv"],
            &["--baseline", "farneback:default"],
        ),
        (&["--data", "mb", "--pairs", "Three"], &["--pairs is Three", "mb/One"]),
        (&["--data", "mb", "--shard", "3/2"], &["3/2", "I/N"]),
        (&["--data", "mb", "mb"], &["two data sets named mb"]),
        (&["--data", "mb", "--pairs", "30..40"], &["--pairs is 30..40, expected"]),
        (&["--data", "mb", "--html", "no/a.html"], &["no"]),
        (&["--data", "mb", "--html", "a.csv"], &["a.csv: extension is .csv, expected .html"]),
        (&["--data", "mb", "--json", "notes.txt"], &["notes.txt: extension is .txt, expected .json"]),
        (&["--data", "mb", "-o", "o", "--json", "o/table.json"], &["--json is o/table.json", "that of -o"]),
        (&["--data", "mb", "-o", "foreign"], &["-o is a folder with foreign/table.csv", "results.jsonl"]),
        (&["merge", "empty", "-o", "foreign"], &["empty/results.jsonl"]),
        (&["--truth", "mb/One/flow10.flo", "mb/One/flow10.flo", "--json", "a.flo"], &["a.flo", ".json"]),
        (&["--data", "mb", "--truth", "a.flo", "b.flo"], &["--truth", "--data"]),
    ];
    for (args, words) in cases {
        let own: Vec<&str> = [&["eval"], args].concat();
        let ended = program(at, &own);
        assert_eq!(ended.code, Some(2), "{args:?}: {}", ended.stderr);
        assert!(ended.stdout.is_empty(), "{args:?}: {}", ended.stdout);
        let last = ended.stderr.lines().last().unwrap_or_default();
        assert!(words.iter().all(|word| last.contains(word)), "{args:?}: {words:?} in {}", ended.stderr);
    }
    assert_eq!(read(at, "foreign/table.csv"), "my own");
    assert!(!at.join("o").exists());
}

#[test]
fn results_with_and_without_times_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    middlebury(&at.join("mb"));
    let args = ["eval", "--data", "mb", "--run", "farneback-tv:fast", "--backend", "cpu", "-o", "out"];
    well(program(at, &[&args[..], &["--repeats", "0"]].concat()));
    let ended = program(at, &args);
    let words = ["with no times, --repeats 0 (", "with times, --repeats 1 or more ("];
    assert!(
        ended.code == Some(2) && words.iter().all(|word| ended.stderr.contains(word)),
        "{}",
        ended.stderr
    );
}
