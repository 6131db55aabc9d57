//! The needs of tests that not every machine meets: a GPU, a data set, a tool.
//!
//! If a need is not met, the test is skipped. Standard error says so, and each need adds a line to the file that
//! `VIEWSPHERE_TEST_REPORT` names, which `tests/run` summarizes. If `VIEWSPHERE_REQUIRE` contains the need's first word
//! (`gpu`, `data`, or both with a comma), the test fails instead.

use std::collections::BTreeSet;
use std::fmt::Display;
use std::fs::OpenOptions;
use std::io::Write;
use std::sync::{Mutex, OnceLock};

use viewsphere::gpu::{Gpu, GpuOptions};

/// What remains of a test whose need is not met.
#[derive(Clone, Copy)]
pub(crate) enum Without {
    /// Nothing: it returns.
    Nothing,
    /// The rest of its checks.
    Part,
}

/// The adapter that `VIEWSPHERE_ADAPTER` names, or any. A test that gets none returns.
///
/// One device serves all tests of a process; those that lose theirs open their own.
pub(crate) fn gpu() -> Option<Gpu> {
    found("gpu", shared_gpu(), Without::Nothing)
}

/// As [`gpu`], for a test that checks the CPU in any case.
pub(crate) fn gpu_if_any() -> Option<Gpu> {
    found("gpu", shared_gpu(), Without::Part)
}

fn shared_gpu() -> Result<Gpu, String> {
    static GPU: OnceLock<Result<Gpu, String>> = OnceLock::new();
    let open = || {
        let adapter = std::env::var("VIEWSPHERE_ADAPTER").ok();
        let gpu = Gpu::new(&GpuOptions { adapter, allow_software: true, ..GpuOptions::default() })
            .map_err(|error| error.to_string());
        if let Ok(gpu) = &gpu {
            say_once(format!("testing on {}", gpu.adapter()));
        }
        gpu
    };
    GPU.get_or_init(open).clone()
}

/// Returns what was found, and reports it; an error is the reason why it was not. Must be called on the test's own
/// thread.
#[track_caller]
pub(crate) fn found<T, E: Display>(need: &str, found: Result<T, E>, without: Without) -> Option<T> {
    let word = need.split(' ').next().unwrap_or_default();
    let required = required().iter().any(|required| required == word);
    match found {
        Ok(thing) => {
            report(need, "had");
            Some(thing)
        }
        Err(why) if required => panic!("{need} is missing, which VIEWSPHERE_REQUIRE has: {why}"),
        Err(why) => {
            let (status, said) = match without {
                Without::Nothing => ("skipped", "skipped"),
                Without::Part => ("partly", "tested in part"),
            };
            report(need, status);
            say_once(format!("{said} are tests that need {need}: {why}"));
            None
        }
    }
}

/// The words in `VIEWSPHERE_REQUIRE`.
fn required() -> &'static [String] {
    static REQUIRED: OnceLock<Vec<String>> = OnceLock::new();
    REQUIRED.get_or_init(|| {
        let words = std::env::var("VIEWSPHERE_REQUIRE").unwrap_or_default();
        let words: Vec<String> =
            words.split(',').filter(|word| !word.is_empty()).map(str::to_owned).collect();
        for word in &words {
            assert!(
                ["gpu", "data"].contains(&&word[..]),
                "VIEWSPHERE_REQUIRE has {word}, expected gpu or data"
            );
        }
        words
    })
}

/// Adds a line to the report, if there is one: test, need and result, separated by tabs.
fn report(need: &str, status: &str) {
    let Some(path) = std::env::var_os("VIEWSPHERE_TEST_REPORT") else { return };
    let thread = std::thread::current();
    let test = thread.name().filter(|name| *name != "main");
    let test = test.unwrap_or_else(|| panic!("{need} is asked for outside of a test's own thread"));
    let line = format!("{}::{test}\t{need}\t{status}\n", env!("CARGO_CRATE_NAME"));
    // Appending a short line in one write is atomic, whatever other threads and processes write.
    let file = OpenOptions::new().append(true).create(true).open(&path);
    let written = file.and_then(|mut file| file.write_all(line.as_bytes()));
    written.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
}

/// Prints a message once per process, bypassing the capture of a test's output.
fn say_once(line: String) {
    static SAID: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());
    let mut said = SAID.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    if !said.contains(&line) {
        // If standard error is closed, there is nowhere to report it.
        let _ = writeln!(std::io::stderr(), "{line}");
        said.insert(line);
    }
}
