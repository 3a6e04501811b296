//! `wythe new`: writes a commented deck that runs as it is.

use std::path::{Path, PathBuf};

use wythe_core::command::argument;
use wythe_core::deck::import::{ImportedMesh, Units};
use wythe_core::deck::json_schema;
use wythe_core::deck::templates;
use wythe_core::deck::templates::{SCHEMA, TEMPLATES};
use wythe_core::error::IoError;
use wythe_core::files::{write_out, write_whole};

use crate::arguments::New;
use crate::failure::Failure;
use crate::say::print;

/// Lists the templates, or writes a deck from a template or around a mesh.
pub fn new(arguments: &New) -> Result<(), Failure> {
    let Some(name) = arguments.name.as_ref().filter(|_| !arguments.list) else {
        let lines = TEMPLATES.iter();
        let lines = lines.map(|t| format!("{:14}{}\n", t.name, t.about));
        return print(&lines.collect::<String>());
    };
    let path = deck_of(name);
    let folder = path.parent().unwrap_or(Path::new(""));
    let text = match &arguments.from {
        Some(mesh) => around(mesh, &path, folder, &arguments.units)?,
        // clap has checked the name.
        None => templates::find(&arguments.template)
            .map_or("", |t| t.text)
            .to_owned(),
    };
    if !folder.as_os_str().is_empty() {
        std::fs::create_dir_all(folder).map_err(unwritable(folder))?;
    }
    write(&path, &text, arguments.force)?;
    // The schema there may be of another version of wythe, so it is always replaced.
    let beside = folder.join(SCHEMA);
    write_whole(&beside, json_schema::text().as_bytes()).map_err(unwritable(&beside))?;
    let typed = argument(&path);
    print(&format!(
        "{} and, for editors, {} are written\nnext: {}wythe check {typed}, then wythe run {typed}\n",
        path.display(),
        beside.display(),
        if arguments.from.is_some() {
            "fill in the places marked in it, then "
        } else {
            ""
        }
    ))
}

/// Text of a deck around an imported mesh.
fn around(mesh: &Path, deck: &Path, folder: &Path, units: &str) -> Result<String, Failure> {
    let wrong =
        |message: String, help: String| Failure::Model(miette::miette!(help = help, "{message}"));
    let units_of = Units::parse(units).map_err(|why| {
        wrong(
            why,
            "--units \"N, m, s\": of force, length and time".to_owned(),
        )
    })?;
    let read = ImportedMesh::load(mesh, &units_of).and_then(|read| read.check().map(|()| read));
    let read = read.map_err(|error| wrong(error.to_string(), error.help.clone()))?;
    // Paths in a deck are relative to its folder.
    let file = mesh
        .strip_prefix(folder)
        .unwrap_or(mesh)
        .display()
        .to_string();
    let name = deck.file_stem().unwrap_or_default().to_string_lossy();
    read.as_deck(&name.replace('.', "-"), &file, units)
        .map_err(|why| wrong(format!("{file}: {why}"), "mend the file first".to_owned()))
}

/// Adds `.toml` to the name if it is missing.
fn deck_of(name: &Path) -> PathBuf {
    if name.extension().is_some_and(|e| e == "toml") {
        return name.to_owned();
    }
    let mut name = name.as_os_str().to_owned();
    name.push(".toml");
    name.into()
}

fn unwritable(path: &Path) -> impl FnOnce(std::io::Error) -> Failure + '_ {
    move |why| {
        let path = path.to_owned();
        IoError { path, why }.into()
    }
}

/// Writes a new file; replaces an existing one only with `force`.
fn write(path: &Path, text: &str, force: bool) -> Result<(), Failure> {
    // A broken link exists too.
    if !force && path.symlink_metadata().is_ok() {
        return Err(Failure::InputOutput(miette::miette!(
            help = "take another name, or say --force to overwrite it",
            "{} is there already",
            path.display()
        )));
    }
    write_out(path, text.as_bytes()).map_err(unwritable(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ending_is_added_once() {
        let deck = |name: &str| deck_of(Path::new(name)).display().to_string();
        assert_eq!(deck("wall"), "wall.toml");
        assert_eq!(deck("wall.toml"), "wall.toml");
        assert_eq!(deck("wall.v2"), "wall.v2.toml");
    }
}
