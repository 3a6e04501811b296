//! What an `.inp` says before its names are looked up.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::deck::import::{ImportedMaterial, Place};

/// A node: label, coordinates in the units of the file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub(super) label: u64,
    pub(super) x: [f64; 3],
    pub(super) place: Place,
}

/// A hexahedron: label, labels of its nodes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Element {
    pub(super) label: u64,
    pub(super) nodes: [u64; 8],
    pub(super) place: Place,
}

/// A member of a set as it is written.
#[derive(Clone, Debug)]
pub(super) enum Member {
    /// A label.
    Label(u64),
    /// From, to, step.
    Range([u64; 3]),
    /// A set of the same kind, or `INSTANCE.SET`, or `INSTANCE.LABEL`.
    Name(String),
    /// The nodes of a set of elements.
    NodesOf(String),
}

/// One definition of a set; several of one name add up.
#[derive(Clone, Debug)]
pub(super) struct Set {
    pub(super) name: String,
    /// Instance whose labels are meant, in an assembly.
    pub(super) instance: Option<String>,
    pub(super) members: Vec<Member>,
    pub(super) place: Place,
}

/// A surface: sets or labels, with a side of their elements each.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    pub(super) name: String,
    /// Made of nodes, not of sides of elements.
    pub(super) of_nodes: bool,
    /// The side as it is written, in capitals; none: what is outside. Elements that are not read have sides of other names.
    pub(super) members: Vec<(Member, Option<String>, Place)>,
}

/// An element of a type that is not read.
#[derive(Clone, Debug)]
pub(super) struct Other {
    /// Its type, in capitals.
    pub(super) kind: Arc<str>,
    pub(super) label: u64,
    /// Labels of its nodes.
    pub(super) nodes: Vec<u64>,
    pub(super) place: Place,
}

/// A solid section.
#[derive(Clone, Debug)]
pub(super) struct SolidSection {
    pub(super) set: String,
    pub(super) material: String,
    pub(super) place: Place,
}

/// What a part, an instance, or a file without them holds.
#[derive(Clone, Debug, Default)]
pub(super) struct Scope {
    pub(super) nodes: Vec<Node>,
    pub(super) elements: Vec<Element>,
    pub(super) others: Vec<Other>,
    pub(super) node_sets: Vec<Set>,
    pub(super) element_sets: Vec<Set>,
    pub(super) surfaces: Vec<Surface>,
    pub(super) sections: Vec<SolidSection>,
}

/// A part that stands in the assembly.
#[derive(Clone, Debug)]
pub(super) struct Instance {
    pub(super) name: String,
    pub(super) part: String,
    /// Lines of data: a translation, an axis and an angle.
    pub(super) moves: Vec<Vec<f64>>,
    /// What is said of it alone.
    pub(super) own: Scope,
    pub(super) place: Place,
}

/// A whole file.
#[derive(Clone, Debug, Default)]
pub(super) struct Raw {
    /// By name, in capitals.
    pub(super) parts: BTreeMap<String, Scope>,
    pub(super) instances: Vec<Instance>,
    /// The assembly, or all of a flat file.
    pub(super) scope: Scope,
    pub(super) materials: Vec<ImportedMaterial>,
    /// Types of elements and how many there are.
    pub(super) types: BTreeMap<String, usize>,
    /// Keywords that were not read, and where the first of each is.
    pub(super) skipped: BTreeMap<String, Place>,
    /// Hexahedra with more labels on their line than those of eight nodes, and where the first is.
    pub(super) long: Option<(usize, Place)>,
}
