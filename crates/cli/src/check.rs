//! `wythe check`: is this model what its author means?

use std::io::Write;

use wythe_core::model::{Deck, Model};

use crate::arguments::Check;
use crate::failure::Failure;

/// Reads and builds the model, and prints what follows from it.
pub fn check(arguments: &Check) -> Result<(), Failure> {
    let deck = Deck::load(&arguments.model, &arguments.with.overrides)?;
    let (model, _) = Model::from_deck(&deck)?;
    let report = wythe_core::model::check(&deck, &model);
    print(&report.to_string())
}

/// Writes to standard output; a reader that has had enough is no error.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(Failure::InputOutput(
            miette::Report::msg(format!("standard output cannot be written: {error}")),
        )),
        _ => Ok(()),
    }
}
