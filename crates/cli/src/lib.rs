//! The `wythe` command: a thin interface to `Deck → Model → solve → RunDirectory`. It is a library, so that the wheel
//! can install the same command ([`command`]).
#![forbid(unsafe_code)]
// Input of users ends in typed errors.
#![cfg_attr(
    not(test),
    deny(clippy::unwrap_used, clippy::expect_used, clippy::panic)
)]

mod arguments;
mod check;
mod compare;
mod drive;
mod error_estimate;
mod evaluate;
mod export;
mod failure;
mod findings;
mod info;
mod interrupt;
mod limit;
mod modes;
mod new;
mod plot;
mod report;
mod resume;
mod run;
mod salvage;
mod say;
mod schema;
mod shell;
pub mod study;
mod terminal;
mod unicode;
mod view;

use std::ffi::OsString;
use std::io::ErrorKind;
use std::path::Path;

use clap::Parser;

use arguments::{Arguments, Command};
use failure::Failure;
use say::tell;

/// Runs the command line `arguments`, with the program's name first, and returns its exit code: 0 completed, 2 bad
/// model or usage, 3 not converged (results kept), 4 input or output, 130 interrupted, 1 a bug of wythe.
///
/// All output, `--help` and usage errors included, goes to standard output and standard error. The function may be
/// called again, but signals and the number of threads (`--threads`) belong to the process: the first Ctrl-C asks a
/// run to stop, as SIGTERM and SIGHUP do, and the second ends the process; rayon accepts a number of threads only
/// once.
pub fn command(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    command_of(&[this_program()], arguments)
}

/// Runs [`command`] in the process of another program, such as an interpreter. `program` is that program with the
/// arguments that start the command, so that studies can run decks in processes of their own.
pub fn command_of(program: &[OsString], arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        // clap returns the text of `--help` and `--version` as an error with exit code 0.
        Err(told) => {
            let printed = told.print();
            let code = u8::try_from(told.exit_code()).unwrap_or(failure::MODEL);
            return match printed {
                // Requested text that does not fit on a full disk is an error; a reader that has stopped is not.
                Err(why) if code == 0 && why.kind() != ErrorKind::BrokenPipe => {
                    tell!("standard output cannot be written: {why}");
                    failure::INPUT_OUTPUT
                }
                _ => code,
            };
        }
    };
    failure::draw_as_the_terminal_can();
    let outcome = std::panic::catch_unwind(|| dispatch(&arguments.command, program));
    match outcome {
        Ok(Ok(())) => 0,
        Ok(Err(failure)) => {
            failure.report();
            failure.exit_code()
        }
        Err(_) => {
            tell!(
                "This is a bug in wythe, not in your model. Please report it with the lines above \
                 and the model."
            );
            failure::BUG
        }
    }
}

/// Path of the program of this process. Where the system has a link to it, the link is used: it leads to the same
/// program after its file was replaced.
fn this_program() -> OsString {
    let link = Path::new("/proc/self/exe");
    if link.exists() {
        return link.into();
    }
    std::env::current_exe().map_or_else(|_| "wythe".into(), Into::into)
}

fn dispatch(command: &Command, program: &[OsString]) -> Result<(), Failure> {
    match command {
        Command::Run(arguments) => run::run(arguments),
        Command::New(arguments) => new::new(arguments),
        Command::Resume(arguments) => resume::resume(arguments),
        Command::Check(arguments) => check::check(arguments),
        Command::Limit(arguments) => limit::limit(arguments),
        Command::Schema => schema::schema(),
        Command::Drive(arguments) => drive::drive(arguments),
        Command::Salvage(arguments) => salvage::salvage(arguments),
        Command::Report(arguments) => report::report(arguments),
        Command::View(arguments) => view::view(arguments),
        Command::Plot(arguments) => plot::plot(arguments),
        Command::Animate(arguments) => plot::animate(arguments),
        Command::Compare(arguments) => compare::compare(arguments),
        Command::Calibrate(_) => Err(Failure::Model(miette::miette!(
            help = "pip install 'wythe[study]' brings a `wythe` command that has it: docs/how-to/calibrate-parameters.md",
            "calibrate needs SciPy and is part of the Python package"
        ))),
        Command::Evaluate(arguments) => evaluate::evaluate(arguments),
        Command::Info(arguments) => info::info(arguments),
        Command::Export(arguments) => export::export(arguments),
        Command::Modes(arguments) => modes::modes(arguments),
        Command::Study(arguments) => study::command::study(arguments, program),
        Command::Completions(arguments) => shell::completions(arguments),
        Command::Man(arguments) => shell::man(arguments),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn code(arguments: &[&str]) -> u8 {
        command(arguments.iter().map(Into::into))
    }

    #[test]
    fn the_command_may_be_called_more_than_once() {
        assert_eq!(code(&["wythe", "new", "--list"]), 0);
        assert_eq!(code(&["wythe", "new", "--list"]), 0);
        assert_eq!(code(&["wythe", "--version"]), 0);
        assert_eq!(code(&["wythe"]), 2);
        assert_eq!(code(&["wythe", "check", "--nonsense"]), 2);
        assert_eq!(code(&["wythe", "check", "no/such.toml"]), 4);
    }
}
