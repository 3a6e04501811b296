//! Contents of an `.inp` before its names are resolved.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::deck::import::{ImportedMaterial, Place};

/// A node: label and coordinates in the units of the file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub(super) label: u64,
    pub(super) x: [f64; 3],
    pub(super) place: Place,
}

/// A hexahedron: label and labels of its nodes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Element {
    pub(super) label: u64,
    pub(super) nodes: [u64; 8],
    pub(super) place: Place,
}

/// A member of a set as written.
#[derive(Clone, Debug)]
pub(super) enum Member {
    /// A label.
    Label(u64),
    /// First, last, step.
    Range([u64; 3]),
    /// A set of the same kind, or `INSTANCE.SET`, or `INSTANCE.LABEL`.
    Name(String),
    /// The nodes of a set of elements.
    NodesOf(String),
}

/// One definition of a set; several definitions of one name are united.
#[derive(Clone, Debug)]
pub(super) struct Set {
    pub(super) name: String,
    /// Instance to which the labels belong, in an assembly.
    pub(super) instance: Option<String>,
    pub(super) members: Vec<Member>,
    pub(super) place: Place,
}

/// A surface: sets or labels, each with a side of its elements.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    pub(super) name: String,
    /// Whether it consists of nodes instead of sides of elements.
    pub(super) of_nodes: bool,
    /// Members, each with its side in capitals as written; none: the exterior sides. Elements of other types have
    /// sides of other names.
    pub(super) members: Vec<(Member, Option<String>, Place)>,
}

/// An element of a type that is not read.
#[derive(Clone, Debug)]
pub(super) struct Other {
    /// Type in capitals.
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

/// Contents of a part, of an instance, or of a file without either.
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

impl Scope {
    /// Sets of nodes, or of elements.
    pub(super) fn sets(&mut self, of_nodes: bool) -> &mut Vec<Set> {
        if of_nodes {
            &mut self.node_sets
        } else {
            &mut self.element_sets
        }
    }
}

/// An instance of a part in the assembly.
#[derive(Clone, Debug)]
pub(super) struct Instance {
    pub(super) name: String,
    pub(super) part: String,
    /// Data lines: a translation; an axis and an angle.
    pub(super) moves: Vec<Vec<f64>>,
    /// Definitions that belong to the instance alone.
    pub(super) own: Scope,
    pub(super) place: Place,
}

/// Contents of a file.
#[derive(Clone, Debug, Default)]
pub(super) struct Raw {
    /// Parts by their name in capitals.
    pub(super) parts: BTreeMap<String, Scope>,
    pub(super) instances: Vec<Instance>,
    /// The assembly, or all of a file without parts.
    pub(super) scope: Scope,
    pub(super) materials: Vec<ImportedMaterial>,
    /// Element types, and the number of elements of each.
    pub(super) types: BTreeMap<String, usize>,
    /// Keywords that were not read, with the place of the first of each.
    pub(super) skipped: BTreeMap<String, Place>,
    /// Number of hexahedra with more than eight node labels, and the place of the first.
    pub(super) long: Option<(usize, Place)>,
}
