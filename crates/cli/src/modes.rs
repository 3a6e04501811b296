//! `wythe modes`: natural frequencies and shapes of a model or of a run.

use std::path::{Path, PathBuf};

use wythe_core::deck::Deck;
use wythe_core::model::Model;
use wythe_core::results::FrameChoice;
use wythe_core::results::modes::{FoundModes, ModesError, SHAPES, TABLE};
use wythe_core::results::output::spare_inputs;

use crate::arguments::Modes;
use crate::failure::Failure;
use crate::say::print;

/// Finds the modes, writes their files and prints the figures.
pub fn modes(arguments: &Modes) -> Result<(), Failure> {
    let path = &arguments.path;
    let count = arguments.count.get();
    let (found, out) = if path.is_dir() {
        if !arguments.with.overrides().is_empty() {
            return Err(Failure::Model(miette::miette!(
                help = "--set applies to a model: name its TOML file",
                "{} is a folder of results, whose model cannot be changed",
                path.display()
            )));
        }
        let choice = arguments.frame.unwrap_or(FrameChoice::Last);
        (FoundModes::of_run(path, choice, count)?, path.join("modes"))
    } else {
        if arguments.frame.is_some() {
            return Err(Failure::Model(miette::miette!(
                help = "name the folder of a run",
                "--frame: {} is a model, which is at rest",
                path.display()
            )));
        }
        let deck = Deck::load(path, &arguments.with.overrides())?;
        let (model, _) = Model::from_deck(&deck)?;
        let out = out_of(arguments, path);
        spare_inputs(&out, [TABLE, SHAPES], &deck.inputs())?;
        (FoundModes::of_model(model, count)?, out)
    };
    let out = arguments.out.clone().unwrap_or(out);
    let written = found.write(&out)?;
    if arguments.json {
        let json = serde_json::to_string_pretty(&found.table()).map_err(|error| {
            Failure::InputOutput(miette::Report::msg(format!("no JSON: {error}")))
        })?;
        return print(&format!("{json}\n"));
    }
    let files = written.iter().map(|path| format!("{}\n", path.display()));
    print(&format!("{}{}", found.text(), files.collect::<String>()))
}

/// Folder of the files: that of the command, or MODEL.modes beside the model.
fn out_of(arguments: &Modes, path: &Path) -> PathBuf {
    let beside = || path.with_extension("modes");
    arguments.out.clone().unwrap_or_else(beside)
}

impl From<ModesError> for Failure {
    fn from(error: ModesError) -> Self {
        match error {
            ModesError::Read(error) => error.into(),
            ModesError::Deck(error) => error.into(),
            error @ ModesError::NoDeck(_) => Self::input_output(error),
            error @ ModesError::Vibration(_) => Self::model(error),
        }
    }
}
