//! What the command says: on standard error for people, on standard output what was asked for.
//!
//! Nobody may be there to hear it: a reader that has had enough (`2>&1 | head`), a log on a full disk, a terminal
//! that was closed. What is said on standard error is then lost and the work goes on. What was asked for on
//! standard output is a result like any other: a full disk is an error there, a reader that has gone is none.

use std::fmt::{Arguments, Display};
use std::io::{self, ErrorKind, Write};

use crate::failure::Failure;

/// A line on standard error, as `eprintln!`, which would end the process if it cannot be written.
macro_rules! tell {
    ($($words:tt)*) => { $crate::say::line(format_args!($($words)*)) };
}
pub(crate) use tell;

/// Writes a line to standard error; see [`tell`].
pub fn line(words: Arguments) {
    text(&format_args!("{words}\n"));
}

/// Writes to standard error as it is, in one call, so that lines of several processes do not mix.
pub fn text(words: &dyn Display) {
    // There is nobody left who could be told that it failed.
    let _ = io::stderr().lock().write_all(words.to_string().as_bytes());
}

/// Writes to standard output; a reader that has had enough is no error.
///
/// # Errors
/// The disk is full, or the terminal was closed.
pub fn print(text: &str) -> Result<(), Failure> {
    print_bytes(text.as_bytes())
}

/// As [`print`], for bytes.
///
/// # Errors
/// As there.
pub fn print_bytes(bytes: &[u8]) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Failure::InputOutput(
            miette::Report::msg(format!("standard output cannot be written: {error}")),
        )),
        _ => Ok(()),
    }
}
