//! Collects the data of the sections and builds the mesh.

use std::collections::{BTreeMap, HashMap};

use super::cursor::Cursor;
use crate::deck::import::{ImportedMesh, Place, SIDES, Wrong, point};

/// Gmsh element types.
const QUADRANGLE: i64 = 3;
const HEXAHEDRON: i64 = 5;
/// Types of solids other than hexahedra of first order.
const OTHER_SOLIDS: [i64; 15] = [4, 6, 7, 11, 12, 13, 14, 17, 18, 19, 29, 30, 31, 92, 93];
/// Types of surfaces.
const OTHER_FACES: [i64; 10] = [2, 9, 10, 16, 20, 21, 22, 23, 24, 25];

/// Nodes, elements and groups of a file.
#[derive(Default)]
pub(super) struct Gathered {
    /// Names of physical groups by dimension and tag.
    pub(super) names: BTreeMap<(i64, i64), String>,
    /// Groups of an entity by its dimension and tag.
    pub(super) groups: HashMap<(i64, i64), Vec<i64>>,
    /// Coordinates. `[node][xyz]`
    pub(super) nodes: Vec<[f64; 3]>,
    labels: Vec<u64>,
    index: HashMap<u64, u32>,
    hexahedra: Vec<[u32; 8]>,
    hexahedron_labels: Vec<u64>,
    hexahedron_places: Vec<Place>,
    /// Hexahedra by their nodes: version 2 writes an element once for each of its groups.
    known: HashMap<[u32; 8], u32>,
    /// Elements of groups of volumes.
    volumes: BTreeMap<i64, Vec<u32>>,
    /// Corners, label and position of each quadrangle of groups of surfaces.
    quadrangles: BTreeMap<i64, Vec<([u32; 4], u64, Place)>>,
    /// Nodes of groups of curves and points, by dimension and group.
    curves: BTreeMap<(i64, i64), Vec<u32>>,
    others: usize,
}

/// An element of a file.
pub(super) struct Element<'a> {
    /// Type.
    pub(super) kind: i64,
    pub(super) tag: u64,
    /// Labels of its nodes.
    pub(super) nodes: &'a [u64],
    pub(super) place: Place,
}

impl Gathered {
    /// Number of elements so far.
    pub(super) fn count(&self) -> usize {
        self.hexahedra.len() + self.others
    }

    pub(super) fn node(&mut self, tag: u64, x: [f64; 3], cursor: &Cursor<'_>) -> Result<(), Wrong> {
        let index = self.nodes.len() as u32;
        if self.index.insert(tag, index).is_some() {
            return Err(cursor.wrong(
                format!("node {tag} is there twice"),
                "the file is damaged: save it again",
            ));
        }
        self.nodes.push(x);
        self.labels.push(tag);
        Ok(())
    }

    /// Adds an element: a hexahedron, or an element of lower dimension that is in a group.
    pub(super) fn element(
        &mut self,
        Element {
            kind,
            tag,
            nodes,
            place,
        }: Element<'_>,
        groups: &[i64],
    ) -> Result<(), Wrong> {
        let mut found = [0; 125];
        for (index, node) in found.iter_mut().zip(nodes) {
            *index = *self.index.get(node).ok_or_else(|| {
                Wrong::new(
                    place,
                    format!("element {tag} names the node {node}, which is not there"),
                    "nodes come before elements; the file may be damaged: save it again",
                )
            })?;
        }
        let nodes = &found[..nodes.len()];
        if let Ok(hexahedron) = <[u32; 8]>::try_from(nodes)
            && kind == HEXAHEDRON
        {
            let e = *self.known.entry(hexahedron).or_insert_with(|| {
                self.hexahedra.push(hexahedron);
                self.hexahedron_labels.push(tag);
                self.hexahedron_places.push(place);
                self.hexahedra.len() as u32 - 1
            });
            for group in groups {
                self.volumes.entry(*group).or_default().push(e);
            }
            return Ok(());
        }
        self.others += 1;
        if OTHER_SOLIDS.contains(&kind) || (!groups.is_empty() && OTHER_FACES.contains(&kind)) {
            let near = self.middle(nodes);
            let what = if OTHER_SOLIDS.contains(&kind) {
                "a hexahedron of eight nodes"
            } else {
                "a quadrangle of four nodes"
            };
            return Err(Wrong::new(
                place,
                format!("element {tag} near {near} is of the type {kind}, not {what}"),
                "recombine to hexahedra of first order (transfinite or extruded volumes; \
                 Mesh.SubdivisionAlgorithm = 2)",
            ));
        }
        for group in groups {
            match <[u32; 4]>::try_from(nodes) {
                Ok(corners) if kind == QUADRANGLE => {
                    let of = self.quadrangles.entry(*group).or_default();
                    of.push((corners, tag, place));
                }
                _ => {
                    let dimension = i64::from(kind != 15);
                    let of = self.curves.entry((dimension, *group)).or_default();
                    of.extend(nodes);
                }
            }
        }
        Ok(())
    }

    fn middle(&self, nodes: &[u32]) -> String {
        let part = 1.0 / nodes.len() as f64;
        let sum = |d: usize| {
            nodes
                .iter()
                .map(|n| self.nodes[*n as usize][d])
                .sum::<f64>()
        };
        let near = point([0, 1, 2].map(|d| part * sum(d)));
        near.trim_end_matches(" mm").to_owned()
    }

    /// Name of a group.
    fn name(&self, dimension: i64, group: i64) -> String {
        let kind = ["point", "curve", "surface", "volume"][dimension.clamp(0, 3) as usize];
        let named = self.names.get(&(dimension, group));
        named
            .filter(|name| !name.is_empty())
            .map_or_else(|| format!("{kind}-{group}"), Clone::clone)
    }

    /// Builds the mesh.
    pub(super) fn mesh(mut self) -> Result<ImportedMesh, Wrong> {
        let mut mesh = ImportedMesh {
            nodes: std::mem::take(&mut self.nodes),
            node_labels: std::mem::take(&mut self.labels),
            element_instance: vec![None; self.hexahedra.len()],
            elements: std::mem::take(&mut self.hexahedra),
            element_labels: std::mem::take(&mut self.hexahedron_labels),
            element_places: std::mem::take(&mut self.hexahedron_places),
            ..ImportedMesh::default()
        };
        for (group, mut elements) in std::mem::take(&mut self.volumes) {
            elements.sort_unstable();
            elements.dedup();
            mesh.element_sets.insert(self.name(3, group), elements);
        }
        for ((dimension, group), mut nodes) in std::mem::take(&mut self.curves) {
            nodes.sort_unstable();
            nodes.dedup();
            mesh.node_sets.insert(self.name(dimension, group), nodes);
        }
        self.surfaces(&mut mesh)?;
        mesh.take_unused_nodes_out();
        Ok(mesh)
    }

    /// Finds the sides of hexahedra on which quadrangles lie.
    fn surfaces(&self, mesh: &mut ImportedMesh) -> Result<(), Wrong> {
        if self.quadrangles.is_empty() {
            return Ok(());
        }
        // For each side: number of its elements, and the first of them.
        let mut sides: HashMap<[u32; 4], (u32, u32, u8)> = HashMap::new();
        for e in 0..mesh.elements.len() as u32 {
            for side in 0..SIDES.len() as u8 {
                let mut nodes = mesh.facet((e, side));
                nodes.sort_unstable();
                sides.entry(nodes).or_insert((0, e, side)).0 += 1;
            }
        }
        for (group, quadrangles) in &self.quadrangles {
            let name = self.name(2, *group);
            let (mut surface, mut nodes, mut inside) = (Vec::new(), Vec::new(), 0);
            for (corners, tag, place) in quadrangles {
                let mut sorted = *corners;
                sorted.sort_unstable();
                let Some((count, e, side)) = sides.get(&sorted) else {
                    let near = Self::near(mesh, corners);
                    return Err(Wrong::new(
                        *place,
                        format!(
                            "quadrangle {tag} of {name} near {near} is no side of a hexahedron"
                        ),
                        "save the volumes, too: put them into a physical group",
                    ));
                };
                if *count == 1 {
                    surface.push((*e, *side));
                } else {
                    inside += 1;
                }
                nodes.extend(corners);
            }
            if inside > 0 {
                mesh.notes.push(format!(
                    "{name}: {inside} of its quadrangles lie between two elements, not outside; they count by \
                     their nodes only"
                ));
            }
            surface.sort_unstable();
            surface.dedup();
            nodes.sort_unstable();
            nodes.dedup();
            if !surface.is_empty() {
                mesh.surfaces.insert(name.clone(), surface);
            }
            mesh.node_sets.entry(name).or_insert(nodes);
        }
        Ok(())
    }

    fn near(mesh: &ImportedMesh, corners: &[u32; 4]) -> String {
        let sum = |d: usize| {
            corners
                .iter()
                .map(|n| mesh.nodes[*n as usize][d])
                .sum::<f64>()
        };
        let near = point([0, 1, 2].map(|d| 0.25 * sum(d)));
        near.trim_end_matches(" mm").to_owned()
    }
}
