//! The program as its users run it.

use std::path::Path;
use std::process::{Command, Stdio};

/// The result of a run.
pub(crate) struct Ended {
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

/// Runs the program in a folder.
pub(crate) fn program(folder: &Path, args: &[&str]) -> Ended {
    let mut command = Command::new(env!("CARGO_BIN_EXE_viewsphere"));
    command.args(args).current_dir(folder).env_remove("XDG_RUNTIME_DIR").stdin(Stdio::null());
    // Tests leave nothing in the user's folders.
    command.env("VIEWSPHERE_CACHE", "");
    let output = command.output().unwrap_or_else(|error| panic!("{error}"));
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap_or_else(|error| panic!("{error}"));
    Ended { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
}

/// Expects an error of one line that contains these words, and that the folder stays empty.
#[track_caller]
pub(crate) fn refused(args: &[&str], words: &[&str]) {
    let folder = tempfile::tempdir().unwrap_or_else(|error| panic!("{error}"));
    let ended = program(folder.path(), args);
    assert_eq!(ended.code, Some(2), "{args:?}: {}", ended.stderr);
    assert!(ended.stdout.is_empty(), "{args:?}: {}", ended.stdout);
    let errors: Vec<&str> =
        ended.stderr.lines().filter(|line| !line.starts_with("viewsphere: computing on")).collect();
    assert_eq!(errors.len(), 1, "{args:?}: {}", ended.stderr);
    assert!(words.iter().all(|word| errors[0].contains(word)), "{args:?}: {words:?} in {}", ended.stderr);
    assert!(folder.path().read_dir().is_ok_and(|mut entries| entries.next().is_none()), "{args:?}");
}
