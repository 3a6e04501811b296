//! Directions across which planes may divide a mesh: the axes, or, for a mesh oblique to them, the most frequent
//! directions of its edges.

use super::ordering::Graph;

/// Approximate number of edges considered.
const EDGES: usize = 20_000;
/// Cosine above which two edges have the same direction (15°).
const ALIKE: f64 = 0.966;
/// Number of directions considered. A grid of hex8 has 13 with its diagonals.
const MOST: usize = 13;

/// Whether planes across at least two axes contain many nodes each.
pub(super) fn along_axes(places: &[[f64; 3]], vertices: &[u32]) -> bool {
    let planes = |axis: usize| {
        let mut values: Vec<f64> = vertices.iter().map(|&v| places[v as usize][axis]).collect();
        values.sort_unstable_by(f64::total_cmp);
        values.dedup();
        values.len()
    };
    (0..3)
        .filter(|&axis| 8 * planes(axis) <= vertices.len())
        .count()
        >= 2
}

/// Unit vectors along the edges between `vertices`, the most frequent first.
pub(super) fn of_edges(graph: &Graph, places: &[[f64; 3]], vertices: &[u32]) -> Vec<[f64; 3]> {
    let mut bundles: Vec<([f64; 3], usize)> = Vec::new(); // sum of unit vectors and their number
    let edges: usize = vertices
        .iter()
        .map(|&v| graph.neighbours_of(v as usize).len())
        .sum();
    for &v in vertices.iter().step_by(edges / EDGES + 1) {
        for &u in graph.neighbours_of(v as usize) {
            let (a, b) = (places[v as usize], places[u as usize]);
            let edge: [f64; 3] = std::array::from_fn(|i| b[i] - a[i]);
            let length = dot(edge, edge).sqrt();
            // Nodes that coincide across a joint, or have no coordinates.
            if !(length.is_finite() && length > 0.0) {
                continue;
            }
            let edge = edge.map(|x| x / length);
            let cosine = |(sum, _): &([f64; 3], usize)| dot(*sum, edge) / dot(*sum, *sum).sqrt();
            let known = bundles.len();
            match bundles
                .iter_mut()
                .find(|bundle| cosine(bundle).abs() > ALIKE)
            {
                Some(bundle) => {
                    let sign = cosine(bundle).signum();
                    (0..3).for_each(|i| bundle.0[i] += sign * edge[i]);
                    bundle.1 += 1;
                }
                None if known < 8 * MOST => bundles.push((edge, 1)),
                None => {}
            }
        }
    }
    bundles.sort_by_key(|&(_, number)| std::cmp::Reverse(number));
    bundles.truncate(MOST);
    let unit = |(sum, _): ([f64; 3], usize)| sum.map(|x| x / dot(sum, sum).sqrt());
    bundles.into_iter().map(unit).collect()
}

/// The three directions with the lowest scores that are at least 60° apart, `[direction][xyz]`.
pub(super) fn choose(mut scored: Vec<(f64, [f64; 3])>) -> Option<[[f64; 3]; 3]> {
    scored.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut chosen: Vec<[f64; 3]> = Vec::new();
    for (_, direction) in scored {
        // Slightly above one half, for edges that are not quite straight.
        if chosen
            .iter()
            .all(|&other| dot(other, direction).abs() < 0.52)
        {
            chosen.push(direction);
        }
    }
    chosen.get(..3)?.try_into().ok()
}

/// Scalar product aᵀ b.
pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
