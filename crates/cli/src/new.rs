//! `wythe new`: a commented deck that runs as it is.

use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use wythe_core::error::IoError;

use crate::arguments::New;
use crate::check::print;
use crate::failure::Failure;

/// A deck to begin with.
pub struct Template {
    /// By which it is asked for.
    pub name: &'static str,
    /// One line.
    pub about: &'static str,
    /// The deck.
    pub text: &'static str,
}

/// All templates.
pub const TEMPLATES: [Template; 6] = [
    Template {
        name: "couplet",
        about: "two bricks and the joint between them, pulled apart",
        text: include_str!("templates/couplet.toml"),
    },
    Template {
        name: "shear-wall",
        about: "a wall pressed and pushed in its plane until it has cracked and crushed",
        text: include_str!("templates/shear-wall.toml"),
    },
    Template {
        name: "out-of-plane",
        about: "a strip of wall pushed out of its plane under its load",
        text: include_str!("templates/out-of-plane.toml"),
    },
    Template {
        name: "arch",
        about: "a semicircle of dry voussoirs under its weight, tilted",
        text: include_str!("templates/arch.toml"),
    },
    Template {
        name: "dry-wall",
        about: "dry blocks in running bond on a tilting table",
        text: include_str!("templates/dry-wall.toml"),
    },
    Template {
        name: "column",
        about: "a column of loose blocks, struck: sliding and rocking in time",
        text: include_str!("templates/column.toml"),
    },
];

/// Their names.
pub const NAMES: [&str; TEMPLATES.len()] = {
    let mut names = [""; TEMPLATES.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = TEMPLATES[i].name;
        i += 1;
    }
    names
};

/// By this name the templates call the schema, which stands beside them.
const SCHEMA: &str = "deck.schema.json";

/// Lists the templates, or writes one of them.
pub fn new(arguments: &New) -> Result<(), Failure> {
    let Some(name) = arguments.name.as_ref().filter(|_| !arguments.list) else {
        let lines = TEMPLATES.map(|t| format!("{:14}{}\n", t.name, t.about));
        return print(&lines.concat());
    };
    // clap has seen that it is one of them.
    let template = TEMPLATES.iter().find(|t| t.name == arguments.template);
    let text = template.map_or("", |t| t.text);
    let path = deck_of(name);
    let folder = path.parent().unwrap_or(Path::new(""));
    if !folder.as_os_str().is_empty() {
        std::fs::create_dir_all(folder).map_err(unwritable(folder))?;
    }
    let mut file = open(&path, arguments.force)?;
    file.write_all(text.as_bytes()).map_err(unwritable(&path))?;
    // Another version of wythe may have written the one that is there.
    let schema = folder.join(SCHEMA);
    std::fs::write(&schema, wythe_core::model::schema::text()).map_err(unwritable(&schema))?;
    let path = path.display();
    print(&format!(
        "{path} and, for editors, {} are written\nnext: wythe check {path}, then wythe run {path}\n",
        schema.display()
    ))
}

/// NAME.toml, whether the name has the ending or not.
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

/// A new file; an old one only by force.
fn open(path: &Path, force: bool) -> Result<File, Failure> {
    let mut options = OpenOptions::new();
    options.write(true);
    let opened = if force {
        options.create(true).truncate(true).open(path)
    } else {
        options.create_new(true).open(path)
    };
    opened.map_err(|why| match why.kind() {
        ErrorKind::AlreadyExists => Failure::InputOutput(miette::miette!(
            help = "take another name, or say --force to overwrite it",
            "{} is there already",
            path.display()
        )),
        _ => unwritable(path)(why),
    })
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

    #[test]
    fn templates_name_the_schema_and_are_ascii_but_for_their_drawings() {
        for template in TEMPLATES {
            let first = format!("#:schema ./{SCHEMA}\n");
            assert!(template.text.starts_with(&first), "{}", template.name);
            let keys = template.text.lines().filter(|line| !line.starts_with('#'));
            assert!(keys.into_iter().all(str::is_ascii), "{}", template.name);
        }
    }
}
