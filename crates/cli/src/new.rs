//! `wythe new`: writes a commented deck that runs as it is.

use std::path::{Path, PathBuf};

use wythe_core::command::argument;
use wythe_core::deck::import::{ImportedMesh, Units};
use wythe_core::deck::json_schema;
use wythe_core::deck::schema::MOST_BYTES;
use wythe_core::deck::specimens::{self, Options, SpecimenDeck, SpecimenError, TESTS};
use wythe_core::deck::templates;
use wythe_core::deck::templates::{SCHEMA, TEMPLATES};
use wythe_core::error::IoError;
use wythe_core::files::{read_text, write_out, write_whole};

use crate::arguments::New;
use crate::failure::Failure;
use crate::say::print;

/// Lists the templates, or writes a deck from a template or around a mesh.
pub fn new(arguments: &New) -> Result<(), Failure> {
    let Some(name) = arguments.name.as_ref().filter(|_| !arguments.list) else {
        return print(&list());
    };
    if let Some(test) = &arguments.test {
        return of_test(test, name, arguments);
    }
    let path = deck_of(name);
    let folder = path.parent().unwrap_or(Path::new(""));
    let text = match &arguments.from {
        Some(mesh) => around(mesh, &path, folder, &arguments.units)?,
        // clap has checked the name.
        None => templates::find(&arguments.template)
            .map_or("", |t| t.text)
            .to_owned(),
    };
    let beside = write_decks(folder, &[(path.clone(), text)], arguments.force)?;
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

/// Names and descriptions of templates and standard tests.
fn list() -> String {
    let templates = TEMPLATES
        .iter()
        .map(|t| format!("  {:30}{}\n", t.name, t.about));
    let tests = TESTS
        .iter()
        .map(|t| format!("  {:30}{}\n", t.name, t.about));
    let (templates, tests): (String, String) = (templates.collect(), tests.collect());
    format!("--template\n{templates}--test\n{tests}")
}

/// Writes the decks of a standard test: NAME.toml, or NAME-PART.toml if there are several.
fn of_test(test: &str, name: &Path, arguments: &New) -> Result<(), Failure> {
    let said = &arguments.specimen;
    let materials = said.materials.as_deref().map(read_materials).transpose()?;
    let options = Options {
        unit: said.unit.clone(),
        joint: said.joint.clone(),
        precompression: said.precompression.clone(),
        size: said.size.clone(),
        materials,
    };
    let wrong = |why: SpecimenError| {
        let message = match &said.materials {
            Some(file) if why.option == "--materials" => {
                format!("{} {}: {}", why.option, file.display(), why.message)
            }
            _ => why.to_string(),
        };
        Failure::Model(miette::miette!(help = why.help, "{message}"))
    };
    // clap has checked the name.
    let decks = specimens::find(test).map_or(Ok(Vec::new()), |test| test.decks(&options));
    let decks = decks.map_err(wrong)?;
    let whole = deck_of(name);
    let folder = whole.parent().unwrap_or(Path::new(""));
    let stem = whole
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    let named = |deck: SpecimenDeck| {
        let path = match deck.part.as_str() {
            "" => whole.clone(),
            part => folder.join(format!("{stem}-{part}.toml")),
        };
        (path, deck.text)
    };
    let decks: Vec<(PathBuf, String)> = decks.into_iter().map(named).collect();
    write_decks(folder, &decks, arguments.force)?;
    let paths: Vec<&PathBuf> = decks.iter().map(|(path, _)| path).collect();
    let mut said: String = paths
        .iter()
        .map(|path| format!("{} is written\n", path.display()))
        .collect();
    said += "next:\n";
    for path in &paths {
        said += &format!("  wythe run {}\n", argument(path));
    }
    let folders: Vec<String> = paths
        .iter()
        .map(|path| argument(&path.with_extension("out")))
        .collect();
    said += &format!("  wythe evaluate {}\n", folders.join(" "));
    print(&said)
}

/// Text of a file of materials.
fn read_materials(path: &Path) -> Result<String, Failure> {
    let text = read_text(path, MOST_BYTES as u64);
    text.map_err(of_file(path))
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

fn of_file(path: &Path) -> impl FnOnce(std::io::Error) -> Failure + '_ {
    move |why| {
        let path = path.to_owned();
        IoError { path, why }.into()
    }
}

/// Writes decks and the schema beside them, all or none; replaces existing decks only with `force`. Returns the path of
/// the schema.
fn write_decks(
    folder: &Path,
    decks: &[(PathBuf, String)],
    force: bool,
) -> Result<PathBuf, Failure> {
    // A broken link exists too.
    let is_there = |(path, _): &&(PathBuf, String)| path.symlink_metadata().is_ok();
    if let Some((path, _)) = decks.iter().find(is_there).filter(|_| !force) {
        return Err(Failure::InputOutput(miette::miette!(
            help = "take another name, or say --force to overwrite it",
            "{} is there already",
            path.display()
        )));
    }
    if !folder.as_os_str().is_empty() {
        std::fs::create_dir_all(folder).map_err(of_file(folder))?;
    }
    for (path, text) in decks {
        write_out(path, text.as_bytes()).map_err(of_file(path))?;
    }
    // The schema there may be of another version of wythe, so it is always replaced.
    let beside = folder.join(SCHEMA);
    write_whole(&beside, json_schema::text().as_bytes()).map_err(of_file(&beside))?;
    Ok(beside)
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
