//! Blocks of unknowns that inequalities couple: the forces at a corner, or at all corners of a joint.

use clarabel::algebra::CscMatrix;

use super::cones::Cone;

/// Unknowns that inequalities couple, with their part of the matrix.
#[derive(Clone, Debug, Default)]
pub struct Block {
    /// Columns of the unknowns.
    pub columns: Vec<usize>,
    /// Equations with one of the unknowns, ascending.
    pub equations: Vec<usize>,
    /// Coefficients in the equations. `[column][equation]`
    pub own: Vec<f64>,
    /// Numbers of the cones.
    pub cones: Vec<usize>,
    /// Rows of the cones, cone after cone.
    pub rows: Vec<usize>,
    /// Coefficients in these rows. `[column][row]`
    pub bounds: Vec<f64>,
    /// W⁻¹ times `bounds`.
    pub scaled: Vec<f64>,
    /// R of the Householder factors Q R of `scaled`, upper triangle. `[column][row]`
    upper: Vec<f64>,
    /// R⁻ᵀ times the coefficients in the equations. `[equation][column]`
    pub lifted: Vec<f64>,
}

impl Block {
    /// Factorises with the scaling of the cones; false if an unknown has no bound.
    pub fn factorise(&mut self, cones: &[Cone]) -> bool {
        let (rows, count) = (self.rows.len(), self.columns.len());
        self.scaled.clone_from(&self.bounds);
        for column in self.scaled.chunks_exact_mut(rows) {
            let mut first = 0;
            for cone in &self.cones {
                let cone = &cones[*cone];
                cone.unapply(&mut column[first..first + cone.rows()]);
                first += cone.rows();
            }
        }
        if !triangle(&self.scaled, rows, count, &mut self.upper) {
            return false;
        }
        let equations = self.equations.len();
        self.lifted.resize(equations * count, 0.0);
        for e in 0..equations {
            let lifted = &mut self.lifted[e * count..(e + 1) * count];
            for (k, value) in lifted.iter_mut().enumerate() {
                *value = self.own[k * equations + e];
            }
            forward(&self.upper, rows.max(count), lifted);
        }
        true
    }

    /// g ← R⁻ᵀ g.
    pub fn lift(&self, g: &mut [f64]) {
        forward(&self.upper, self.rows.len().max(g.len()), g);
    }

    /// p ← R⁻¹ p.
    pub fn lower(&self, p: &mut [f64]) {
        let stride = self.rows.len().max(p.len());
        for k in (0..p.len()).rev() {
            for j in k + 1..p.len() {
                p[k] -= self.upper[j * stride + k] * p[j];
            }
            p[k] /= self.upper[k * stride + k];
        }
    }
}

/// g ← R⁻ᵀ g for columns of R of length `stride`.
fn forward(upper: &[f64], stride: usize, g: &mut [f64]) {
    for k in 0..g.len() {
        let column = &upper[k * stride..];
        for j in 0..k {
            g[k] -= column[j] * g[j];
        }
        g[k] /= column[k];
    }
}

/// R of the Householder factors of a matrix of columns. Rows are sorted by size first, so that small ones keep their
/// accuracy (Cox and Higham 1998). False if the columns depend on each other.
fn triangle(matrix: &[f64], rows: usize, count: usize, upper: &mut Vec<f64>) -> bool {
    let stride = rows.max(count);
    let size = |row: usize| {
        (0..count)
            .map(|k| matrix[k * rows + row].abs())
            .fold(0.0, f64::max)
    };
    let mut order: Vec<usize> = (0..rows).collect();
    order.sort_by(|a, b| size(*b).total_cmp(&size(*a)));
    upper.clear();
    upper.resize(stride * count, 0.0);
    for k in 0..count {
        for (to, from) in order.iter().enumerate() {
            upper[k * stride + to] = matrix[k * rows + from];
        }
    }
    for k in 0..count {
        let (done, rest) = upper.split_at_mut((k + 1) * stride);
        let own = &mut done[k * stride + k..];
        let length = own.iter().map(|v| v * v).sum::<f64>().sqrt();
        if !(length > 0.0 && length.is_finite()) {
            return false;
        }
        let diagonal = if own[0] > 0.0 { -length } else { length };
        own[0] -= diagonal;
        let square: f64 = own.iter().map(|v| v * v).sum();
        for other in rest.chunks_exact_mut(stride) {
            let other = &mut other[k..];
            let along: f64 = own.iter().zip(&*other).map(|(a, b)| a * b).sum();
            let along = 2.0 * along / square;
            for (o, v) in other.iter_mut().zip(&*own) {
                *o -= along * v;
            }
        }
        own.fill(0.0);
        own[0] = diagonal;
    }
    true
}

/// Blocks of a matrix whose rows from `equations` on belong to cones, and the columns without bounds.
pub fn split(
    matrix: &CscMatrix<f64>,
    equations: usize,
    cone_of_row: &[usize],
    cones: &[Cone],
) -> (Vec<Block>, Vec<usize>) {
    // Columns that share a cone have the same root.
    let mut root: Vec<usize> = (0..matrix.n).collect();
    let mut first_of_cone = vec![usize::MAX; cones.len()];
    let mut bounded = vec![false; matrix.n];
    let entries = |k: usize| {
        let range = matrix.colptr[k]..matrix.colptr[k + 1];
        let rows = matrix.rowval[range.clone()].iter().copied();
        rows.zip(matrix.nzval[range].iter().copied())
    };
    for k in 0..matrix.n {
        for (row, _) in entries(k).filter(|(row, _)| *row >= equations) {
            let cone = cone_of_row[row - equations];
            bounded[k] = true;
            match first_of_cone[cone] {
                usize::MAX => first_of_cone[cone] = k,
                other => {
                    let (a, b) = (find(&mut root, k), find(&mut root, other));
                    root[a.max(b)] = a.min(b);
                }
            }
        }
    }
    let mut blocks: Vec<Block> = Vec::new();
    let mut block_of_root = vec![usize::MAX; matrix.n];
    for k in (0..matrix.n).filter(|k| bounded[*k]) {
        let own = find(&mut root, k);
        if block_of_root[own] == usize::MAX {
            block_of_root[own] = blocks.len();
            blocks.push(Block::default());
        }
        blocks[block_of_root[own]].columns.push(k);
    }
    for (cone, first) in first_of_cone.iter().enumerate() {
        if *first != usize::MAX {
            blocks[block_of_root[find(&mut root, *first)]]
                .cones
                .push(cone);
        }
    }
    for block in &mut blocks {
        fill(block, equations, cones, &entries);
    }
    (blocks, (0..matrix.n).filter(|k| !bounded[*k]).collect())
}

fn find(root: &mut [usize], mut k: usize) -> usize {
    while root[k] != k {
        root[k] = root[root[k]];
        k = root[k];
    }
    k
}

/// Copies the coefficients of a block.
fn fill<I: Iterator<Item = (usize, f64)>>(
    block: &mut Block,
    equations: usize,
    cones: &[Cone],
    entries: &dyn Fn(usize) -> I,
) {
    let rows = block.columns.iter().flat_map(|k| entries(*k));
    let own = rows.filter(|(row, _)| *row < equations);
    block.equations = own.map(|(row, _)| row).collect();
    block.equations.sort_unstable();
    block.equations.dedup();
    let rows = block.cones.iter().map(|cone| &cones[*cone]);
    block.rows = rows
        .flat_map(|cone| cone.first..cone.first + cone.rows())
        .collect();
    let count = block.rows.len();
    block.own = vec![0.0; block.equations.len() * block.columns.len()];
    block.bounds = vec![0.0; count * block.columns.len()];
    for (c, k) in block.columns.iter().enumerate() {
        for (row, value) in entries(*k) {
            if row < equations {
                if let Ok(e) = block.equations.binary_search(&row) {
                    block.own[c * block.equations.len() + e] += value;
                }
            } else if let Ok(r) = block.rows.binary_search(&(row - equations)) {
                // Cones ascend, and so do their rows.
                block.bounds[c * count + r] += value;
            }
        }
    }
}
