//! `wythe export`: writes a run, or a model that was not run, for other programs.

use std::path::{Path, PathBuf};

use wythe_core::deck::Deck;
use wythe_core::model::Model;
use wythe_core::results::export::{frame_name, inp, shells, table, vtu};
use wythe_core::results::output::{DECK, spare_inputs};
use wythe_core::results::snapshot::Snapshots;
use wythe_core::results::{FrameChoice, RunFolder, Snapshot};

use crate::arguments::{Export, Format, Frames};
use crate::failure::Failure;
use crate::plot::write;
use crate::say::print;

/// Name of the file that lists all frames.
const SERIES: &str = "series.pvd";

/// Writes the files and prints their names.
pub fn export(arguments: &Export) -> Result<(), Failure> {
    if arguments.folder.is_file() {
        return scene(&arguments.folder, arguments);
    }
    if !arguments.with.overrides().is_empty() {
        return Err(Failure::Model(miette::miette!(
            help = "--set applies to a model: name its TOML file",
            "{} is a folder of results, whose model cannot be changed",
            arguments.folder.display()
        )));
    }
    let folder = RunFolder::open(&arguments.folder)?;
    let out = match &arguments.out {
        Some(out) => out.clone(),
        None => arguments.folder.join("export"),
    };
    let mut written: Vec<PathBuf> = Vec::new();
    if is_at_rest(arguments.to) {
        let (files, inputs) = model(&folder, arguments)?;
        spare_inputs(&out, files.iter().map(|(name, _)| *name), &inputs)?;
        for (name, text) in files {
            written.push(write(&out, name, text.as_bytes())?);
        }
    } else {
        let snapshots = Snapshots::open(&folder)?;
        let frames = match arguments.frame.unwrap_or(Frames::One(FrameChoice::Last)) {
            Frames::All => (0..snapshots.count()).map(FrameChoice::Number).collect(),
            Frames::One(choice) => vec![choice],
        };
        let mut series = Vec::new();
        for choice in frames {
            let snapshot = snapshots.at(choice)?;
            for (rest, text) in files(arguments.to, &snapshot) {
                let name = frame_name(snapshot.number, rest);
                written.push(write(&out, &name, text.as_bytes())?);
            }
            let solids = frame_name(snapshot.number, ".vtu");
            series.push((snapshot.frame.time, solids));
        }
        if arguments.to == Format::Vtu && arguments.frame == Some(Frames::All) {
            let text = vtu::collection(&series);
            written.push(write(&out, SERIES, text.as_bytes())?);
        }
    }
    tell(&written)
}

fn tell(written: &[PathBuf]) -> Result<(), Failure> {
    let lines = written.iter().map(|p| format!("{}\n", p.display()));
    print(&lines.collect::<String>())
}

/// Writes a model at rest, without a run.
fn scene(path: &Path, arguments: &Export) -> Result<(), Failure> {
    if arguments.frame.is_some() || arguments.to == Format::Csv {
        return Err(Failure::Model(miette::miette!(
            help = "name the folder of a run for frames and tables; of a model there are inp, vtu, obj, ply and stl",
            "{} is a model: nothing has moved yet",
            path.display()
        )));
    }
    let deck = Deck::load(path, &arguments.with.overrides())?;
    let (model, _) = Model::from_deck(&deck)?;
    let out = match &arguments.out {
        Some(out) => out.clone(),
        None => path.with_extension("export"),
    };
    let files = at_rest(arguments.to, &model);
    let names: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
    spare_inputs(&out, names, &deck.inputs())?;
    let mut written = Vec::new();
    for (name, text) in files {
        written.push(write(&out, name, text.as_bytes())?);
    }
    tell(&written)
}

/// Whether a format has a model at rest, and no frames.
fn is_at_rest(format: Format) -> bool {
    !matches!(format, Format::Vtu | Format::Csv)
}

/// Files of a model at rest.
fn at_rest(format: Format, model: &Model) -> ModelFiles {
    match format {
        Format::Vtu => vec![
            ("model.vtu", vtu::model(model)),
            ("model_surfaces.vtu", vtu::surfaces(model)),
        ],
        Format::Obj => vec![("model.obj", shells::obj(&model.mesh))],
        Format::Ply => vec![("model.ply", shells::ply(&model.mesh))],
        Format::Stl => vec![("model.stl", shells::stl(&model.mesh))],
        Format::Inp | Format::Csv => vec![("model.inp", inp::inp(model))],
    }
}

/// Files of a model: names and texts.
type ModelFiles = Vec<(&'static str, String)>;

/// Files of a frame: suffix of the name, and text.
fn files(format: Format, snapshot: &Snapshot) -> Vec<(&'static str, String)> {
    let joined = !snapshot.surface.quads.is_empty();
    let mut files = match format {
        Format::Vtu => vec![(".vtu", vtu::solids(snapshot))],
        _ => vec![
            ("_nodes.csv", table::nodes(snapshot)),
            ("_elements.csv", table::elements(snapshot)),
        ],
    };
    if joined {
        files.push(match format {
            Format::Vtu => ("_interfaces.vtu", vtu::interfaces(snapshot)),
            _ => ("_interfaces.csv", table::interfaces(snapshot)),
        });
    }
    files
}

/// Files of the model at rest in the folder's deck, and the input files of the model.
fn model(folder: &RunFolder, arguments: &Export) -> Result<(ModelFiles, Vec<PathBuf>), Failure> {
    if arguments.frame.is_some() {
        return Err(Failure::Model(miette::miette!(
            help = "leave --frame out; deformed shapes are in --to vtu and --to csv",
            "{} writes the model at rest, no frame of it",
            format!("--to {:?}", arguments.to).to_lowercase()
        )));
    }
    if folder.deck()?.is_none() {
        return Err(Failure::InputOutput(miette::miette!(
            help = "run the model again: `wythe run` keeps a copy of its deck there",
            "{}: there is no {DECK}, from which sets and materials come",
            folder.path().display()
        )));
    }
    let deck = folder.place(Deck::load(folder.path().join(DECK), &[])?);
    let (model, _) = Model::from_deck(&deck)?;
    Ok((at_rest(arguments.to, &model), deck.inputs()))
}
