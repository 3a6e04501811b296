//! The deck as written in TOML, with units converted and ranges checked.
//!
//! The structures here mirror the file for serde; `docs/reference/deck.md` explains every key.

mod arch;
mod beams;
mod blocks;
mod bounds;
mod floors;
mod form;
mod grid;
mod ground;
mod heading;
mod imports;
mod inputs;
mod interfaces;
mod joint_kinds;
mod layers;
mod loads;
mod materials;
mod output;
mod probes;
mod procedure;
pub mod registry;
mod resumed;
mod rows;
mod sections;
mod settlements;
mod stand_in;
mod steps;
mod strategy;
mod symmetry;
mod test;
mod ties;
pub(super) mod validate;
mod wall;

pub use crate::model::axis::Axis;
pub use crate::model::probes::ProbeQuantity;
pub use arch::DeckArch;
pub use beams::{DeckBeam, Turning};
pub use blocks::{DeckBlock, DeckContact, DeckSpring, DeckSupport, Names, NotConvex, Rotation};
pub use bounds::MOST_BYTES;
pub use floors::DeckFloor;
pub use heading::Heading;
pub use imports::DeckImport;
pub use interfaces::{Interface, Scatter};
pub use joint_kinds::JointKind;
pub use layers::{DeckLayer, Lattice};
pub use loads::{DeckAmplitude, DeckCycles, DeckLoad};
pub use materials::{Material, Row};
pub use probes::{DeckPlace, DeckProbe};
pub use procedure::{
    DeckControl, DeckGround, DeckGroundFactor, DeckProcedure, DeckRayleigh, DeckStop,
};
pub use registry::SolidKind;
pub use resumed::DeckChange;
pub use sections::DeckSection;
pub use settlements::{DeckProfile, DeckSettlement, DeckTilt, DeckTrough};
pub use steps::{DeckIncrements, DeckStep, DeckTolerance, Direction, StepKind, Vertical};
pub use strategy::{DeckSimplified, Strategy};
pub use symmetry::{DeckSymmetry, Keep};
pub use test::{DeckTest, TestKind};
pub use ties::{DeckTie, TieBond};
pub use wall::{
    Bond, Clamped, Clamping, Corners, DeckCourse, DeckLeaf, DeckLintel, DeckOpening, FilledFrom,
    Subdivision, Wall,
};

use super::catalogue::{self, Assumption};
use super::overrides;
use super::quantity::Length;
use super::source::Source;
use super::wall_defaults;
use crate::deck::strategy::derive;
use crate::element::Formulation;
use crate::error::{DeckError, ErrorKind, Errors, IoError, MOST_ERRORS, ModelError, printable};
use crate::input;
use crate::material::MaterialParameters;
use crate::model::scene::{ContactPoints, Fidelity, Output};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_with::skip_serializing_none;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use toml::de::DeTable;
use wythe_contact::InterfaceLaw;

/// A deck: the whole of a model file.
#[skip_serializing_none]
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
// More than 15 fields: one for each table of the deck.
pub struct Deck {
    /// Version of the format: 1.
    #[schemars(range(min = 1, max = 1))]
    pub format: u32,
    /// Title; the name of the file if absent.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub title: String,
    /// Extent of the computation: with reductions, in full, or with elastic solids.
    #[serde(default)]
    pub fidelity: Fidelity,
    /// Strategy with which walls are modelled.
    #[serde(default, skip_serializing_if = "Strategy::is_detailed")]
    pub strategy: Strategy,
    /// Values of the strategies `simplified` and `rigid` that would otherwise follow from materials and joints.
    pub simplified: Option<DeckSimplified>,
    /// Materials by name.
    #[serde(default)]
    pub materials: BTreeMap<String, Material>,
    /// Interfaces by name.
    #[serde(default)]
    pub interfaces: BTreeMap<String, Interface>,
    /// The wall. A deck without a scene serves only to drive single points.
    pub wall: Option<Wall>,
    /// Further walls, by name.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub walls: Vec<Wall>,
    /// Single blocks.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub blocks: Vec<DeckBlock>,
    /// Meshes of other programs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub imports: Vec<DeckImport>,
    /// An arch of voussoirs.
    pub arch: Option<DeckArch>,
    /// Contact between faces of blocks.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub contacts: Vec<DeckContact>,
    /// Blocks and faces that are held.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub supports: Vec<DeckSupport>,
    /// Springs to the ground.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub springs: Vec<DeckSpring>,
    /// Ground that settles.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub settlements: Vec<DeckSettlement>,
    /// Ties: rods and bars.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ties: Vec<DeckTie>,
    /// Floors that load and tie walls.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub floors: Vec<DeckFloor>,
    /// Loading beams.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub beams: Vec<DeckBeam>,
    /// Layers on faces.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub layers: Vec<DeckLayer>,
    /// Planes of symmetry.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub symmetry: Vec<DeckSymmetry>,
    /// Quantities recorded in the history.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub probes: Vec<DeckProbe>,
    /// Sections whose resultants are recorded in the history.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sections: Vec<DeckSection>,
    /// Element formulation.
    #[serde(default)]
    pub element: Element,
    /// Contact sampling.
    #[serde(default)]
    pub contact: Contact,
    /// Steps, in order.
    #[serde(default)]
    pub steps: Vec<DeckStep>,
    /// Output of fields and scenes.
    #[serde(default)]
    pub output: DeckOutput,
    /// Standard test that the deck models, for its evaluation.
    pub test: Option<DeckTest>,
    #[serde(skip)]
    source: Source,
    /// What named materials and joints take from the catalogue.
    #[serde(skip)]
    pub(super) assumed: Vec<Assumption>,
    /// Values that the strategy derived from the deck, in words.
    #[serde(skip)]
    pub(super) derived: Vec<String>,
    /// Paths and messages of warnings about these values.
    #[serde(skip)]
    pub(super) cautions: Vec<(String, String)>,
}

/// Schema of a table that has a `name` of the catalogue, or all its required keys.
fn named_or_whole(schema: &mut schemars::Schema) {
    if let Some(required) = schema.remove("required") {
        let choices = serde_json::json!([{ "required": ["name"] }, { "required": required }]);
        schema.insert("anyOf".to_owned(), choices);
    }
}

/// `[element]`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Element {
    /// Interpolation of strain in the hex8.
    pub formulation: Formulation,
}

/// `[contact]`.
#[skip_serializing_none]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Contact {
    /// Positions of the contact points on a slave facet.
    pub points: ContactPoints,
    /// Number of parts along x, y and z into which a slave facet is divided, each with its own points.
    pub parts: [u32; 3],
    /// Largest distance between a point and its master facet [mm]; chosen by the solver if absent.
    pub search_radius: Option<Length>,
    /// Dry interface of contact between any faces of different bodies; if absent, only paired faces are in contact.
    pub general: Option<String>,
}

impl Default for Contact {
    fn default() -> Self {
        Self {
            points: ContactPoints::default(),
            parts: [1; 3],
            search_radius: None,
            general: None,
        }
    }
}

/// `[output]`.
#[skip_serializing_none]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct DeckOutput {
    /// Number of increments between frames of fields; the increment of the largest force and the last one
    /// always have a frame.
    pub every: usize,
    /// Whether `run.mcap` is written.
    pub mcap: bool,
    /// Number of frames of fields between scenes in `run.mcap`.
    pub scene_every: usize,
    /// Measured load-displacement curve: a CSV file in the folder of the deck.
    pub experiment: Option<String>,
}

impl Default for DeckOutput {
    fn default() -> Self {
        let own = Output::default();
        Self {
            every: own.every,
            mcap: own.mcap,
            scene_every: own.scene_every,
            experiment: None,
        }
    }
}

impl Deck {
    /// Reads a deck from a text. `file` is its name in errors.
    ///
    /// # Errors
    /// Syntax, unknown or missing keys, wrong types and units, values out of range, unknown names: all errors that
    /// can be found, in the order of the text.
    pub fn from_str(text: &str, file: &str) -> Result<Self, ModelError> {
        Self::from_str_with(text, file, &[])
    }

    /// Reads a deck from a text and then sets the keys of `overrides` (dotted path, value).
    ///
    /// A value is TOML, or else a string (`2.12 MPa` needs no quotes). An override of one of `u_k` and `G_I`, or of
    /// `delta_k` and `G_II`, replaces either.
    ///
    /// # Errors
    /// As [`Deck::from_str`]; errors about an override name it.
    pub fn from_str_with(
        text: &str,
        file: &str,
        overrides: &[(String, String)],
    ) -> Result<Self, ModelError> {
        bounds::judge_text(file, text)?;
        let mut source = Source::new(file, text);
        let padded: Vec<(usize, String)> = overrides
            .iter()
            .map(|(key, value)| {
                let start = source.append_override(key, value);
                (start, overrides::padded(value, start))
            })
            .collect();
        let (mut root, syntax) = DeTable::parse_recoverable(text);
        // One error per line is enough: further ones on the same line follow from the first. Their number is
        // limited.
        let mut syntax = syntax;
        syntax.dedup_by_key(|error| error.span().map(|span| source.line_of(span.start)));
        syntax.truncate(MOST_ERRORS);
        let mut errors: Vec<ModelError> = syntax.iter().map(|e| source.syntax_error(e)).collect();
        let no_toml: Vec<_> = errors.iter().map(ModelError::line).collect();
        for (i, ((key, _), (start, padded))) in overrides.iter().zip(&padded).enumerate() {
            let excluded = overrides::excluded(&overrides[..=i]).map(|other| {
                format!(
                    "`{other}` is set as well, and the keys exclude each other: set one of them"
                )
            });
            let set = bounds::judge_path(key).and_then(|()| excluded.map_or(Ok(()), Err));
            let set = set.and_then(|()| {
                let value = overrides::parse(padded, *start);
                overrides::set(root.get_mut(), key, source.override_key(i).start, value)
            });
            errors.extend(set.err().map(|why| source.override_error(i, why)));
        }
        bounds::judge_keys(&source, root.get_ref())?;
        source.locate(root.get_ref());
        let filled = catalogue::fill(&source, root.get_mut());
        let form = form::read(&mut source, root, no_toml.is_empty());
        let misread = form.errors.into_iter().chain(filled.errors);
        errors.extend(misread.filter(|error| !no_toml.contains(&error.line())));
        if let Some(mut deck) = form.deck {
            deck.source = source;
            deck.assumed = filled.assumed;
            deck.write_defaults(file);
            if no_toml.is_empty() {
                errors.extend(validate::validate(&deck, &form.broken));
            }
            if errors.is_empty() {
                derive(&mut deck);
                wall_defaults::choose(&mut deck);
                return Ok(deck);
            }
        }
        let nothing = || ModelError::new((file, text), None, "", "the deck cannot be read", "");
        let mut all = Errors::default();
        for error in errors {
            all.push(error);
        }
        Err(all.end(()).err().unwrap_or_else(nothing))
    }

    /// Writes the defaults that depend on other values: the title, after the file, and the crack bands.
    fn write_defaults(&mut self, file: &str) {
        self.title = printable(std::mem::take(&mut self.title));
        if self.title.is_empty() {
            self.title = Path::new(file)
                .file_stem()
                .unwrap_or_default()
                .to_string_lossy()
                .into();
        }
        for material in self.materials.values_mut() {
            if material.has_bands() {
                material.crack_band = Some(material.band());
            }
        }
    }

    /// Reads the deck in the file `path`, then sets the keys of `overrides`.
    ///
    /// # Errors
    /// [`DeckError::Io`] if the file cannot be read, else as [`Deck::from_str_with`].
    pub fn load(path: impl AsRef<Path>, overrides: &[(String, String)]) -> Result<Self, DeckError> {
        let path = path.as_ref();
        let text = input::text(path, MOST_BYTES as u64).map_err(|why| IoError {
            path: path.to_owned(),
            why,
        })?;
        Ok(Self::from_str_with(
            &text,
            &path.display().to_string(),
            overrides,
        )?)
    }

    /// Sets the folder to which file names in the deck are relative, wherever the deck itself lies.
    #[must_use]
    pub fn in_folder(mut self, folder: PathBuf) -> Self {
        self.source.folder = Some(folder);
        self
    }

    /// The folder to which file names in the deck are relative.
    pub fn folder(&self) -> &Path {
        let beside = || Path::new(&self.source.file).parent();
        let folder = self.source.folder.as_deref().or_else(beside);
        folder.unwrap_or(Path::new(""))
    }

    /// The deck as TOML, in base units and with every default written out.
    ///
    /// # Errors
    /// None are expected from a deck that was read.
    pub fn to_toml(&self) -> Result<String, toml::ser::Error> {
        toml::to_string(self)
    }

    /// Parameters of the material `name`, with its tables as given.
    ///
    /// # Errors
    /// Unknown material.
    pub fn material(&self, name: &str) -> Result<MaterialParameters, ModelError> {
        match self.materials.get(name) {
            Some(material) => Ok(material.parameters()),
            None => Err(self.unknown("materials", "material", name, "materials")),
        }
    }

    /// The law of the interface `name` at a single point.
    ///
    /// A point has no neighbouring elements from which stiffnesses follow: both must be explicit. It belongs to no
    /// unit: strengths that scatter have their mean.
    ///
    /// # Errors
    /// Unknown interface, or stiffnesses that are not given.
    pub fn interface(&self, name: &str) -> Result<InterfaceLaw, ModelError> {
        let Some(interface) = self.interfaces.get(name) else {
            return Err(self.unknown("interfaces", "interface", name, "interfaces"));
        };
        match (interface.normal_stiffness, interface.shear_stiffness) {
            (Some(normal), Some(shear)) => Ok(interface.law(normal.get(), shear.get())),
            _ => Err(self.error(
                &format!("interfaces.{name}"),
                "a single point needs explicit stiffnesses: a penalty factor multiplies the stiffness \
                 of elements, and here are none",
                "give both, e.g. normal_stiffness = 34000 and shear_stiffness = 14783 (N/mm^3), here \
                 or by --set",
            )),
        }
    }

    /// What named materials and joints take from the catalogue.
    pub fn assumed(&self) -> &[Assumption] {
        &self.assumed
    }

    /// An error about the key `path` of this deck.
    pub fn error(&self, path: &str, message: impl Into<String>, help: &str) -> ModelError {
        self.source.error(path, message, help)
    }

    /// A warning about the key `path` of this deck.
    pub fn warning(&self, path: &str, message: impl Into<String>) -> crate::error::Warning {
        self.source.warning(path, message)
    }

    /// Returns whether the key `path` is written, in the file or in an override.
    pub(super) fn says(&self, path: &str) -> bool {
        self.source.has(path)
    }

    /// Returns whether the table `path` is not in the file: it stands for another key.
    pub(super) fn is_generated(&self, path: &str) -> bool {
        self.source.said(path) != path
    }

    /// Errors and warnings at `path` or below refer to the key `from`: the file has no such table.
    pub(super) fn stands_for(&mut self, path: String, from: String) {
        self.source.stands_for(path, from);
    }

    /// The key of the file to which a path belongs.
    pub(super) fn said<'a>(&'a self, path: &'a str) -> &'a str {
        self.source.said(path)
    }

    /// Returns whether the scene has blocks, imported bodies or an arch.
    pub fn has_blocks(&self) -> bool {
        !self.blocks.is_empty() || !self.imports.is_empty() || self.arch.is_some()
    }

    /// Returns whether the deck has any body: a wall, a block, an arch or an imported mesh.
    pub fn has_scene(&self) -> bool {
        self.has_blocks() || self.has_walls()
    }

    /// Returns whether the scene has walls.
    pub fn has_walls(&self) -> bool {
        self.wall.is_some() || !self.walls.is_empty()
    }

    /// The walls, with their paths in the deck and their names.
    pub fn walls(&self) -> impl Iterator<Item = (String, &str, &Wall)> {
        let one = self.wall.iter().map(|wall| ("wall".to_owned(), wall));
        let more = self.walls.iter().enumerate();
        one.chain(more.map(|(i, wall)| (format!("walls.{i}"), wall)))
            .map(|(path, wall)| (path, wall.name.as_deref().unwrap_or("wall"), wall))
    }

    /// The wall at a path of [`Deck::walls`].
    pub(super) fn wall_mut(&mut self, path: &str) -> Option<&mut Wall> {
        match path.strip_prefix("walls.") {
            Some(i) => self.walls.get_mut(i.parse::<usize>().ok()?),
            None => self.wall.as_mut(),
        }
    }

    /// Clamped courses of `[wall]`, if there is such a wall and it is clamped.
    pub fn clamped(&self) -> Option<Clamped> {
        match self.wall.as_ref()?.clamped {
            Clamping::Unsaid => Some(Clamped::default()),
            Clamping::Nothing => None,
            Clamping::Courses(clamped) => Some(clamped),
        }
    }

    /// An error: `path` refers to `name`, but `[table.name]` does not exist.
    fn unknown(&self, path: &str, kind: &str, name: &str, table: &str) -> ModelError {
        let names: Vec<&str> = if table == "materials" {
            self.materials.keys().map(String::as_str).collect()
        } else {
            self.interfaces.keys().map(String::as_str).collect()
        };
        let help = match crate::deck::keys::nearest(name, names.iter().copied()) {
            Some(near) => format!("did you mean `{near}`?"),
            None if names.is_empty() => format!("add a table [{table}.{name}]"),
            None => format!("the deck has {}; or add [{table}.{name}]", names.join(", ")),
        };
        let error = self.error(path, format!("there is no {kind} named `{name}`"), &help);
        error.of_kind(ErrorKind::UnknownName)
    }
}

impl Deck {
    /// All values, which are equal in equal decks.
    fn values(&self) -> impl PartialEq + '_ {
        let Self {
            format,
            title,
            fidelity,
            strategy,
            simplified,
            materials,
            interfaces,
            wall,
            walls,
            blocks,
            imports,
            arch,
            contacts,
            supports,
            springs,
            settlements,
            ties,
            floors,
            beams,
            layers,
            symmetry,
            probes,
            sections,
            element,
            contact,
            steps,
            output,
            test,
            source: _,
            assumed: _,
            derived: _,
            cautions: _,
        } = self;
        (
            (format, title, fidelity, strategy, simplified),
            (materials, interfaces, element, contact, contacts),
            (wall, walls, blocks, imports, arch),
            (supports, springs, settlements),
            (ties, floors, beams, layers, symmetry),
            (probes, sections, steps, output, test),
        )
    }
}

/// Two decks are equal if their values are equal, wherever and however they are written.
impl PartialEq for Deck {
    fn eq(&self, other: &Self) -> bool {
        self.values() == other.values()
    }
}
