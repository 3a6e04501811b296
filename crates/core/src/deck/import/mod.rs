//! Meshes of other programs, read into one plain type: Abaqus `.inp` and Gmsh `.msh`.
//!
//! Files are read here and checked in [`ImportedMesh::check`]; `imported` gives the mesh its place, materials and
//! bodies in a deck. Files are not trusted: labels may be missing or duplicate, sets may name unknown members, a
//! file may include itself.

mod as_deck;
mod check;
mod facets;
mod included;
mod inp;
mod material;
mod msh;
mod names;
pub(in crate::deck) mod numbers;
mod units;

pub(in crate::deck) use check::has_volume;
pub(in crate::deck) use facets::root;
pub use facets::{Bodies, SIDES};
pub use included::included;
pub use material::{ImportedMaterial, Lengths, Measure, Softening};
pub use names::find;
pub use units::Units;

use crate::error::printable;
use crate::input;
use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

/// A mesh of hex8 as a file describes it, in N, mm, MPa, tonne, s.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImportedMesh {
    /// The file and those that it includes.
    pub files: Vec<String>,
    /// Coordinates [mm]; instances are at their place in the assembly. `[node][xyz]`
    pub nodes: Vec<[f64; 3]>,
    /// Labels of the nodes in the file, unique within an instance. `[node]`
    pub node_labels: Vec<u64>,
    /// Connectivity in the order of [`CORNERS`](crate::element::hex8::CORNERS). `[element][local node]`
    pub elements: Vec<[u32; 8]>,
    /// Labels of the elements in the file, unique within an instance. `[element]`
    pub element_labels: Vec<u64>,
    /// Position of each element in the files. `[element]`
    pub element_places: Vec<Place>,
    /// Index into `instances`; none in a file without parts. `[element]`
    pub element_instance: Vec<Option<u16>>,
    /// Names of the instances of an assembly.
    pub instances: Vec<String>,
    /// Sets of nodes by name; those of an instance are `INSTANCE.SET`.
    pub node_sets: BTreeMap<String, Vec<u32>>,
    /// Sets of elements by name.
    pub element_sets: BTreeMap<String, Vec<u32>>,
    /// Surfaces by name: elements and their sides, an index of [`SIDES`].
    pub surfaces: BTreeMap<String, Vec<(u32, u8)>>,
    /// Materials in the order in which they are written.
    pub materials: Vec<ImportedMaterial>,
    /// Materials of sets of elements.
    pub sections: Vec<Section>,
    /// Number of elements of each type that was left out.
    pub left_out: BTreeMap<String, usize>,
    /// Notes for the author: data that was not read or was read with another meaning.
    pub notes: Vec<String>,
}

/// Elements of a material.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Name of the set of elements.
    pub set: String,
    /// Its elements.
    pub elements: Vec<u32>,
    /// Name of the material.
    pub material: String,
    /// Position in the file.
    pub place: Place,
}

/// A line of a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// Index into [`ImportedMesh::files`].
    pub file: u32,
    /// Line from 1; 0 in a binary file, which has none.
    pub line: u32,
}

/// A file that is no mesh, or a mesh that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ImportError {
    /// The file.
    pub file: String,
    /// Line from 1; none in a binary file, or if it concerns the file as a whole.
    pub line: Option<usize>,
    /// Description of the error: element, set or keyword, and its position.
    pub message: String,
    /// Advice how to correct it.
    pub help: String,
}

impl fmt::Display for ImportError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "{} line {line}: {}", self.file, self.message),
            None => write!(f, "{}: {}", self.file, self.message),
        }
    }
}

impl std::error::Error for ImportError {}

/// An error before the names of the files are attached.
#[derive(Clone, Debug)]
struct Wrong {
    place: Place,
    message: String,
    help: String,
}

impl Wrong {
    fn new(place: Place, message: impl Into<String>, help: impl Into<String>) -> Self {
        let (message, help) = (printable(message.into()), printable(help.into()));
        Self {
            place,
            message,
            help,
        }
    }

    fn of(self, files: &[String]) -> ImportError {
        ImportError {
            file: files
                .get(self.place.file as usize)
                .cloned()
                .unwrap_or_default(),
            line: (self.place.line > 0).then_some(self.place.line as usize),
            message: self.message,
            help: self.help,
        }
    }
}

/// Largest number of elements: more cannot be factorised on common machines.
const MOST_ELEMENTS: usize = 10_000_000;

/// Largest number of nodes: ten million elements have at most eight each.
const MOST_NODES: usize = 80_000_000;

/// Returns the contents of a file by its name, as another file writes it.
pub type Loader<'a> = &'a mut dyn FnMut(&str) -> std::io::Result<Vec<u8>>;

impl ImportedMesh {
    /// Reads the file at `path`, an `.inp` or a `.msh` by its extension, and the files that it includes from the
    /// same folder.
    ///
    /// # Errors
    /// A file that cannot be read, has another extension or contains errors: line, element, position and advice.
    pub fn load(path: &Path, units: &Units) -> Result<Self, ImportError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let bytes = input::bytes(path, input::MOST_OF_MESH).map_err(|why| ImportError {
            file: path.display().to_string(),
            line: None,
            message: why.to_string(),
            help: "name a mesh: a file of Abaqus (.inp) or Gmsh (.msh)".to_owned(),
        })?;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        // All included files together share this limit.
        let mut left = input::MOST_OF_MESH - bytes.len() as u64;
        Self::read(&name, &bytes, units, &mut |name| {
            let bytes = input::bytes(&folder.join(name), left)?;
            left -= bytes.len() as u64;
            Ok(bytes)
        })
    }

    /// Reads a mesh from the contents of a file. `load` returns the contents of the files that it includes.
    ///
    /// # Errors
    /// As [`ImportedMesh::load`].
    pub fn read(
        name: &str,
        bytes: &[u8],
        units: &Units,
        load: Loader<'_>,
    ) -> Result<Self, ImportError> {
        let ending = Path::new(name)
            .extension()
            .map(|e| e.to_string_lossy().to_lowercase());
        let mut mesh = match ending.as_deref() {
            Some("inp") => inp::read(name, bytes, load)?,
            Some("msh") => msh::read(name, bytes)?,
            _ => {
                return Err(ImportError {
                    file: name.to_owned(),
                    line: None,
                    message: "neither an .inp of Abaqus nor a .msh of Gmsh".to_owned(),
                    help: "the ending says which: wall.inp, wall.msh".to_owned(),
                });
            }
        };
        mesh.scale(units);
        mesh.note_folded();
        Ok(mesh)
    }

    /// Converts the units of the file to those of wythe.
    fn scale(&mut self, units: &Units) {
        for x in &mut self.nodes {
            *x = x.map(|x| x * units.length);
        }
        for material in &mut self.materials {
            material.scale(units);
        }
    }

    /// An error about element `e`: its label, instance and position in space.
    pub(crate) fn wrong_element(
        &self,
        e: usize,
        message: &str,
        help: impl Into<String>,
    ) -> ImportError {
        let message = format!("{} {message}", self.name_of(e));
        Wrong::new(self.element_places[e], message, help).of(&self.files)
    }

    /// Name of an element, such as `element 7 of Part-1-1 near (10, 20, 5) mm`.
    pub(crate) fn name_of(&self, e: usize) -> String {
        let label = self.element_labels[e];
        let instance = self.element_instance[e]
            .and_then(|i| self.instances.get(usize::from(i)))
            .map_or(String::new(), |name| format!(" of {name}"));
        let middle = [0, 1, 2].map(|d| {
            let sum: f64 = self.elements[e]
                .iter()
                .map(|&n| self.nodes[n as usize][d])
                .sum();
            sum / 8.0
        });
        format!("element {label}{instance} near {}", point(middle))
    }
}

/// Formats a point to a thousandth, such as `(10, 20, 5) mm`.
fn point(x: [f64; 3]) -> String {
    let [x, y, z] = x.map(|x| (x * 1e3).round() / 1e3 + 0.0);
    format!("({x}, {y}, {z}) mm")
}
