//! Failures of the command and their exit codes.

use crate::study::StudyError;
use miette::{Diagnostic, Report};
use wythe_core::error::{DeckError, IoError, ModelError};
use wythe_core::results::{ExperimentError, OutputError, ReadError, ResumeError};
use wythe_core::solve::RunError;

use crate::say::tell;
use crate::unicode;

/// Exit code of a bug in wythe.
pub const BUG: u8 = 1;
/// Exit code of a wrong model or usage.
pub const MODEL: u8 = 2;
const NOT_CONVERGED: u8 = 3;
/// Exit code of a file that cannot be read or written.
pub const INPUT_OUTPUT: u8 = 4;
/// Exit code of an interrupted run: 128 + SIGINT, the convention of shells.
pub const INTERRUPTED: u8 = 130;

/// Reason why the command does not end with 0.
#[derive(Debug)]
pub enum Failure {
    /// The model, the path of a point or the usage is wrong.
    Model(Report),
    /// The model is wrong; the errors were printed already.
    ToldModel,
    /// Equilibrium, or the response of a stress-driven point, was not found; all results before it are kept.
    NotConverged(Report),
    /// A file could not be read or written.
    InputOutput(Report),
    /// The user stopped the run; all results before are kept.
    Interrupted,
}

impl Failure {
    /// Failure by a wrong model or usage.
    pub fn model(error: impl Diagnostic + Send + Sync + 'static) -> Self {
        Self::Model(Report::new(error))
    }

    /// Failure by a file that could not be read or written.
    pub fn input_output(error: impl Diagnostic + Send + Sync + 'static) -> Self {
        Self::InputOutput(Report::new(error))
    }

    /// The exit code of the command.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Model(_) | Self::ToldModel => MODEL,
            Self::NotConverged(_) => NOT_CONVERGED,
            Self::InputOutput(_) => INPUT_OUTPUT,
            Self::Interrupted => INTERRUPTED,
        }
    }

    /// Message and advice as plain text.
    pub fn in_words(&self) -> (String, String) {
        match self {
            Self::Model(report) | Self::NotConverged(report) | Self::InputOutput(report) => {
                let help = report
                    .help()
                    .map_or_else(String::new, |help| help.to_string());
                (report.to_string(), help)
            }
            Self::ToldModel => ("the model is wrong".to_owned(), String::new()),
            Self::Interrupted => ("interrupted".to_owned(), String::new()),
        }
    }

    /// Prints the failure on standard error.
    pub fn report(&self) {
        match self {
            Self::Model(report) | Self::NotConverged(report) | Self::InputOutput(report) => {
                tell!("{report:?}");
            }
            Self::ToldModel | Self::Interrupted => {}
        }
    }
}

/// Sets reports to ASCII where the locale is not UTF-8, and without colours where NO_COLOR is set.
pub fn draw_as_the_terminal_can() {
    // If the command is called again, the hook of the first call stays.
    let _ = miette::set_hook(Box::new(|_| {
        let options = miette::MietteHandlerOpts::new().unicode(unicode::is_on());
        let options = if unicode::colours() {
            options
        } else {
            options.color(false)
        };
        Box::new(options.build())
    }));
}

impl From<ModelError> for Failure {
    fn from(error: ModelError) -> Self {
        Self::model(error)
    }
}

impl From<IoError> for Failure {
    fn from(error: IoError) -> Self {
        Self::input_output(error)
    }
}

impl From<DeckError> for Failure {
    fn from(error: DeckError) -> Self {
        match error {
            DeckError::Io(error) => error.into(),
            DeckError::Model(error) => error.into(),
        }
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        Self::input_output(error)
    }
}

impl From<ReadError> for Failure {
    fn from(error: ReadError) -> Self {
        match error {
            ReadError::NoFrame { .. }
            | ReadError::NoColumn { .. }
            | ReadError::NoSection { .. }
            | ReadError::Undrawn(_) => Self::model(error),
            error => Self::input_output(error),
        }
    }
}

impl From<ExperimentError> for Failure {
    fn from(error: ExperimentError) -> Self {
        match error {
            ExperimentError::Read { .. } => Self::input_output(error),
            ExperimentError::Content { .. } => Self::model(error),
        }
    }
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        match error {
            // The recorder's error comes back wrapped; unwrapped, it names the file.
            RunError::Output(error) => match error.downcast::<OutputError>() {
                Ok(error) => error.into(),
                Err(error) => Self::InputOutput(Report::msg(format!(
                    "results could not be written: {error}"
                ))),
            },
            RunError::Bulk(error) => Self::Model(miette::miette!(
                help = "see the sizes in [wall], wall.mesh and the tables of the material",
                "{error}"
            )),
            RunError::Checkpoint(error) => Self::Model(miette::miette!(
                help = "begin anew with `wythe run`",
                "{error}"
            )),
            RunError::JointLaw { .. } => Self::Model(miette::miette!(
                help = "check the law by `wythe_contact::checks`",
                "{error}"
            )),
            RunError::LimitOnly => Self::Model(miette::miette!(
                help = "call `wythe limit`, or take another strategy",
                "{error}"
            )),
            RunError::NoMass { .. } => Self::Model(miette::miette!(
                help = "write it like this: density = \"1900 kg/m^3\"",
                "{error}"
            )),
        }
    }
}

impl From<ResumeError> for Failure {
    fn from(error: ResumeError) -> Self {
        match error {
            ResumeError::Output(error) => error.into(),
            ResumeError::Deck(error) => error.into(),
            ResumeError::Changed { .. } | ResumeError::OtherModel { .. } => Self::model(error),
            error => Self::input_output(error),
        }
    }
}

impl From<StudyError> for Failure {
    fn from(error: StudyError) -> Self {
        match error {
            StudyError::Case(error) => error.into(),
            StudyError::Io(error) => error.into(),
            StudyError::Deck(error) => error.into(),
            error => Self::model(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io;

    #[test]
    fn an_output_error_comes_back_out_of_the_solver_with_its_file() {
        let why = io::Error::from(io::ErrorKind::StorageFull);
        let error = OutputError::Write {
            path: "wall.out/history.csv".into(),
            why,
        };
        let failure = Failure::from(RunError::Output(io::Error::from(error)));
        assert_eq!(failure.exit_code(), 4);
        let Failure::InputOutput(report) = failure else {
            panic!("{failure:?}")
        };
        assert!(
            report.to_string().contains("wall.out/history.csv"),
            "{report}"
        );
        assert!(report.help().is_some());
    }
}
