//! The `wythe` command: a thin door onto `Deck → Model → solve → RunDirectory`.
#![forbid(unsafe_code)]

mod arguments;
mod check;
mod drive;
mod failure;
mod interrupt;
mod resume;
mod run;
mod study;
mod terminal;

use std::process::ExitCode;

use clap::Parser;

use arguments::{Arguments, Command};
use failure::Failure;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let outcome = std::panic::catch_unwind(|| dispatch(&arguments.command));
    match outcome {
        Ok(Ok(())) => ExitCode::SUCCESS,
        Ok(Err(failure)) => {
            let code = failure.exit_code();
            failure.report();
            ExitCode::from(code)
        }
        Err(_) => {
            eprintln!(
                "This is a bug in wythe, not in your model. Please report it with the lines above \
                 and the model."
            );
            ExitCode::from(failure::BUG)
        }
    }
}

fn dispatch(command: &Command) -> Result<(), Failure> {
    match command {
        Command::Run(arguments) => run::run(arguments),
        Command::Resume(arguments) => resume::resume(arguments),
        Command::Check(arguments) => check::check(arguments),
        Command::Drive(arguments) => drive::drive(arguments),
        Command::Study(arguments) => study::study(arguments),
    }
}
