//! The `wythe` command: a thin door onto `Deck → Model → solve → RunDirectory`.
#![forbid(unsafe_code)]

mod arguments;
mod check;
mod compare;
mod drive;
mod export;
mod failure;
mod findings;
mod info;
mod interrupt;
mod new;
mod plot;
mod report;
mod resume;
mod run;
mod salvage;
mod schema;
mod shell;
mod study;
mod terminal;
mod unicode;

use std::process::ExitCode;

use clap::Parser;

use arguments::{Arguments, Command};
use failure::Failure;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    failure::draw_as_the_terminal_can();
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
        Command::New(arguments) => new::new(arguments),
        Command::Resume(arguments) => resume::resume(arguments),
        Command::Check(arguments) => check::check(arguments),
        Command::Schema => schema::schema(),
        Command::Drive(arguments) => drive::drive(arguments),
        Command::Salvage(arguments) => salvage::salvage(arguments),
        Command::Report(arguments) => report::report(arguments),
        Command::Plot(arguments) => plot::plot(arguments),
        Command::Compare(arguments) => compare::compare(arguments),
        Command::Info(arguments) => info::info(arguments),
        Command::Export(arguments) => export::export(arguments),
        Command::Study(arguments) => study::study(arguments),
        Command::Completions(arguments) => shell::completions(arguments),
        Command::Man(arguments) => shell::man(arguments),
    }
}
