//! `wythe salvage`: adds the end and the index to the message file of an interrupted run.

use wythe_core::results::mcap::salvage::{SalvageError, salvage as rescue};

use crate::arguments::Salvage;
use crate::failure::Failure;
use crate::say::print;
use crate::terminal::count;

/// Rewrites the file and prints a summary of its content.
pub fn salvage(arguments: &Salvage) -> Result<(), Failure> {
    let found = rescue(&arguments.file, arguments.out.as_deref())?;
    let target = arguments.out.as_ref().unwrap_or(&arguments.file);
    let mut text = format!(
        "{}: {}, {}",
        target.display(),
        count(found.messages as usize, "message"),
        count(found.attachments as usize, "attachment")
    );
    if found.was_whole {
        text += "; it was whole";
    }
    if found.lost_bytes > 0 {
        let lost = count(found.lost_bytes as usize, "byte");
        text += &format!("; left out {lost} after the last whole record");
    }
    print(&(text + "\n"))
}

impl From<SalvageError> for Failure {
    fn from(error: SalvageError) -> Self {
        Self::input_output(error)
    }
}
