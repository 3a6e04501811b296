//! The stored matrix, for residuals.

use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;

use super::{Kind, LinearError, Pattern};

/// Entries of a chunk: enough for its work to exceed the cost of its scheduling.
const ENTRIES: usize = 60_000;
/// Largest number of chunks. Each has sums of its own.
const CHUNKS: usize = 32;

/// Columns read by one task, and the rows of their entries.
#[derive(Debug)]
struct Chunk {
    columns: Range<usize>,
    rows: Range<usize>,
}

/// A pattern with the last values.
#[derive(Debug)]
pub(super) struct Operator {
    pattern: Arc<Pattern>,
    kind: Kind,
    diagonal: Vec<usize>, // [equation] → entry
    chunks: Vec<Chunk>,
    sums: Vec<f64>,   // [chunk][row][column of the right-hand side]
    values: Vec<f64>, // [entry]
    norm: f64,
    row_sums: Vec<f64>,
    summed: bool,   // whether row_sums belong to these values
    ones: Vec<f64>, // [equation]
}

impl Operator {
    pub fn new(pattern: Arc<Pattern>, kind: Kind) -> Self {
        let n = pattern.n();
        // A `Pattern` has all diagonal entries.
        let diagonal = (0..n).filter_map(|j| pattern.find(j, j)).collect();
        let mut new = Self {
            pattern,
            kind,
            diagonal,
            chunks: Vec::new(),
            sums: Vec::new(),
            values: Vec::new(),
            norm: 0.0,
            row_sums: vec![0.0; n],
            summed: false,
            ones: vec![1.0; n],
        };
        new.chunks = new.cut();
        new
    }

    /// Divides the columns into chunks of similar numbers of entries. The division, and so the sums, does not
    /// depend on threads.
    fn cut(&self) -> Vec<Chunk> {
        let n = self.pattern.n();
        let entries = |j: usize| self.column(j).len();
        let total: usize = (0..n).map(entries).sum();
        let each = ENTRIES.max(total.div_ceil(CHUNKS));
        let (mut chunks, mut start, mut count) = (Vec::new(), 0, 0);
        for j in 0..n {
            count += entries(j);
            if count >= each || j + 1 == n {
                let columns = start..j + 1;
                let rows = columns.clone().map(|j| {
                    let rows = &self.pattern.row_idx()[self.column(j)];
                    // Rows ascend, and the diagonal is among them.
                    [rows[0], rows[rows.len() - 1]].map(|i| i as usize)
                });
                let rows = rows.fold(start..j + 1, |all, [first, last]| {
                    all.start.min(first)..all.end.max(last + 1)
                });
                chunks.push(Chunk { columns, rows });
                (start, count) = (j + 1, 0);
            }
        }
        chunks
    }

    pub fn pattern(&self) -> &Pattern {
        &self.pattern
    }

    /// Last values, where they are read. `[entry]`
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// ‖A‖∞ of the values whose rows were summed last.
    pub fn norm(&self) -> f64 {
        self.norm
    }

    /// Row sums Σ_j |a_ij| of these values. `[equation]`
    pub fn row_sums(&self) -> &[f64] {
        &self.row_sums
    }

    /// Entries of a column that are read.
    fn column(&self, j: usize) -> Range<usize> {
        let col_ptr = self.pattern.col_ptr();
        match self.kind {
            Kind::Symmetric => self.diagonal[j]..col_ptr[j + 1],
            Kind::Unsymmetric => col_ptr[j]..col_ptr[j + 1],
        }
    }

    /// Copies the values that are read.
    ///
    /// # Errors
    /// [`LinearError::Length`].
    pub fn store(&mut self, values: &[f64]) -> Result<(), LinearError> {
        let expected = self.pattern.nnz();
        if values.len() != expected {
            return Err(LinearError::Length {
                what: "matrix values",
                expected,
                got: values.len(),
            });
        }
        self.summed = false;
        let mut own = std::mem::take(&mut self.values);
        own.resize(expected, 0.0);
        let mut rest = &mut own[..];
        let mut tasks = Vec::with_capacity(self.chunks.len());
        for chunk in &self.chunks {
            let start = self.pattern.col_ptr()[chunk.columns.start];
            let end = self.pattern.col_ptr()[chunk.columns.end];
            let (head, tail) = rest.split_at_mut(end - start);
            tasks.push((chunk, start, head));
            rest = tail;
        }
        tasks.into_par_iter().for_each(|(chunk, start, own)| {
            for j in chunk.columns.clone() {
                let column = self.column(j);
                own[column.start - start..column.end - start].copy_from_slice(&values[column]);
            }
        });
        self.values = own;
        Ok(())
    }

    /// Sums the rows of the last values, if needed.
    ///
    /// # Errors
    /// [`LinearError::NotFinite`] if a value is not finite.
    pub fn sum_rows(&mut self) -> Result<(), LinearError> {
        if !self.summed {
            let (mut row_sums, ones) = (
                std::mem::take(&mut self.row_sums),
                std::mem::take(&mut self.ones),
            );
            row_sums.fill(0.0);
            self.add(f64::abs, [&ones], &mut [&mut row_sums]);
            (self.row_sums, self.ones) = (row_sums, ones);
            self.summed = true;
        }
        self.norm = 0.0;
        for (equation, &sum) in self.row_sums.iter().enumerate() {
            if !sum.is_finite() {
                return Err(LinearError::NotFinite { equation });
            }
            self.norm = self.norm.max(sum);
        }
        Ok(())
    }

    /// Y ← Y + g(A) X for C columns, with g applied to each entry. The matrix is read once. Chunks have sums of
    /// their own, which are added in the order of the chunks.
    fn add<const C: usize>(
        &mut self,
        g: impl Fn(f64) -> f64 + Copy + Sync,
        x: [&[f64]; C],
        y: &mut [&mut [f64]; C],
    ) {
        let size = |chunk: &Chunk| C * chunk.rows.len();
        let mut sums = std::mem::take(&mut self.sums);
        sums.resize(self.chunks.iter().map(size).sum(), 0.0);
        let mut rest = &mut sums[..];
        let mut tasks = Vec::with_capacity(self.chunks.len());
        for chunk in &self.chunks {
            let (own, after) = rest.split_at_mut(size(chunk));
            tasks.push((chunk, own));
            rest = after;
        }
        let tasks = tasks.into_par_iter();
        tasks.for_each(|(chunk, sums)| self.sum(chunk, g, x, sums.as_chunks_mut::<C>().0));
        let mut rest = &sums[..];
        for chunk in &self.chunks {
            let (own, after) = rest.split_at(size(chunk));
            for (i, sums) in chunk.rows.clone().zip(own.as_chunks::<C>().0) {
                for c in 0..C {
                    y[c][i] += sums[c];
                }
            }
            rest = after;
        }
        self.sums = sums;
    }

    /// Contribution of a chunk to the rows of g(A) X that it reaches. `[row][column]`
    fn sum<const C: usize>(
        &self,
        chunk: &Chunk,
        g: impl Fn(f64) -> f64,
        x: [&[f64]; C],
        sums: &mut [[f64; C]],
    ) {
        sums.fill([0.0; C]);
        let first = chunk.rows.start;
        for j in chunk.columns.clone() {
            let own = x.map(|x| x[j]);
            let mut column = self.column(j);
            let mut mirrored = [0.0; C];
            if self.kind == Kind::Symmetric {
                // Entry (i, j) with i > j also represents (j, i).
                let diagonal = g(self.values[column.start]);
                mirrored = own.map(|x| diagonal * x);
                column.start += 1;
            }
            let rows = &self.pattern.row_idx()[column.clone()];
            for (&i, a) in rows.iter().zip(&self.values[column]) {
                let a = g(*a);
                let sums = &mut sums[i as usize - first];
                for c in 0..C {
                    sums[c] += a * own[c];
                }
                if self.kind == Kind::Symmetric {
                    for c in 0..C {
                        mirrored[c] += a * x[c][i as usize];
                    }
                }
            }
            for c in 0..C {
                sums[j - first][c] += mirrored[c];
            }
        }
    }

    /// Y = A X. `[column][equation]`
    pub fn multiply(&mut self, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        self.add_columns(|a| a, x, y);
    }

    /// Y ← Y + g(A) X for any number of columns. `[column][equation]`
    fn add_columns(&mut self, g: impl Fn(f64) -> f64 + Copy + Sync, x: &[f64], y: &mut [f64]) {
        let n = self.pattern.n();
        for (x, y) in x.chunks(2 * n).zip(y.chunks_mut(2 * n)) {
            if x.len() > n {
                let (y, y_next) = y.split_at_mut(n);
                self.add(g, [&x[..n], &x[n..]], &mut [y, y_next]);
            } else {
                self.add(g, [x], &mut [y]);
            }
        }
    }

    /// Residual r = b − A x and its size.
    pub fn residual(&mut self, x: &[f64], b: &[f64], r: &mut [f64]) -> Residual {
        let n = self.pattern.n();
        // f64::max ignores NaN, but NaN must be reported here.
        let norm = |v: &[f64]| {
            v.iter().fold(0.0, |m: f64, a| {
                if a.is_nan() {
                    f64::NAN
                } else {
                    m.max(a.abs()) + 0.0 * m
                }
            })
        };
        let mut worst = Residual::default();
        r.copy_from_slice(b);
        self.add_columns(|a| -a, x, r);
        for ((x, b), r) in x.chunks(n).zip(b.chunks(n)).zip(r.chunks(n)) {
            let (top, b) = (norm(r), norm(b));
            if top == 0.0 {
                continue;
            }
            let backward = top / (self.norm * norm(x) + b);
            if backward.is_nan() {
                return Residual {
                    backward,
                    relative: f64::NAN,
                };
            }
            worst.backward = worst.backward.max(backward);
            worst.relative = worst.relative.max(top / b);
        }
        worst
    }
}

/// Size of a residual r = b − A x: the largest over the columns. NaN if any is NaN.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Residual {
    /// ‖r‖∞ / (‖A‖∞ ‖x‖∞ + ‖b‖∞)
    pub backward: f64,
    /// ‖r‖∞ / ‖b‖∞
    pub relative: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::stencils::solid;

    /// The sum of the chunks is A x. Their rows overlap by those of the next layer.
    #[test]
    fn chunks_sum_to_the_product() {
        let (pattern, values) = solid([18, 7, 18], 5.0, 1e-3, 12);
        let n = pattern.n();
        let x: Vec<f64> = (0..2 * n).map(|i| (0.7 * i as f64).sin()).collect();
        let b: Vec<f64> = (0..2 * n).map(|i| (0.3 * i as f64).cos()).collect();
        for kind in [Kind::Symmetric, Kind::Unsymmetric] {
            let mut operator = Operator::new(Arc::new(pattern.clone()), kind);
            operator.store(&values).unwrap();
            operator.sum_rows().unwrap();
            let reach: usize = operator.chunks.iter().map(|c| c.rows.len()).sum();
            assert!(operator.chunks.len() > 3 && reach > n);
            let (mut expected, mut sums) = (b.clone(), vec![0.0; n]);
            for j in 0..n {
                for e in pattern.col_ptr()[j]..pattern.col_ptr()[j + 1] {
                    let i = pattern.row_idx()[e] as usize;
                    let read = match kind {
                        Kind::Symmetric if i < j => pattern.find(j, i).unwrap(),
                        _ => e,
                    };
                    let a = values[read];
                    sums[i] += a.abs();
                    expected[i] -= a * x[j];
                    expected[n + i] -= a * x[n + j];
                }
            }
            // A row has some eighty terms, each with its rounding error.
            let (norm, near) = (operator.norm(), 80.0 * f64::EPSILON);
            let largest = sums.iter().copied().fold(0.0, f64::max);
            assert!((norm / largest - 1.0).abs() < near);
            for (sum, expected) in operator.row_sums().iter().zip(&sums) {
                assert!((sum - expected).abs() < near * norm);
            }
            // Two columns at once, and one alone.
            for columns in [2, 1] {
                let mut r = vec![0.0; columns * n];
                operator.residual(&x[..columns * n], &b[..columns * n], &mut r);
                for (r, expected) in r.iter().zip(&expected) {
                    assert!((r - expected).abs() < near * (norm + 1.0));
                }
            }
        }
    }
}
