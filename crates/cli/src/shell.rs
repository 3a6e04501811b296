//! `wythe completions` and `wythe man`: what shells and manuals want to know of the command.

use std::path::Path;

use clap::CommandFactory;
use wythe_core::error::IoError;

use crate::arguments::{Arguments, Completions, Man};
use crate::failure::Failure;
use crate::say::print_bytes;

/// Prints the completions for a shell.
pub fn completions(arguments: &Completions) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(
        arguments.shell,
        &mut Arguments::command(),
        "wythe",
        &mut script,
    );
    print_bytes(&script)
}

/// Prints the manual page of the command, or writes those of all sub-commands into a folder.
pub fn man(arguments: &Man) -> Result<(), Failure> {
    let command = Arguments::command();
    let Some(folder) = &arguments.out else {
        let mut page = Vec::new();
        let rendered = clap_mangen::Man::new(command).render(&mut page);
        rendered.map_err(unwritable(Path::new("standard output")))?;
        return print_bytes(&page);
    };
    std::fs::create_dir_all(folder).map_err(unwritable(folder))?;
    clap_mangen::generate_to(command, folder).map_err(|why| unwritable(folder)(why).into())
}

fn unwritable(path: &Path) -> impl FnOnce(std::io::Error) -> IoError + '_ {
    move |why| IoError {
        path: path.to_owned(),
        why,
    }
}
