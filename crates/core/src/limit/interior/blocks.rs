//! Blocks of unknowns that inequalities couple: the forces at a corner, or at all corners of a joint.

use std::ops::Range;

use clarabel::algebra::CscMatrix;

use super::cones::Cone;

/// Unknowns that inequalities couple, with their part of the matrix. Numbers are those of [`Split`].
#[derive(Clone, Debug, Default)]
pub struct Block {
    /// Columns of the unknowns.
    pub columns: Range<usize>,
    /// Rows of the cones.
    pub rows: Range<usize>,
    /// The cones.
    pub cones: Range<usize>,
    /// Equations with one of the unknowns, ascending.
    pub equations: Vec<usize>,
    /// Coefficients in the equations. `[column][equation]`
    pub own: Vec<f64>,
    /// Coefficients in the rows. `[column][row]`
    bounds: Vec<f64>,
    /// W⁻¹ times `bounds`.
    scaled: Vec<f64>,
    /// R of the Householder factors Q R of `scaled`, upper triangle. `[column][row]`
    upper: Vec<f64>,
    /// R⁻ᵀ times the coefficients in the equations. `[column][equation]`
    pub lifted: Vec<f64>,
}

/// to += factor × v.
fn add(to: &mut [f64], factor: f64, v: &[f64]) {
    to.iter_mut().zip(v).for_each(|(t, v)| *t += factor * v);
}

/// Σ a b of a few numbers.
fn sum(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl Block {
    /// Factorises with the scaling of all cones; false if an unknown has no bound.
    pub fn factorise(&mut self, cones: &[Cone]) -> bool {
        let (rows, count) = (self.rows.len(), self.columns.len());
        self.scaled.clone_from(&self.bounds);
        for column in self.scaled.chunks_exact_mut(rows) {
            for cone in &cones[self.cones.clone()] {
                cone.unapply(&mut column[cone.first - self.rows.start..][..cone.rows()]);
            }
        }
        if !triangle(&self.scaled, rows, count, &mut self.upper) {
            return false;
        }
        let equations = self.equations.len();
        self.lifted.clone_from(&self.own);
        for k in 0..count {
            let (done, rest) = self.lifted.split_at_mut(k * equations);
            let column = &self.upper[k * rows.max(count)..];
            let own = &mut rest[..equations];
            for (j, other) in done.chunks_exact(equations.max(1)).enumerate() {
                add(own, -column[j], other);
            }
            for v in own {
                *v /= column[k];
            }
        }
        true
    }

    /// g ← R⁻ᵀ g.
    fn lift(&self, g: &mut [f64]) {
        let stride = self.rows.len().max(g.len());
        for k in 0..g.len() {
            let column = &self.upper[k * stride..];
            for j in 0..k {
                g[k] -= column[j] * g[j];
            }
            g[k] /= column[k];
        }
    }

    /// p ← R⁻¹ p.
    fn lower(&self, p: &mut [f64]) {
        let stride = self.rows.len().max(p.len());
        for k in (0..p.len()).rev() {
            for j in k + 1..p.len() {
                p[k] -= self.upper[j * stride + k] * p[j];
            }
            p[k] /= self.upper[k * stride + k];
        }
    }

    /// v ← W⁻¹ v on own rows.
    fn unapply(&self, cones: &[Cone], v: &mut [f64]) {
        for cone in &cones[self.cones.clone()] {
            cone.unapply(&mut v[cone.first - self.rows.start..][..cone.rows()]);
        }
    }

    /// Eliminates own unknowns: of right sides x and z, x ← R⁻ᵀ (x + (W⁻¹A)'W⁻¹z) and z ← W⁻¹z, and y += E R⁻¹x.
    /// `local` holds one number for each equation.
    pub fn eliminate(
        &self,
        cones: &[Cone],
        [x, z]: [&mut [f64]; 2],
        y: &mut [f64],
        local: &mut Vec<f64>,
    ) {
        self.unapply(cones, z);
        for (p, column) in x.iter_mut().zip(self.scaled.chunks_exact(z.len())) {
            *p += sum(column, z);
        }
        self.lift(x);
        local.clear();
        local.resize(self.equations.len(), 0.0);
        for (p, column) in x.iter().zip(self.lifted.chunks_exact(local.len().max(1))) {
            add(local, *p, column);
        }
        for (e, v) in self.equations.iter().zip(&*local) {
            y[*e] += v;
        }
    }

    /// Own unknowns for a solution y of all equations, after [`Block::eliminate`].
    pub fn substitute(
        &self,
        cones: &[Cone],
        [x, z]: [&mut [f64]; 2],
        y: &[f64],
        local: &mut Vec<f64>,
    ) {
        local.clear();
        local.extend(self.equations.iter().map(|e| y[*e]));
        for (p, column) in x
            .iter_mut()
            .zip(self.lifted.chunks_exact(local.len().max(1)))
        {
            *p -= sum(column, local);
        }
        self.lower(x);
        // z = W⁻¹ (W⁻¹A x − W⁻¹ r_z)
        for v in z.iter_mut() {
            *v = -*v;
        }
        for (p, column) in x.iter().zip(self.scaled.chunks_exact(z.len())) {
            add(z, *p, column);
        }
        self.unapply(cones, z);
    }

    /// E'y + A'z and A x of own unknowns and rows into `products`, and y's += E x.
    pub fn multiply(
        &self,
        [x, y, z]: [&[f64]; 3],
        products: [&mut [f64]; 2],
        sums: &mut [f64],
        local: &mut Vec<f64>,
    ) {
        let (x, z) = (&x[self.columns.clone()], &z[self.rows.clone()]);
        let [back, along] = products;
        local.clear();
        local.extend(self.equations.iter().map(|e| y[*e]));
        local.resize(2 * self.equations.len(), 0.0);
        let count = self.equations.len();
        let (own_y, own_sums) = local.split_at_mut(count);
        along.fill(0.0);
        for (c, (p, back)) in x.iter().zip(back).enumerate() {
            let column = &self.own[c * count..][..count];
            let bound = &self.bounds[c * z.len()..][..z.len()];
            *back = sum(column, own_y) + sum(bound, z);
            add(own_sums, *p, column);
            add(along, *p, bound);
        }
        for (e, v) in self.equations.iter().zip(&*own_sums) {
            sums[*e] += v;
        }
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

/// A matrix in blocks. Columns, rows and cones are numbered anew, block after block; columns without bounds come last.
#[derive(Debug)]
pub struct Split {
    /// Blocks.
    pub blocks: Vec<Block>,
    /// Cones by their new numbers.
    pub cones: Vec<Cone>,
    /// Old number of each column.
    pub columns: Vec<usize>,
    /// Number of columns with bounds.
    pub bounded: usize,
    /// Old number of each row, after the equations.
    pub rows: Vec<usize>,
}

impl Split {
    /// Blocks of a matrix whose rows from `equations` on belong to cones.
    pub fn of(
        matrix: &CscMatrix<f64>,
        equations: usize,
        cone_of_row: &[usize],
        cones: &[Cone],
    ) -> Self {
        let entries = |k: usize| {
            let range = matrix.colptr[k]..matrix.colptr[k + 1];
            let rows = matrix.rowval[range.clone()].iter().copied();
            rows.zip(matrix.nzval[range].iter().copied())
        };
        // Columns that share a cone have the same root.
        let mut root: Vec<usize> = (0..matrix.n).collect();
        let mut first_of_cone = vec![usize::MAX; cones.len()];
        let mut bounded = vec![false; matrix.n];
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
        let mut members: Vec<[Vec<usize>; 2]> = Vec::new();
        let mut block_of_root = vec![usize::MAX; matrix.n];
        for k in (0..matrix.n).filter(|k| bounded[*k]) {
            let own = find(&mut root, k);
            if block_of_root[own] == usize::MAX {
                block_of_root[own] = members.len();
                members.push([Vec::new(), Vec::new()]);
            }
            members[block_of_root[own]][0].push(k);
        }
        for (cone, first) in first_of_cone.iter().enumerate() {
            if *first != usize::MAX {
                members[block_of_root[find(&mut root, *first)]][1].push(cone);
            }
        }
        let mut split = Self {
            blocks: Vec::with_capacity(members.len()),
            cones: Vec::with_capacity(cones.len()),
            columns: Vec::with_capacity(matrix.n),
            bounded: 0,
            rows: Vec::with_capacity(cone_of_row.len()),
        };
        for [columns, own_cones] in members {
            let own_cones = own_cones.into_iter().map(|cone| &cones[cone]);
            split.append(&columns, own_cones, equations, &entries);
        }
        split.bounded = split.columns.len();
        let free = (0..matrix.n).filter(|k| !bounded[*k]);
        split.columns.extend(free);
        split
    }

    /// Appends a block of columns and cones.
    fn append<'a, I: Iterator<Item = (usize, f64)>>(
        &mut self,
        columns: &[usize],
        cones: impl Iterator<Item = &'a Cone>,
        equations: usize,
        entries: &dyn Fn(usize) -> I,
    ) {
        let starts = [self.columns.len(), self.rows.len(), self.cones.len()];
        self.columns.extend(columns);
        for cone in cones {
            self.cones.push(Cone::new(cone.shape, self.rows.len()));
            self.rows.extend(cone.first..cone.first + cone.rows());
        }
        let rows = columns.iter().flat_map(|k| entries(*k));
        let own = rows.filter(|(row, _)| *row < equations);
        let mut block = Block {
            columns: starts[0]..self.columns.len(),
            rows: starts[1]..self.rows.len(),
            cones: starts[2]..self.cones.len(),
            equations: own.map(|(row, _)| row).collect(),
            ..Block::default()
        };
        block.equations.sort_unstable();
        block.equations.dedup();
        let (stride, count) = (block.equations.len(), block.rows.len());
        block.own = vec![0.0; stride * columns.len()];
        block.bounds = vec![0.0; count * columns.len()];
        for (c, k) in columns.iter().enumerate() {
            for (row, value) in entries(*k) {
                if row < equations {
                    if let Ok(e) = block.equations.binary_search(&row) {
                        block.own[c * stride + e] += value;
                    }
                } else if let Ok(r) = self.rows[starts[1]..].binary_search(&(row - equations)) {
                    // Cones ascend, and so do their rows.
                    block.bounds[c * count + r] += value;
                }
            }
        }
        self.blocks.push(block);
    }
}

fn find(root: &mut [usize], mut k: usize) -> usize {
    while root[k] != k {
        root[k] = root[root[k]];
        k = root[k];
    }
    k
}
