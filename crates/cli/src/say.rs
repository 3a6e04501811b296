//! Output of the command: messages on standard error, requested results on standard output.
//!
//! Either may be impossible to write: the reader has stopped (`2>&1 | head`), the disk is full, the terminal was
//! closed. Messages on standard error are then lost and the work continues. Output on standard output is a result
//! like any other: a full disk is an error there, a reader that has stopped is not.

use std::fmt::{Arguments, Display};
use std::io::{self, ErrorKind, Write};

use crate::failure::Failure;

/// Prints a line on standard error. Unlike `eprintln!` it does not end the process if that fails.
macro_rules! tell {
    ($($words:tt)*) => { $crate::say::line(format_args!($($words)*)) };
}
pub(crate) use tell;

/// Writes a line to standard error; see [`tell`].
pub fn line(words: Arguments) {
    text(&format_args!("{words}\n"));
}

/// Writes to standard error in one call, so that lines of several processes do not mix.
pub fn text(words: &dyn Display) {
    // There is no channel left to report a failure.
    let _ = io::stderr().lock().write_all(words.to_string().as_bytes());
}

/// Writes to standard output; a reader that has stopped is not an error.
///
/// # Errors
/// The disk is full, or the terminal was closed.
pub fn print(text: &str) -> Result<(), Failure> {
    print_bytes(text.as_bytes())
}

/// Writes bytes to standard output, as [`print`] does.
///
/// # Errors
/// Those of [`print`].
pub fn print_bytes(bytes: &[u8]) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Failure::InputOutput(
            miette::Report::msg(format!("standard output cannot be written: {error}")),
        )),
        _ => Ok(()),
    }
}
