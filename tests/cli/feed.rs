//! Runs a program with given standard input.

use std::io::Write;
use std::process::{Command, Output, Stdio};

/// Runs the program to its end, with `stdin` on its standard input.
pub(crate) fn feed(command: &mut Command, stdin: &[u8]) -> Output {
    command.env_remove("XDG_RUNTIME_DIR");
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut pipe = child.stdin.take().unwrap();
    let input = stdin.to_vec();
    // A program that has ended reads no more.
    let writer = std::thread::spawn(move || drop(pipe.write_all(&input)));
    let output = child.wait_with_output().unwrap();
    writer.join().unwrap();
    output
}
