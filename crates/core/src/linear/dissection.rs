//! Geometric nested dissection of a mesh (George 1973). Planes divide the graph of nodes in two; the nodes that
//! separate both parts are eliminated last.
//!
//! Planes across three directions are compared: the axes, or, for a mesh oblique to the axes, the edge directions
//! with the best cuts. The plane with the fewest nodes beside it, relative to the nodes that it cuts off, is taken
//! (theory/linear-solver.md, eq. 1). Its separator is the smallest set of nodes that covers the cut edges (König).
//! So a plane through staggered bricks follows joints and bricks as needed. Small parts are ordered by minimum
//! degree, together with the separators around them, which come later.

use super::LinearError;
use super::directions::{self, dot};
use super::ordering::Graph;

/// Parts of at most this many nodes are ordered by minimum degree.
const LEAF: usize = 200;
/// The smaller side of a cut is at least this part of the whole.
const BALANCE: f64 = 0.25;
/// Marks a vertex outside all parts.
const NONE: u32 = u32::MAX;

/// Working arrays of the recursion, with one entry for each vertex.
struct Dissection<'a> {
    graph: &'a Graph,
    places: &'a [[f64; 3]],
    part: Vec<u32>,
    parts: u32,
    local: Vec<u32>,
    order: Vec<u32>,
}

/// Nested dissection order, `[position] → vertex`. Vertices without coordinates come last.
///
/// # Errors
/// [`LinearError::TooLarge`] if memory or 32-bit indices run out.
pub(super) fn dissect(graph: &Graph, places: &[[f64; 3]]) -> Result<Vec<u32>, LinearError> {
    let n = graph.len() as u32;
    let placed = |&v: &u32| places[v as usize].iter().all(|x| x.is_finite());
    let (inside, outside): (Vec<u32>, Vec<u32>) = (0..n).partition(placed);
    let mut part = vec![NONE; n as usize];
    for &v in &inside {
        part[v as usize] = 0;
    }
    let turned = turn(graph, places, &inside, &part);
    let mut work = Dissection {
        graph,
        places: turned.as_deref().unwrap_or(places),
        part,
        parts: 0,
        local: vec![NONE; n as usize],
        order: Vec::with_capacity(n as usize),
    };
    work.recurse(inside)?;
    work.order.extend(outside);
    Ok(work.order)
}

/// Coordinates along three directions with better cuts than the axes, if the mesh has no planes across the axes.
fn turn(graph: &Graph, places: &[[f64; 3]], inside: &[u32], part: &[u32]) -> Option<Vec<[f64; 3]>> {
    if inside.len() <= LEAF || directions::along_axes(places, inside) {
        return None;
    }
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let edges = directions::of_edges(graph, places, inside);
    let score = |direction: [f64; 3]| {
        let place = |v: u32| dot(places[v as usize], direction);
        sweep(graph, part, inside, place).map(|(score, _)| (score, direction))
    };
    let scored = axes.into_iter().chain(edges).filter_map(score).collect();
    let chosen = directions::choose(scored)?;
    Some(places.iter().map(|&x| chosen.map(|d| dot(x, d))).collect())
}

impl Dissection<'_> {
    fn recurse(&mut self, vertices: Vec<u32>) -> Result<(), LinearError> {
        let cut = if vertices.len() > LEAF {
            self.plane(&vertices)
        } else {
            None
        };
        let Some((axis, at)) = cut else {
            return self.leaf(&vertices);
        };
        let (left, right): (Vec<u32>, Vec<u32>) = vertices
            .into_iter()
            .partition(|&v| self.places[v as usize][axis] <= at);
        let next = self.parts;
        self.parts += 2;
        for (side, list) in [&left, &right].into_iter().enumerate() {
            for &v in list {
                self.part[v as usize] = next + 1 + side as u32;
            }
        }
        let separator = self.cover(&left, next + 2);
        for &v in &separator {
            self.part[v as usize] = NONE;
        }
        for (side, mut list) in [left, right].into_iter().enumerate() {
            list.retain(|&v| self.part[v as usize] == next + 1 + side as u32);
            self.recurse(list)?;
        }
        self.order.extend(separator);
        Ok(())
    }

    /// Axis and coordinate `at` of the best cut: one part has x ≤ at.
    fn plane(&self, vertices: &[u32]) -> Option<(usize, f64)> {
        let mut best = (f64::INFINITY, None);
        for axis in 0..3 {
            let place = |v: u32| self.places[v as usize][axis];
            if let Some((score, at)) = sweep(self.graph, &self.part, vertices, place)
                && score < best.0
            {
                best = (score, Some((axis, at)));
            }
        }
        best.1
    }

    /// Smallest set of vertices that covers all edges from `left` to the part `right`: a maximum matching by
    /// augmenting paths, then the cover that it proves minimal (König).
    fn cover(&mut self, left: &[u32], right: u32) -> Vec<u32> {
        let graph = self.graph;
        // local: index on its own side of the cut.
        let (mut edges, mut border, mut beyond) = (Vec::new(), Vec::new(), Vec::new());
        for &v in left {
            let mut list = Vec::new();
            for &u in graph.neighbours_of(v as usize) {
                if self.part[u as usize] == right {
                    if self.local[u as usize] == NONE {
                        self.local[u as usize] = beyond.len() as u32;
                        beyond.push(u);
                    }
                    list.push(self.local[u as usize]);
                }
            }
            if !list.is_empty() {
                border.push(v);
                edges.push(list);
            }
        }
        for &u in &beyond {
            self.local[u as usize] = NONE;
        }
        let (mate, partner) = matching(&edges, beyond.len());
        // Vertices reached by alternating paths from unmatched vertices on the left.
        let (mut reached, mut reached_beyond) =
            (vec![false; border.len()], vec![false; beyond.len()]);
        let mut queue: Vec<usize> = (0..border.len()).filter(|&i| mate[i] == NONE).collect();
        for &i in &queue {
            reached[i] = true;
        }
        while let Some(i) = queue.pop() {
            for &j in &edges[i] {
                if !std::mem::replace(&mut reached_beyond[j as usize], true) {
                    let back = partner[j as usize] as usize;
                    if back < border.len() && !std::mem::replace(&mut reached[back], true) {
                        queue.push(back);
                    }
                }
            }
        }
        let near = border
            .iter()
            .zip(&reached)
            .filter(|(_, r)| !**r)
            .map(|(&v, _)| v);
        let far = beyond
            .iter()
            .zip(&reached_beyond)
            .filter(|(_, r)| **r)
            .map(|(&v, _)| v);
        near.chain(far).collect()
    }

    /// Orders a part by minimum degree. Its surroundings are made a clique so that they come later.
    fn leaf(&mut self, vertices: &[u32]) -> Result<(), LinearError> {
        let graph = self.graph;
        let Some(&first) = vertices.first() else {
            return Ok(());
        };
        let here = self.part[first as usize];
        let mut list = vertices.to_vec();
        for (i, &v) in vertices.iter().enumerate() {
            self.local[v as usize] = i as u32;
        }
        for &v in vertices {
            for &u in graph.neighbours_of(v as usize) {
                if self.local[u as usize] == NONE && self.part[u as usize] != here {
                    self.local[u as usize] = list.len() as u32;
                    list.push(u);
                }
            }
        }
        let halo = vertices.len() as u32..list.len() as u32;
        let (mut ptr, mut neighbours) = (vec![0], Vec::new());
        for (i, &v) in list.iter().enumerate() {
            let begin = neighbours.len();
            let inside = i < vertices.len();
            let known = graph
                .neighbours_of(v as usize)
                .iter()
                .map(|&u| self.local[u as usize]);
            neighbours.extend(known.filter(|&l| l != NONE && (inside || l < halo.start)));
            if !inside {
                neighbours.extend(halo.clone().filter(|&h| h as usize != i));
            }
            neighbours[begin..].sort_unstable();
            ptr.push(u32::try_from(neighbours.len()).map_err(|_| LinearError::TooLarge)?);
        }
        for &v in &list {
            self.local[v as usize] = NONE;
        }
        let order = Graph { ptr, neighbours }.amd()?;
        let inside = order.iter().filter(|&&l| l < halo.start);
        self.order.extend(inside.map(|&l| list[l as usize]));
        Ok(())
    }
}

/// Best of all cuts x ≤ at of a part: nodes beside it over nodes that it cuts off, and `at`.
fn sweep(
    graph: &Graph,
    part: &[u32],
    vertices: &[u32],
    place: impl Fn(u32) -> f64,
) -> Option<(f64, f64)> {
    let here = part[vertices[0] as usize];
    let mut values: Vec<f64> = vertices.iter().map(|&v| place(v)).collect();
    values.sort_unstable_by(f64::total_cmp);
    values.dedup();
    let rank = |x: f64| values.partition_point(|&value| value < x);
    // Changes from plane to plane: vertices on the left, left vertices beside the plane, right vertices beside it.
    let mut change = vec![[0i64; 3]; values.len() + 1];
    for &v in vertices {
        let (mut low, mut high) = (place(v), place(v));
        for &u in graph.neighbours_of(v as usize) {
            if part[u as usize] == here {
                low = low.min(place(u));
                high = high.max(place(u));
            }
        }
        let at = rank(place(v));
        change[at][0] += 1;
        change[at][1] += 1;
        change[rank(high)][1] -= 1;
        change[rank(low)][2] += 1;
        change[at][2] -= 1;
    }
    let mut sums = [0i64; 3];
    let mut best = None;
    for (&at, change) in values.iter().zip(&change) {
        (0..3).for_each(|i| sums[i] += change[i]);
        let left = sums[0] as f64;
        let smaller = left.min(vertices.len() as f64 - left);
        if smaller < BALANCE * vertices.len() as f64 {
            continue;
        }
        let score = sums[1].min(sums[2]) as f64 / smaller;
        if best.is_none_or(|(least, _)| score < least) {
            best = Some((score, at));
        }
    }
    best
}

/// Maximum matching of a bipartite graph: the partner of each left and of each right vertex.
fn matching(edges: &[Vec<u32>], right: usize) -> (Vec<u32>, Vec<u32>) {
    let (mut mate, mut partner) = (vec![NONE; edges.len()], vec![NONE; right]);
    let mut seen = vec![NONE; right];
    for root in 0..edges.len() {
        // Depth-first search. Each level stores the next edge to try.
        let mut path: Vec<(usize, usize)> = vec![(root, 0)];
        while let Some((i, next)) = path.last_mut() {
            let Some(&j) = edges[*i].get(*next) else {
                path.pop();
                continue;
            };
            *next += 1;
            if seen[j as usize] == root as u32 {
                continue;
            }
            seen[j as usize] = root as u32;
            if partner[j as usize] != NONE {
                path.push((partner[j as usize] as usize, 0));
                continue;
            }
            for &(i, next) in &path {
                let j = edges[i][next - 1];
                mate[i] = j;
                partner[j as usize] = i as u32;
            }
            break;
        }
    }
    (mate, partner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::stencils::grid;

    #[test]
    fn a_matching_is_enlarged_along_augmenting_paths() {
        // Vertex 0 takes its first neighbour and must change it twice. Vertex 3 finds no free neighbour.
        let edges = [vec![0, 1], vec![0, 2], vec![0], vec![0]];
        let (mate, partner) = matching(&edges, 3);
        assert_eq!(mate, [1, 2, 0, NONE]);
        assert_eq!(partner, [2, 0, 1]);
    }

    #[test]
    fn the_first_separator_of_a_wall_is_one_column_and_comes_last() {
        let nodes = [40, 3, 20];
        let (lists, places) = grid(nodes);
        let (mut ptr, mut neighbours) = (vec![0], Vec::new());
        for (v, list) in lists.iter().enumerate() {
            neighbours.extend(list.iter().filter(|&&u| u != v).map(|&u| u as u32));
            ptr.push(neighbours.len() as u32);
        }
        let graph = Graph { ptr, neighbours };
        let order = dissect(&graph, &places).unwrap();
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert!(sorted.iter().copied().eq(0..graph.len() as u32));
        let last = &order[order.len() - nodes[1] * nodes[2]..];
        let x = places[last[0] as usize][0];
        assert!(last.iter().all(|&v| places[v as usize][0] == x), "{x}");
    }
}
