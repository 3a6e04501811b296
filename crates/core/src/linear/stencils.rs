//! Matrices similar to those of masonry, for tests.

use super::Pattern;

/// A pattern and its values.
pub struct Case {
    pub name: &'static str,
    pub pattern: Pattern,
    pub values: Vec<f64>,
}

/// Small deterministic generator (SplitMix64), uniform in [−1, 1).
pub struct Noise(pub u64);

impl Noise {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^= z >> 31;
        (z >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// Pattern and values from a function (i, j) → value. Nodes have the given lists of neighbours and `dofs` equations
/// each, numbered node by node.
pub fn assemble(
    neighbours: &[Vec<usize>],
    dofs: usize,
    coordinates: &[[f64; 3]],
    value: &mut dyn FnMut(usize, usize) -> f64,
) -> (Pattern, Vec<f64>) {
    let (mut col_ptr, mut row_idx, mut values) = (vec![0], Vec::new(), Vec::new());
    for (b, list) in neighbours.iter().enumerate() {
        let mut list = list.clone();
        list.push(b);
        list.sort_unstable();
        list.dedup();
        for q in 0..dofs {
            for &a in &list {
                for p in 0..dofs {
                    row_idx.push((a * dofs + p) as u32);
                    values.push(value(a * dofs + p, b * dofs + q));
                }
            }
            col_ptr.push(row_idx.len());
        }
    }
    let n = neighbours.len() * dofs;
    let node: Vec<u32> = (0..n).map(|j| (j / dofs) as u32).collect();
    let pattern = Pattern::new(n, col_ptr, row_idx).unwrap();
    (pattern.with_nodes(&node, coordinates).unwrap(), values)
}

/// Neighbours and coordinates of a grid of nodes with a 27-point stencil. x varies fastest.
pub fn grid(nodes: [usize; 3]) -> (Vec<Vec<usize>>, Vec<[f64; 3]>) {
    let [nx, ny, nz] = nodes;
    let (mut lists, mut coordinates) = (Vec::new(), Vec::new());
    let around = |i: usize, n: usize| i.saturating_sub(1)..(i + 2).min(n);
    for k in 0..nz {
        for j in 0..ny {
            for i in 0..nx {
                let mut list = Vec::new();
                for c in around(k, nz) {
                    for b in around(j, ny) {
                        list.extend(around(i, nx).map(|a| a + nx * (b + ny * c)));
                    }
                }
                lists.push(list);
                coordinates.push([i as f64, j as f64, k as f64]);
            }
        }
    }
    (lists, coordinates)
}

/// A grid with a matrix similar to hex8 stiffness: springs of random strength between neighbouring nodes, K = Σ
/// (e_a − e_b) k dᵀd (e_a − e_b)ᵀ, plus `ground` times the identity at the nodes with z = 0, plus `skew` times
/// noise (relative to the diagonal) on every entry.
pub fn solid(nodes: [usize; 3], ground: f64, skew: f64, seed: u64) -> (Pattern, Vec<f64>) {
    let (lists, coordinates) = grid(nodes);
    let (pattern, mut values) = assemble(&lists, 3, &coordinates, &mut |_, _| 0.0);
    let mut noise = Noise(seed);
    let mut add = |i: usize, j: usize, v: f64| values[pattern.find(i, j).unwrap()] += v;
    for (a, list) in lists.iter().enumerate() {
        for &b in list.iter().filter(|&&b| b < a) {
            let offset: [f64; 3] = std::array::from_fn(|c| coordinates[a][c] - coordinates[b][c]);
            let length = offset.iter().map(|x| x * x).sum::<f64>().sqrt();
            let strength = 1.5 + noise.next();
            for p in 0..3 {
                for q in 0..3 {
                    // Most of the stiffness is along the spring, some across it, as in a solid.
                    let k = strength
                        * (offset[p] * offset[q] / (length * length)
                            + if p == q { 0.2 } else { 0.0 });
                    add(3 * a + p, 3 * a + q, k);
                    add(3 * b + p, 3 * b + q, k);
                    add(3 * a + p, 3 * b + q, -k);
                    add(3 * b + p, 3 * a + q, -k);
                }
            }
        }
        if coordinates[a][2] == 0.0 {
            (0..3).for_each(|p| add(3 * a + p, 3 * a + p, ground));
        }
    }
    for v in &mut values {
        *v += skew * 10.0 * noise.next();
    }
    (pattern, values)
}
