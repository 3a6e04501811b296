//! Where a load acts: facets of faces, blocks, the node nearest to a point, the nodes along a line.

use crate::deck::keys;
use crate::deck::quantity::{Length, Quantity};
use crate::deck::schema::{Deck, DeckLoad, Names};
use crate::element::hexahedron::{difference, dot, norm};
use crate::error::ModelError;
use crate::model::Mesh;

/// What names stand for.
#[derive(Debug, Default)]
pub(super) struct Place {
    /// All nodes, ascending.
    pub(super) nodes: Vec<u32>,
    /// Facets of the faces among the names, counter-clockwise seen from outside.
    pub(super) facets: Vec<[u32; 4]>,
    /// Whether there are both faces and whole blocks.
    pub(super) mixed: bool,
}

/// Names at a path of the deck; nothing but faces, if asked for.
type Named<'a> = dyn Fn(&str, &Names, bool) -> Result<Place, ModelError> + 'a;

/// A scene in which loads find their places.
pub(super) struct Site<'a> {
    deck: &'a Deck,
    pub(super) mesh: &'a Mesh,
    named: &'a Named<'a>,
}

/// How far from a line a node may lie where the deck does not say, of the model's diagonal: more than
/// rounding of turned blocks, less than any element.
const WITHIN: f64 = 1e-5;

impl<'a> Site<'a> {
    pub(super) fn new(deck: &'a Deck, mesh: &'a Mesh, named: &'a Named<'a>) -> Self {
        Self { deck, mesh, named }
    }

    /// What the names of a load stand for; all nodes without names.
    ///
    /// # Errors
    /// Names of nothing, faces and blocks in one list.
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

    /// The facets that a load names.
    ///
    /// # Errors
    /// Names of nothing, or of what is no face.
    pub(super) fn facets(&self, path: &str, load: &DeckLoad) -> Result<Vec<[u32; 4]>, ModelError> {
        let facets = self.on(path, load, true)?.facets;
        if facets.is_empty() {
            let help = keys::example_at("steps.loads.on");
            let message = "a pressure or a traction acts on faces, and none is named";
            return Err(self.deck.error(&format!("{path}.on"), message, &help));
        }
        Ok(facets)
    }

    /// The node nearest to a point, of those of `on` if given.
    ///
    /// # Errors
    /// A point farther from all than the model is large.
    pub(super) fn nearest(
        &self,
        path: &str,
        load: &DeckLoad,
        near: [Length; 3],
    ) -> Result<u32, ModelError> {
        let near = near.map(Quantity::get);
        let nodes = self.on(path, load, false)?.nodes;
        let away = |n: u32| norm(difference(self.mesh.nodes[n as usize], near));
        let nearest = nodes.iter().map(|&n| (away(n), n));
        let nearest = nearest.min_by(|a, b| a.0.total_cmp(&b.0));
        let size = self.mesh.diagonal();
        match nearest {
            Some((distance, node)) if distance <= size => Ok(node),
            _ => {
                let distance = nearest.map_or(f64::INFINITY, |n| n.0);
                Err(self.deck.error(
                    &format!("{path}.near"),
                    format!(
                        "the nearest node is {distance:.4} mm away, farther than the model is large \
                         ({size:.4} mm)"
                    ),
                    "see that the unit of length is right: bare numbers are in mm",
                ))
            }
        }
    }

    /// Tributary lengths of the nodes along the line of a load [mm]: half the way to the next ones on
    /// either side. Nodes side by side share alike.
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
        // Nodes by their place along the line.
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

    /// Tributary volumes of nodes: an eighth of each element whose nodes are all among these [mm³].
    pub(super) fn volumes(&self, nodes: &[u32]) -> Vec<(u32, f64)> {
        let elements = self.mesh.elements.iter().enumerate();
        let of = elements
            .filter(|(_, corners)| corners.iter().all(|n| nodes.binary_search(n).is_ok()))
            .flat_map(|(e, corners)| {
                let share = self.mesh.volume(e) / 8.0;
                corners.map(|n| (n, share))
            });
        summed(of, |sum, v| sum + v)
    }
}

/// Sums what is said of each node, nodes ascending.
pub(super) fn summed<T: Copy>(
    of: impl Iterator<Item = (u32, T)>,
    add: impl Fn(T, T) -> T,
) -> Vec<(u32, T)> {
    let mut all: Vec<(u32, T)> = of.collect();
    all.sort_by_key(|(n, _)| *n); // stable: sums in a fixed order
    let mut sums: Vec<(u32, T)> = Vec::new();
    for (n, value) in all {
        match sums.last_mut() {
            Some(last) if last.0 == n => last.1 = add(last.1, value),
            _ => sums.push((n, value)),
        }
    }
    sums
}
