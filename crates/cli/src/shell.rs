//! `wythe completions` and `wythe man`: completion scripts of shells and manual pages.

use std::path::Path;

use clap::CommandFactory;
use wythe_core::error::IoError;
use wythe_core::files::write_whole;

use crate::arguments::{Arguments, Completions, Man};
use crate::failure::Failure;
use crate::say::print_bytes;

/// Prints the completion script for a shell.
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

/// Prints the manual page of the command, or writes the pages of all sub-commands into a folder.
pub fn man(arguments: &Man) -> Result<(), Failure> {
    let command = Arguments::command();
    let Some(folder) = &arguments.out else {
        let mut page = Vec::new();
        let rendered = clap_mangen::Man::new(command).render(&mut page);
        rendered.map_err(unwritable(Path::new("standard output")))?;
        return print_bytes(&page);
    };
    std::fs::create_dir_all(folder).map_err(unwritable(folder))?;
    let mut command = command.disable_help_subcommand(true);
    command.build();
    pages(&command, folder).map_err(Failure::from)
}

/// Writes the pages of a command and of its sub-commands.
fn pages(command: &clap::Command, folder: &Path) -> Result<(), IoError> {
    for part in command.get_subcommands().filter(|it| !it.is_hide_set()) {
        pages(part, folder)?;
    }
    let man = clap_mangen::Man::new(command.clone());
    let (path, mut page) = (folder.join(man.get_filename()), Vec::new());
    let rendered = man.render(&mut page);
    rendered
        .and_then(|()| write_whole(&path, &page))
        .map_err(unwritable(&path))
}

fn unwritable(path: &Path) -> impl FnOnce(std::io::Error) -> IoError + '_ {
    move |why| IoError {
        path: path.to_owned(),
        why,
    }
}
