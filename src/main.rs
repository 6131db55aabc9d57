//! The command line. Everything that it does is in [`viewsphere::cli`].

use std::process::ExitCode;

fn main() -> ExitCode {
    viewsphere::cli::main()
}
