//! `/model`: description of the model.

use hdf5_metno as hdf5;
use hdf5_metno::types::VarLenUnicode;
use sha2::{Digest as _, Sha256};

use super::series::unicode;
use crate::model::Model;

/// Group of the model in the file.
pub const MODEL: &str = "model";
/// Name of the deck's text in that group.
pub const DECK: &str = "deck";

/// Name of the names of the units in that group.
pub const UNITS: &str = "units";

/// Writes title, version and the names of materials and units into a new group.
///
/// # Errors
/// The file cannot be written.
pub fn write(file: &hdf5::File, model: &Model) -> hdf5::Result<()> {
    let group = file.create_group(MODEL)?;
    attribute(&group, "version", env!("CARGO_PKG_VERSION"))?;
    attribute(&group, "title", &model.title)?;
    let names = model.materials.iter().map(|m| unicode(&m.name));
    let names = names.collect::<hdf5::Result<Vec<_>>>()?;
    let materials = group.new_attr::<VarLenUnicode>().shape(names.len());
    materials.create("materials")?.write(&names)?;
    let count = model.mesh.unit.iter().max().map_or(0, |last| last + 1);
    let names = (0..count).map(|unit| unicode(&model.mesh.called(unit)));
    let names = names.collect::<hdf5::Result<Vec<_>>>()?;
    let units = group.new_dataset::<VarLenUnicode>().shape(names.len());
    units.create(UNITS)?.write(&names)
}

/// Writes the deck and its hash, and replaces an existing one.
///
/// # Errors
/// The file cannot be written.
pub fn write_deck(file: &hdf5::File, text: &str) -> hdf5::Result<()> {
    let group = file.group(MODEL)?;
    if group.link_exists(DECK) {
        group.unlink(DECK)?;
    }
    let deck = group
        .new_dataset::<VarLenUnicode>()
        .shape(())
        .create(DECK)?;
    deck.write_scalar(&unicode(text)?)?;
    attribute(&group, "hash", &hash(text))
}

/// Hash of the deck's text, the same on every machine.
pub fn hash(text: &str) -> String {
    format!("sha256:{:x}", Sha256::digest(text))
}

/// Writes or replaces an attribute.
fn attribute(group: &hdf5::Group, name: &str, text: &str) -> hdf5::Result<()> {
    let there = group.attr_names()?.iter().any(|n| n == name);
    let attribute = if there {
        group.attr(name)?
    } else {
        group.new_attr::<VarLenUnicode>().shape(()).create(name)?
    };
    attribute.write_scalar(&unicode(text)?)
}
