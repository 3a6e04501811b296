//! Equations of a step of the interior-point method, reduced to the motions of the bodies: a stiffness matrix with one
//! stiffness for each block.

use super::blocks::Block;
use super::cones::Cone;
use crate::linear::{Backend, LinearSolver, Options, Pattern, dot};

/// Largest number of unknowns without bounds.
const MOST_FREE: usize = 60;
/// Additions to the diagonal over its value, the first one that gives factors. Refinement removes their effect.
const ADDED: [f64; 4] = [1e-14, 1e-12, 1e-10, 1e-8];
/// Part of the right side below which a residual needs no refinement.
const ENOUGH: f64 = 1e-11;
/// Most refinements of a solution.
const REFINEMENTS: usize = 3;

/// Right side or solution: of the unknowns, of the equations, of the rows of cones.
#[derive(Clone, Debug, Default)]
pub struct Parts {
    /// x. `[column]`
    pub x: Vec<f64>,
    /// y. `[equation]`
    pub y: Vec<f64>,
    /// z. `[row of a cone]`
    pub z: Vec<f64>,
}

/// The equations E'y + A'z = r_x, E x = r_y, A x − W² z = r_z.
#[derive(Debug)]
pub struct Normal {
    /// Blocks.
    pub blocks: Vec<Block>,
    /// Columns without bounds.
    pub free: Vec<usize>,
    /// Their coefficients in the equations. `[free column]`
    free_entries: Vec<Vec<(usize, f64)>>,
    solver: LinearSolver,
    values: Vec<f64>,
    /// Entries of the diagonal. `[equation]`
    diagonal: Vec<usize>,
    /// Entry of the matrix for each pair of equations of a block. `[block]`
    places: Vec<Vec<u32>>,
    /// S⁻¹ times the coefficients of the free columns. `[free column][equation]`
    through: Vec<f64>,
    /// Inverse of the Schur complement of the free columns.
    free_inverse: nalgebra::DMatrix<f64>,
    equations: usize,
}

/// Node of each equation, and places of the nodes [mm], for the order of elimination.
pub type Nodes<'a> = (&'a [u32], &'a [[f64; 3]]);

impl Normal {
    /// Analyses the blocks. `None` if there are many free unknowns, or too many equations for the linear solver.
    pub fn new(
        blocks: Vec<Block>,
        free_entries: Vec<(usize, Vec<(usize, f64)>)>,
        equations: usize,
        nodes: Nodes<'_>,
    ) -> Option<Self> {
        if free_entries.len() > MOST_FREE {
            return None;
        }
        let pattern = pattern(&blocks, equations)?;
        let pattern = pattern.with_nodes(nodes.0, nodes.1).ok()?;
        let (starts, rows) = (pattern.col_ptr().to_vec(), pattern.row_idx().to_vec());
        let mut places: Vec<Vec<u32>> = Vec::with_capacity(blocks.len());
        for (b, block) in blocks.iter().enumerate() {
            if b > 0 && blocks[b - 1].equations == block.equations {
                places.push(Vec::new());
                continue;
            }
            let mut own = Vec::with_capacity(block.equations.len().pow(2));
            for j in &block.equations {
                let column = &rows[starts[*j]..starts[*j + 1]];
                for i in &block.equations {
                    let at = column.binary_search(&(*i as u32)).ok()?;
                    own.push((starts[*j] + at) as u32);
                }
            }
            places.push(own);
        }
        let diagonal = (0..equations).filter_map(|j| {
            let column = &rows[starts[j]..starts[j + 1]];
            Some(starts[j] + column.binary_search(&(j as u32)).ok()?)
        });
        let diagonal = diagonal.collect();
        let options = Options {
            // Solutions are refined with the whole system, so that accuracy is decided there.
            refinements: 0,
            accept: 1e-2,
            ..Options::new(Backend::MultifrontalLlt)
        };
        let solver = LinearSolver::analyse_beside(pattern, options, None).ok()?;
        let (free, free_entries): (Vec<usize>, Vec<_>) = free_entries.into_iter().unzip();
        Some(Self {
            values: vec![0.0; rows.len()],
            diagonal,
            through: vec![0.0; free.len() * equations],
            free_inverse: nalgebra::DMatrix::zeros(free.len(), free.len()),
            blocks,
            free,
            free_entries,
            solver,
            places,
            equations,
        })
    }

    /// Factorises with the scaling of the cones; false if a matrix is singular.
    pub fn factorise(&mut self, cones: &[Cone]) -> bool {
        self.values.fill(0.0);
        let mut at = 0;
        for (b, block) in self.blocks.iter_mut().enumerate() {
            if !block.factorise(cones) {
                return false;
            }
            if !self.places[b].is_empty() {
                at = b;
            }
            let count = block.columns.len();
            let mut places = self.places[at].iter();
            for left in block.lifted.chunks_exact(count) {
                for (right, place) in block.lifted.chunks_exact(count).zip(places.by_ref()) {
                    let product = dot(left, right);
                    self.values[*place as usize] += product;
                }
            }
        }
        // A mechanism that is almost free makes the matrix almost singular.
        let mut before = 1.0;
        ADDED.into_iter().any(|added| {
            for at in &self.diagonal {
                self.values[*at] *= (1.0 + added) / before;
            }
            before = 1.0 + added;
            self.solver.factorise(&self.values).is_ok() && self.reduce()
        })
    }

    /// Schur complement of the free columns.
    fn reduce(&mut self) -> bool {
        let count = self.free.len();
        self.through.fill(0.0);
        for (f, entries) in self.free_entries.iter().enumerate() {
            for (row, value) in entries {
                self.through[f * self.equations + row] = *value;
            }
        }
        if self.solver.solve(&mut self.through).is_err() {
            return false;
        }
        let product = |f: usize, g: usize| {
            let column = &self.through[g * self.equations..];
            let entries = self.free_entries[f].iter();
            entries
                .map(|(row, value)| value * column[*row])
                .sum::<f64>()
        };
        let schur = nalgebra::DMatrix::from_fn(count, count, product);
        let inverse = schur.try_inverse();
        inverse.is_some_and(|inverse| {
            self.free_inverse = inverse;
            true
        })
    }

    /// Solves for a right side, refined with the whole system.
    pub fn solve(&mut self, right: &Parts, cones: &[Cone]) -> Option<Parts> {
        let mut found = self.solve_once(right, cones)?;
        let mut miss = self.miss(&found, right, cones);
        let mut worst = largest(&miss);
        for _ in 0..REFINEMENTS {
            if worst <= ENOUGH * largest(right).max(f64::MIN_POSITIVE) {
                break;
            }
            let mut better = self.solve_once(&miss, cones)?;
            for (new, old) in [
                (&mut better.x, &found.x),
                (&mut better.y, &found.y),
                (&mut better.z, &found.z),
            ] {
                new.iter_mut().zip(old).for_each(|(n, o)| *n += o);
            }
            let next = self.miss(&better, right, cones);
            let size = largest(&next);
            if size.is_nan() || size >= worst {
                break;
            }
            let stalls = size > 0.5 * worst;
            (found, miss, worst) = (better, next, size);
            if stalls {
                break;
            }
        }
        worst.is_finite().then_some(found)
    }

    fn solve_once(&mut self, right: &Parts, cones: &[Cone]) -> Option<Parts> {
        let mut z = right.z.clone();
        for cone in cones {
            cone.unapply(cone.of_mut(&mut z));
        }
        let mut x = vec![0.0; right.x.len()];
        let mut y: Vec<f64> = right.y.iter().map(|r| -r).collect();
        let mut own = Vec::new();
        for block in &self.blocks {
            gather(block, &z, &mut own);
            let rows = block.rows.len();
            let mut lifted: Vec<f64> = block.columns.iter().map(|k| right.x[*k]).collect();
            for (g, column) in lifted.iter_mut().zip(block.scaled.chunks_exact(rows)) {
                *g += dot(column, &own);
            }
            block.lift(&mut lifted);
            for (e, column) in block
                .equations
                .iter()
                .zip(block.lifted.chunks_exact(lifted.len()))
            {
                y[*e] += dot(column, &lifted);
            }
            block
                .columns
                .iter()
                .zip(&lifted)
                .for_each(|(k, p)| x[*k] = *p);
        }
        self.solver.solve(&mut y).ok()?;
        self.add_free(&right.x, &mut x, &mut y);
        for block in &self.blocks {
            let mut p: Vec<f64> = block.columns.iter().map(|k| x[*k]).collect();
            for (e, column) in block
                .equations
                .iter()
                .zip(block.lifted.chunks_exact(p.len()))
            {
                p.iter_mut().zip(column).for_each(|(p, v)| *p -= v * y[*e]);
            }
            block.lower(&mut p);
            block.columns.iter().zip(&p).for_each(|(k, p)| x[*k] = *p);
            // z = W⁻¹ (B x − W⁻¹ r_z)
            gather(block, &z, &mut own);
            for v in &mut own {
                *v = -*v;
            }
            for (p, column) in p.iter().zip(block.scaled.chunks_exact(block.rows.len())) {
                own.iter_mut().zip(column).for_each(|(v, a)| *v += a * p);
            }
            let mut first = 0;
            for cone in block.cones.iter().map(|cone| &cones[*cone]) {
                cone.unapply(&mut own[first..first + cone.rows()]);
                first += cone.rows();
            }
            block.rows.iter().zip(&own).for_each(|(r, v)| z[*r] = *v);
        }
        Some(Parts { x, y, z })
    }

    /// Adds the free unknowns to y = S⁻¹ h: x_F = (F'S⁻¹F)⁻¹ (g_F − F'y), y += S⁻¹F x_F.
    fn add_free(&self, right: &[f64], x: &mut [f64], y: &mut [f64]) {
        let miss = |f: usize| {
            let entries = self.free_entries[f].iter();
            let along: f64 = entries.map(|(row, value)| value * y[*row]).sum();
            right[self.free[f]] - along
        };
        let miss =
            nalgebra::DVector::from_iterator(self.free.len(), (0..self.free.len()).map(miss));
        let found = &self.free_inverse * miss;
        for (f, value) in found.iter().enumerate() {
            x[self.free[f]] = *value;
            let column = &self.through[f * self.equations..][..self.equations];
            y.iter_mut().zip(column).for_each(|(y, t)| *y += t * value);
        }
    }

    /// Residual of the whole system.
    fn miss(&self, found: &Parts, right: &Parts, cones: &[Cone]) -> Parts {
        let mut miss = right.clone();
        let product = self.multiply(&found.x);
        let back = self.multiply_back(&found.y, &found.z, right.x.len());
        miss.x.iter_mut().zip(&back).for_each(|(m, b)| *m -= b);
        miss.y.iter_mut().zip(&product.y).for_each(|(m, p)| *m -= p);
        let mut squared = found.z.clone();
        for cone in cones {
            let own = cone.of_mut(&mut squared);
            cone.apply(own);
            cone.apply(own);
        }
        let rows = miss.z.iter_mut().zip(&product.z).zip(&squared);
        rows.for_each(|((m, p), w)| *m -= p - w);
        miss
    }

    /// E x and A x.
    pub fn multiply(&self, x: &[f64]) -> Parts {
        let mut y = vec![0.0; self.equations];
        let rows = self.blocks.iter().map(|block| block.rows.len()).sum();
        let mut z = vec![0.0; rows];
        for block in &self.blocks {
            for (c, k) in block.columns.iter().enumerate() {
                let count = block.equations.len();
                let own = &block.own[c * count..(c + 1) * count];
                block
                    .equations
                    .iter()
                    .zip(own)
                    .for_each(|(e, a)| y[*e] += a * x[*k]);
                let bounds = &block.bounds[c * block.rows.len()..(c + 1) * block.rows.len()];
                block
                    .rows
                    .iter()
                    .zip(bounds)
                    .for_each(|(r, a)| z[*r] += a * x[*k]);
            }
        }
        for (entries, k) in self.free_entries.iter().zip(&self.free) {
            for (row, a) in entries {
                y[*row] += a * x[*k];
            }
        }
        Parts {
            x: Vec::new(),
            y,
            z,
        }
    }

    /// E'y + A'z.
    pub fn multiply_back(&self, y: &[f64], z: &[f64], columns: usize) -> Vec<f64> {
        let mut x = vec![0.0; columns];
        for block in &self.blocks {
            let equations = block.equations.len();
            for (c, k) in block.columns.iter().enumerate() {
                let own = block.own[c * equations..].iter().zip(&block.equations);
                let bounds = block.bounds[c * block.rows.len()..].iter().zip(&block.rows);
                x[*k] = own.map(|(a, e)| a * y[*e]).sum::<f64>()
                    + bounds.map(|(a, r)| a * z[*r]).sum::<f64>();
            }
        }
        for (entries, k) in self.free_entries.iter().zip(&self.free) {
            x[*k] = entries.iter().map(|(row, a)| a * y[*row]).sum();
        }
        x
    }
}

/// Own rows of a block.
fn gather(block: &Block, z: &[f64], own: &mut Vec<f64>) {
    own.clear();
    own.extend(block.rows.iter().map(|r| z[*r]));
}

/// Largest absolute value.
fn largest(parts: &Parts) -> f64 {
    let all = parts.x.iter().chain(&parts.y).chain(&parts.z);
    // NaN stays.
    all.fold(
        0.0,
        |most: f64, v| if v.abs() <= most { most } else { v.abs() },
    )
}

/// Pattern of the equations: those of one block couple.
fn pattern(blocks: &[Block], equations: usize) -> Option<Pattern> {
    let mut coupled: Vec<Vec<u32>> = (0..equations).map(|e| vec![e as u32]).collect();
    let mut last: &[usize] = &[];
    for block in blocks {
        if block.equations == last {
            continue;
        }
        last = &block.equations;
        for j in &block.equations {
            coupled[*j].extend(block.equations.iter().map(|i| *i as u32));
        }
    }
    let mut starts = vec![0];
    let mut rows = Vec::new();
    for mut column in coupled {
        column.sort_unstable();
        column.dedup();
        rows.extend(column);
        starts.push(rows.len());
    }
    Pattern::new(equations, starts, rows).ok()
}
