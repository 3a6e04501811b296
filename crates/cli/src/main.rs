//! The `wythe` command.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    wythe_cli::command(std::env::args_os()).into()
}
