//! Equations of a step of the interior-point method, reduced to the motions of the bodies: a stiffness matrix with one
//! stiffness for each block.

use std::ops::Range;

use rayon::prelude::*;

use super::blocks::Block;
use super::cones::Cone;
use crate::linear::{Backend, LinearSolver, Options, Pattern};

/// Largest number of unknowns without bounds.
const MOST_FREE: usize = 60;
/// Additions to the diagonal over its value, the first one that gives factors. Refinement removes their effect.
const ADDED: [f64; 4] = [1e-14, 1e-12, 1e-10, 1e-8];
/// Part of the right side below which a residual needs no refinement.
const ENOUGH: f64 = 1e-11;
/// Most refinements of a solution.
const REFINEMENTS: usize = 3;
/// Blocks that one thread takes at a time. Sums are added in the order of these chunks, so that they have the same bits
/// on any number of threads.
const CHUNK: usize = 2000;

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

/// Blocks that one thread takes at a time.
#[derive(Clone, Debug)]
struct Chunk {
    blocks: Range<usize>,
    columns: usize,
    rows: usize,
}

impl Chunk {
    fn all(blocks: &[Block]) -> Vec<Self> {
        let chunks = blocks.chunks(CHUNK).enumerate().map(|(c, own)| Self {
            blocks: c * CHUNK..c * CHUNK + own.len(),
            columns: own.iter().map(|block| block.columns.len()).sum(),
            rows: own.iter().map(|block| block.rows.len()).sum(),
        });
        chunks.collect()
    }
}

/// Pieces of a vector by their lengths.
fn pieces(mut v: &mut [f64], lengths: impl Iterator<Item = usize>) -> Vec<&mut [f64]> {
    let mut pieces = Vec::new();
    for length in lengths {
        let (piece, rest) = std::mem::take(&mut v).split_at_mut(length);
        pieces.push(piece);
        v = rest;
    }
    pieces
}

/// The equations E'y + A'z = r_x, E x = r_y, A x − W² z = r_z.
#[derive(Debug)]
pub struct Normal {
    blocks: Vec<Block>,
    chunks: Vec<Chunk>,
    /// Coefficients of the columns without bounds, which follow those with bounds, in the equations. `[free column]`
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
        free_entries: Vec<Vec<(usize, f64)>>,
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
        let free = free_entries.len();
        Some(Self {
            values: vec![0.0; rows.len()],
            diagonal,
            through: vec![0.0; free * equations],
            free_inverse: nalgebra::DMatrix::zeros(free, free),
            chunks: Chunk::all(&blocks),
            blocks,
            free_entries,
            solver,
            places,
            equations,
        })
    }

    /// Factorises with the scaling of the cones; false if a matrix is singular.
    pub fn factorise(&mut self, cones: &[Cone]) -> bool {
        let factorised = |block: &mut Block| block.factorise(cones);
        if !self
            .blocks
            .par_iter_mut()
            .with_min_len(CHUNK)
            .all(factorised)
        {
            return false;
        }
        self.assemble();
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

    /// The matrix E (A'W⁻²A)⁻¹ E'. Blocks of the same equations are added before.
    fn assemble(&mut self) {
        self.values.fill(0.0);
        let mut local: Vec<f64> = Vec::new();
        let mut first = 0;
        while first < self.blocks.len() {
            let others = self.places[first + 1..].iter();
            let next = first + 1 + others.take_while(|places| places.is_empty()).count();
            let count = self.blocks[first].equations.len();
            local.clear();
            local.resize(count * count, 0.0);
            for block in &self.blocks[first..next] {
                for column in block.lifted.chunks_exact(count.max(1)) {
                    for (sums, left) in local.chunks_exact_mut(count).zip(column) {
                        sums.iter_mut()
                            .zip(column)
                            .for_each(|(s, v)| *s += left * v);
                    }
                }
            }
            for (place, value) in self.places[first].iter().zip(&local) {
                self.values[*place as usize] += value;
            }
            first = next;
        }
    }

    /// Schur complement of the free columns.
    fn reduce(&mut self) -> bool {
        let count = self.free_entries.len();
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
        let (mut x, mut z) = (right.x.clone(), right.z.clone());
        let mut y: Vec<f64> = right.y.iter().map(|r| -r).collect();
        let eliminated = self.parts(&mut x, &mut z).map(|(chunk, x, z)| {
            let mut sums = vec![0.0; self.equations];
            let mut local = Vec::new();
            for (block, parts) in own_parts(&self.blocks[chunk.blocks.clone()], x, z) {
                block.eliminate(cones, parts, &mut sums, &mut local);
            }
            sums
        });
        for sums in eliminated.collect::<Vec<_>>() {
            y.iter_mut().zip(sums).for_each(|(y, s)| *y += s);
        }
        self.solver.solve(&mut y).ok()?;
        self.add_free(&right.x, &mut x, &mut y);
        self.parts(&mut x, &mut z).for_each(|(chunk, x, z)| {
            let mut local = Vec::new();
            for (block, parts) in own_parts(&self.blocks[chunk.blocks.clone()], x, z) {
                block.substitute(cones, parts, &y, &mut local);
            }
        });
        Some(Parts { x, y, z })
    }

    /// Chunks with their parts of unknowns and of rows.
    fn parts<'a>(
        &'a self,
        x: &'a mut [f64],
        z: &'a mut [f64],
    ) -> impl IndexedParallelIterator<Item = (&'a Chunk, &'a mut [f64], &'a mut [f64])> {
        let x = pieces(x, self.chunks.iter().map(|chunk| chunk.columns));
        let z = pieces(z, self.chunks.iter().map(|chunk| chunk.rows));
        let both = x.into_par_iter().zip(z);
        self.chunks
            .par_iter()
            .zip(both)
            .map(|(chunk, (x, z))| (chunk, x, z))
    }

    /// Number of the first column without bounds.
    fn bounded(&self) -> usize {
        self.chunks.iter().map(|chunk| chunk.columns).sum()
    }

    /// Adds the free unknowns to y = S⁻¹ h: x_F = (F'S⁻¹F)⁻¹ (g_F − F'y), y += S⁻¹F x_F.
    fn add_free(&self, right: &[f64], x: &mut [f64], y: &mut [f64]) {
        let bounded = self.bounded();
        let miss = self.free_entries.iter().zip(&right[bounded..]);
        let miss = miss.map(|(entries, right)| right - along(entries, y));
        let miss = nalgebra::DVector::from_iterator(self.free_entries.len(), miss);
        let found = &self.free_inverse * miss;
        for (f, value) in found.iter().enumerate() {
            x[bounded + f] = *value;
            let column = &self.through[f * self.equations..][..self.equations];
            y.iter_mut().zip(column).for_each(|(y, t)| *y += t * value);
        }
    }

    /// Residual of the whole system.
    fn miss(&self, found: &Parts, right: &Parts, cones: &[Cone]) -> Parts {
        let mut miss = right.clone();
        let product = self.multiply(&found.x, &found.y, &found.z);
        let subtract = |miss: &mut [f64], product: &[f64]| {
            miss.iter_mut().zip(product).for_each(|(m, p)| *m -= p);
        };
        subtract(&mut miss.x, &product.x);
        subtract(&mut miss.y, &product.y);
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

    /// E'y + A'z, E x and A x.
    pub fn multiply(&self, x: &[f64], y: &[f64], z: &[f64]) -> Parts {
        let mut product = Parts {
            x: vec![0.0; x.len()],
            y: vec![0.0; self.equations],
            z: vec![0.0; z.len()],
        };
        let parts = self.parts(&mut product.x, &mut product.z);
        let sums = parts.map(|(chunk, back, along)| {
            let mut sums = vec![0.0; self.equations];
            let mut local = Vec::new();
            for (block, parts) in own_parts(&self.blocks[chunk.blocks.clone()], back, along) {
                block.multiply([x, y, z], parts, &mut sums, &mut local);
            }
            sums
        });
        for sums in sums.collect::<Vec<_>>() {
            product.y.iter_mut().zip(sums).for_each(|(y, s)| *y += s);
        }
        let free = self.bounded();
        for (k, entries) in self.free_entries.iter().enumerate() {
            for (row, a) in entries {
                product.y[*row] += a * x[free + k];
            }
            product.x[free + k] = along(entries, y);
        }
        product
    }
}

/// Σ a y over the entries of a column.
fn along(entries: &[(usize, f64)], y: &[f64]) -> f64 {
    entries.iter().map(|(row, a)| a * y[*row]).sum()
}

/// Blocks with their parts of those of a chunk.
fn own_parts<'a>(
    blocks: &'a [Block],
    x: &'a mut [f64],
    z: &'a mut [f64],
) -> impl Iterator<Item = (&'a Block, [&'a mut [f64]; 2])> {
    let x = pieces(x, blocks.iter().map(|block| block.columns.len()));
    let z = pieces(z, blocks.iter().map(|block| block.rows.len()));
    let both = x.into_iter().zip(z).map(|(x, z)| [x, z]);
    blocks.iter().zip(both)
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
