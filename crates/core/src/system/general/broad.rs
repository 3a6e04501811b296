//! The broad phase: which corners and edges may come near which facets and edges of other bodies.

use rayon::prelude::*;
use wythe_contact::{Aabb, Bvh};

use super::{General, NEAR};

/// How far surfaces may move before their neighbours are searched anew, over the smallest facet.
const SKIN: f64 = 0.1;

/// Neighbours, and the positions that they hold for.
#[derive(Clone, Debug, Default)]
pub(super) struct Nearby {
    /// `[node, facet]`, ascending.
    pub(super) corners: Vec<[u32; 2]>,
    /// `[edge, edge]`, the lower first, ascending.
    pub(super) edges: Vec<[u32; 2]>,
    /// Where bodies were when the increment began, and where they were then [mm]. `[node]`
    at: [Vec<[f64; 3]>; 2],
    /// How far they may move [mm].
    margin: f64,
}

impl Nearby {
    /// None yet, of facets of these sizes [mm].
    pub(super) fn new(size: &[f64]) -> Self {
        let least = size.iter().copied().fold(f64::INFINITY, f64::min);
        Self {
            margin: SKIN * least,
            ..Self::default()
        }
    }

    /// Whether the neighbours hold for an increment from `x0` to `x` [mm] `[node]`.
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

    /// All pairs whose boxes over the way from `x0` to `x` [mm] `[node]` come near one another.
    pub(super) fn search(&mut self, of: &General, x0: &[[f64; 3]], x: &[[f64; 3]]) {
        let Some(general) = &of.of else { return };
        let over = |nodes: &[u32]| {
            let both = nodes.iter().flat_map(|&n| [&x0[n as usize], &x[n as usize]]);
            Aabb::of(both)
        };
        let reach = |size: f64| NEAR * size + self.margin;
        let facets: Vec<Aabb> = of.surface.facets.iter().map(|f| over(f)).collect();
        let tree = Bvh::build(&facets);
        let corners = of.nodes.par_iter().map_init(Vec::new, |stack, &node| {
            let own = of.facets_at(node);
            let (body, held) = (of.body(own[0]), own.iter().all(|&f| of.held_facet[f as usize]));
            let query = over(&[node]).fattened(reach(of.node_size[node as usize]));
            let mut found = Vec::new();
            tree.query(&facets, &query, stack, |f| {
                if of.body(f) != body && !(held && of.held_facet[f as usize]) {
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
        let pairs = (0..sharp.len() as u32).into_par_iter().map_init(Vec::new, |stack, a| {
            let edge = &sharp[a as usize];
            let held = |e: &crate::model::skin::SharpEdge| {
                e.facets.iter().all(|&f| of.held_facet[f as usize])
            };
            let size = edge.facets.map(|f| of.size[f as usize]);
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
