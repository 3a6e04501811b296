//! Broad phase: corners and edges that may come close to facets and edges of other bodies.

use rayon::prelude::*;
use wythe_contact::{Aabb, Bvh};

use super::{General, NEAR};

/// Margin over the smallest facet: how far surfaces may move before neighbours are searched again.
const SKIN: f64 = 0.1;

/// Neighbours, and the positions for which they are valid.
#[derive(Clone, Debug, Default)]
pub(super) struct Nearby {
    /// Pairs `[node, facet]`, ascending.
    pub(super) corners: Vec<[u32; 2]>,
    /// Pairs `[edge, edge]`, the lower number first, ascending.
    pub(super) edges: Vec<[u32; 2]>,
    /// Positions at the start of the increment and at the search [mm]. `[node]`
    at: [Vec<[f64; 3]>; 2],
    /// Margin of movement [mm].
    margin: f64,
}

impl Nearby {
    /// No neighbours yet, for facets of these sizes [mm].
    pub(super) fn new(size: &[f64]) -> Self {
        let least = size.iter().copied().fold(f64::INFINITY, f64::min);
        Self {
            margin: SKIN * least,
            ..Self::default()
        }
    }

    /// Whether the neighbours are valid for an increment from `x0` to `x` [mm] `[node]`.
    pub(super) fn holds(&self, x0: &[[f64; 3]], x: &[[f64; 3]]) -> bool {
        let [from, to] = &self.at;
        if from.len() != x.len() {
            return false;
        }
        let most = 0.25 * self.margin * self.margin;
        let near = |a: &[f64; 3], b: &[f64; 3]| {
            (0..3).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum::<f64>() <= most
        };
        (0..x.len()).into_par_iter().with_min_len(1000).all(|n| {
            (near(&x0[n], &from[n]) || near(&x0[n], &to[n]))
                && (near(&x[n], &from[n]) || near(&x[n], &to[n]))
        })
    }

    /// Finds all pairs whose boxes over the way from `x0` to `x` [mm] `[node]` come close to each other.
    pub(super) fn search(&mut self, of: &General, x0: &[[f64; 3]], x: &[[f64; 3]]) {
        let Some(general) = &of.of else { return };
        let over = |nodes: &[u32]| {
            let both = nodes
                .iter()
                .flat_map(|&n| [&x0[n as usize], &x[n as usize]]);
            Aabb::of(both)
        };
        let reach = |size: f64| NEAR * size + self.margin;
        let facets: Vec<Aabb> = of.faces.surface.facets.iter().map(|f| over(f)).collect();
        let tree = Bvh::build(&facets);
        let corners = of
            .faces
            .nodes
            .par_iter()
            .map_init(Vec::new, |stack, &node| {
                let own = of.facets_at(node);
                let (body, held) = (
                    of.body(own[0]),
                    own.iter().all(|&f| of.faces.held_facet[f as usize]),
                );
                let query = over(&[node]).fattened(reach(of.faces.node_size[node as usize]));
                let mut found = Vec::new();
                tree.query(&facets, &query, stack, |f| {
                    if of.body(f) != body && !(held && of.faces.held_facet[f as usize]) {
                        found.push([node, f]);
                    }
                });
                found.sort_unstable();
                found
            });
        self.corners = corners.flatten_iter().collect();

        let sharp = &general.skin.edges;
        let edges: Vec<Aabb> = sharp.iter().map(|e| over(&e.nodes)).collect();
        let tree = Bvh::build(&edges);
        let pairs = (0..sharp.len() as u32)
            .into_par_iter()
            .map_init(Vec::new, |stack, a| {
                let edge = &sharp[a as usize];
                let held = |e: &crate::model::boundary_facets::SharpEdge| {
                    e.facets.iter().all(|&f| of.faces.held_facet[f as usize])
                };
                let size = edge.facets.map(|f| of.faces.size[f as usize]);
                let query = edges[a as usize].fattened(reach(size[0].min(size[1])));
                let mut found = Vec::new();
                tree.query(&edges, &query, stack, |b| {
                    let other = &sharp[b as usize];
                    if b > a
                        && of.body(other.facets[0]) != of.body(edge.facets[0])
                        && !(held(edge) && held(other))
                    {
                        found.push([a, b]);
                    }
                });
                found.sort_unstable();
                found
            });
        self.edges = pairs.flatten_iter().collect();
        self.at = [x0.to_vec(), x.to_vec()];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assembly::System;
    use crate::deck::Deck;
    use crate::model::Model;

    const DECK: &str = r#"
format = 1
[materials.stone]
E = "10 GPa"
nu = 0.2
density = "2000 kg/m^3"
[interfaces.dry]
f_t = 0
c = 0
tan_phi = 0.6
mu = 0.6
[contact]
general = "dry"
[[blocks]]
name = "stone"
size = [100, 80, 60]
mesh = [2, 1, 1]
material = "stone"
copies = [3, 3, 2]
pitch = [107, 90, 61]
[[steps]]
kind = "free"
"#;

    #[test]
    fn neighbours_are_those_of_brute_force() {
        let deck = Deck::from_str(DECK, "test").unwrap();
        let (model, _) = Model::from_deck(&deck).unwrap();
        let system = System::new(&model).unwrap();
        let of = &system.general;
        // A deterministic perturbation larger than the gaps, and a movement of some millimetres.
        let x0: Vec<[f64; 3]> = (model.mesh.nodes.iter().enumerate())
            .map(|(n, x)| [0, 1, 2].map(|i| x[i] + 9.0 * ((n * 7 + i * 3) as f64).sin()))
            .collect();
        let x: Vec<[f64; 3]> = (x0.iter().enumerate())
            .map(|(n, x)| [0, 1, 2].map(|i| x[i] + 5.0 * ((n * 11 + i) as f64).cos()))
            .collect();
        let mut nearby = of.nearby.clone();
        nearby.search(of, &x0, &x);
        let over = |nodes: &[u32]| {
            Aabb::of(
                nodes
                    .iter()
                    .flat_map(|&n| [&x0[n as usize], &x[n as usize]]),
            )
        };
        let reach = |size: f64| NEAR * size + nearby.margin;
        let mut corners = Vec::new();
        for &n in &of.faces.nodes {
            let query = over(&[n]).fattened(reach(of.faces.node_size[n as usize]));
            for f in 0..of.faces.surface.facets.len() {
                let other = of.faces.surface.body[f] != of.body(of.facets_at(n)[0]);
                if other && over(&of.faces.surface.facets[f]).touches(&query) {
                    corners.push([n, f as u32]);
                }
            }
        }
        let sharp = &of.of.as_ref().unwrap().skin.edges;
        let mut edges = Vec::new();
        for a in 0..sharp.len() {
            let size = sharp[a].facets.map(|f| of.faces.size[f as usize]);
            let query = over(&sharp[a].nodes).fattened(reach(size[0].min(size[1])));
            for b in a + 1..sharp.len() {
                let other = of.body(sharp[a].facets[0]) != of.body(sharp[b].facets[0]);
                if other && over(&sharp[b].nodes).touches(&query) {
                    edges.push([a as u32, b as u32]);
                }
            }
        }
        assert!(!corners.is_empty() && !edges.is_empty());
        assert!(corners.len() < of.faces.nodes.len() * of.faces.surface.facets.len() / 4);
        assert_eq!(nearby.corners, corners);
        assert_eq!(nearby.edges, edges);
        assert!(nearby.holds(&x0, &x) && !nearby.holds(&model.mesh.nodes, &x));
    }
}
