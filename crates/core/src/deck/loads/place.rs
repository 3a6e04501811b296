//! Nodes and facets on which a load acts: faces, blocks, the node nearest to a point, the nodes along a line.

use crate::deck::keys;
use crate::deck::probes;
use crate::deck::quantity::{Length, Quantity};
use crate::deck::schema::{Deck, DeckLoad, Names};
use crate::element::hexahedron::{difference, dot, norm};
use crate::error::ModelError;
use crate::model::Mesh;

/// Nodes and facets that names denote.
#[derive(Debug, Default)]
pub(super) struct Place {
    /// All nodes, ascending.
    pub(super) nodes: Vec<u32>,
    /// Facets of the named faces, counter-clockwise seen from outside.
    pub(super) facets: Vec<[u32; 4]>,
    /// Area of the facets beyond that which no other wall covers [mm²].
    pub(super) excess: f64,
    /// Whether the names contain both faces and whole blocks.
    pub(super) mixed: bool,
}

/// Resolves names at a path of the deck; accepts only faces if asked to.
type Named<'a> = dyn Fn(&str, &Names, bool) -> Result<Place, ModelError> + 'a;

/// The scene in which places of loads are searched.
pub(super) struct Site<'a> {
    pub(super) deck: &'a Deck,
    pub(super) mesh: &'a Mesh,
    named: &'a Named<'a>,
}

/// Default distance of nodes from a line, as a fraction of the diagonal of the model: larger than rounding in
/// turned blocks, smaller than any element.
const WITHIN: f64 = 1e-5;

impl<'a> Site<'a> {
    pub(super) fn new(deck: &'a Deck, mesh: &'a Mesh, named: &'a Named<'a>) -> Self {
        Self { deck, mesh, named }
    }

    /// Nodes and facets that the names of a load denote; all nodes if it has no names.
    ///
    /// # Errors
    /// Unknown names, faces and blocks in one list.
    pub(super) fn on(&self, path: &str, load: &DeckLoad, faces: bool) -> Result<Place, ModelError> {
        let path = format!("{path}.on");
        let Some(names) = &load.on else {
            return Ok(Place {
                nodes: self.mesh.nodes_of_solids(),
                ..Place::default()
            });
        };
        let place = (self.named)(&path, names, faces)?;
        if place.mixed {
            let help = "spread the force over faces alone, or over blocks alone";
            return Err(self
                .deck
                .error(&path, "the list has faces and blocks", help));
        }
        Ok(place)
    }

    /// Facets that a load names.
    ///
    /// # Errors
    /// Unknown names, names without faces.
    pub(super) fn facets(&self, path: &str, load: &DeckLoad) -> Result<Vec<[u32; 4]>, ModelError> {
        let facets = self.on(path, load, true)?.facets;
        if facets.is_empty() {
            let help = keys::example_at("steps.loads.on");
            let message = "a pressure or a traction acts on faces, and none is named";
            return Err(self.deck.error(&format!("{path}.on"), message, &help));
        }
        Ok(facets)
    }

    /// Node nearest to a point, among those of `on` if given.
    ///
    /// # Errors
    /// A point farther from all nodes than the size of the model.
    pub(super) fn nearest(
        &self,
        path: &str,
        load: &DeckLoad,
        near: [Length; 3],
    ) -> Result<u32, ModelError> {
        let nodes = self.on(path, load, false)?.nodes;
        probes::nearest(self.deck, self.mesh, &nodes, near, path)
    }

    /// Tributary lengths of the nodes along the line of a load [mm]: half the distance to the next ones on either
    /// side. Nodes at the same place along the line share equally.
    ///
    /// # Errors
    /// Fewer than two places along the line.
    pub(super) fn lengths(
        &self,
        path: &str,
        load: &DeckLoad,
    ) -> Result<Vec<(u32, f64)>, ModelError> {
        let ends = [load.from, load.to].map(|x| x.unwrap_or_default().map(Quantity::get));
        let nodes = self.on(path, load, false)?.nodes;
        let size = self.mesh.diagonal();
        let within = load.within.map_or(WITHIN * size, Quantity::get);
        let along = difference(ends[1], ends[0]);
        let length = norm(along);
        // Nodes by their coordinate along the line.
        let mut found: Vec<(f64, u32)> = Vec::new();
        for n in nodes {
            let from = difference(self.mesh.nodes[n as usize], ends[0]);
            let at = dot(from, along) / length;
            let off = [0, 1, 2].map(|i| from[i] - at.max(0.0).min(length) * along[i] / length);
            if norm(off) <= within {
                found.push((at, n));
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let same = |a: &(f64, u32), b: &(f64, u32)| b.0 - a.0 <= WITHIN * size;
        let stations: Vec<&[(f64, u32)]> = found.chunk_by(same).collect();
        if stations.len() < 2 {
            let message = format!(
                "{} nodes lie within {within:.4} mm of the line, at {} places along it: at least two are \
                 needed",
                found.len(),
                stations.len()
            );
            let help = "let the line run along nodes of the mesh, or say how far they may be: within = \"5 mm\"";
            return Err(self.deck.error(&format!("{path}.from"), message, help));
        }
        let mut lengths = Vec::with_capacity(found.len());
        for (s, station) in stations.iter().enumerate() {
            let before = stations[s.saturating_sub(1)][0].0;
            let after = stations[(s + 1).min(stations.len() - 1)][0].0;
            let share = 0.5 * (after - before) / station.len() as f64;
            lengths.extend(station.iter().map(|(_, n)| (*n, share)));
        }
        lengths.sort_unstable_by_key(|(n, _)| *n);
        Ok(lengths)
    }

    /// Tributary volumes ∫ N dV of nodes [mm³], of the elements whose nodes are all among these.
    pub(super) fn volumes(&self, nodes: &[u32]) -> Vec<(u32, f64)> {
        let elements = self.mesh.elements.iter().enumerate();
        let of = elements
            .filter(|(_, corners)| corners.iter().all(|n| nodes.binary_search(n).is_ok()))
            .flat_map(|(e, corners)| corners.iter().copied().zip(self.mesh.nodal_volumes(e)));
        summed(of, |sum, v| sum + v)
    }
}

/// Sums the values of each node, in ascending order of nodes.
pub(super) fn summed<T: Copy>(
    of: impl Iterator<Item = (u32, T)>,
    add: impl Fn(T, T) -> T,
) -> Vec<(u32, T)> {
    let mut all: Vec<(u32, T)> = of.collect();
    all.sort_by_key(|(n, _)| *n); // stable: the order of summation is fixed
    let mut sums: Vec<(u32, T)> = Vec::new();
    for (n, value) in all {
        match sums.last_mut() {
            Some(last) if last.0 == n => last.1 = add(last.1, value),
            _ => sums.push((n, value)),
        }
    }
    sums
}
