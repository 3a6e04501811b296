//! The matrix itself, kept for residuals.

use std::sync::Arc;

use super::{Kind, LinearError, Pattern};

/// A pattern with the last values, read as its kind says.
#[derive(Debug)]
pub(super) struct Operator {
    pattern: Arc<Pattern>,
    kind: Kind,
    diagonal: Vec<usize>, // [equation] → entry
    values: Vec<f64>,     // [entry]
    norm: f64,
    row_sums: Vec<f64>,
}

impl Operator {
    pub fn new(pattern: Arc<Pattern>, kind: Kind) -> Self {
        let n = pattern.n();
        // `Pattern` has every diagonal entry.
        let diagonal = (0..n).filter_map(|j| pattern.find(j, j)).collect();
        Self {
            pattern,
            kind,
            diagonal,
            values: Vec::new(),
            norm: 0.0,
            row_sums: vec![0.0; n],
        }
    }

    pub fn pattern(&self) -> &Pattern {
        &self.pattern
    }

    /// The last values. `[entry]`
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// ‖A‖∞ of the last values.
    pub fn norm(&self) -> f64 {
        self.norm
    }

    /// Σ_j |a_ij| of the last values. `[equation]`
    pub fn row_sums(&self) -> &[f64] {
        &self.row_sums
    }

    /// First entry of a column that is read.
    fn first(&self, j: usize) -> usize {
        match self.kind {
            Kind::Symmetric => self.diagonal[j],
            Kind::Unsymmetric => self.pattern.col_ptr()[j],
        }
    }

    /// Copies the values and refuses those that are not finite.
    pub fn store(&mut self, values: &[f64]) -> Result<(), LinearError> {
        let expected = self.pattern.nnz();
        if values.len() != expected {
            return Err(LinearError::Length {
                what: "matrix values",
                expected,
                got: values.len(),
            });
        }
        self.values.clear();
        self.values.extend_from_slice(values);
        self.row_sums.fill(0.0);
        for j in 0..self.pattern.n() {
            let end = self.pattern.col_ptr()[j + 1];
            let start = self.first(j);
            let rows = &self.pattern.row_idx()[start..end];
            let sums = &mut self.row_sums;
            let mut mirrored = 0.0;
            for (&i, a) in rows.iter().zip(&values[start..end]) {
                sums[i as usize] += a.abs();
                mirrored += a.abs();
            }
            if self.kind == Kind::Symmetric {
                sums[j] += mirrored - values[start].abs();
            }
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

    /// Y ← Y − A X of C columns, for which the matrix is read once.
    fn subtract<const C: usize>(&self, x: [&[f64]; C], y: &mut [&mut [f64]; C]) {
        let (col_ptr, row_idx) = (self.pattern.col_ptr(), self.pattern.row_idx());
        for j in 0..self.pattern.n() {
            let own = x.map(|x| x[j]);
            let end = col_ptr[j + 1];
            match self.kind {
                Kind::Unsymmetric => {
                    let range = col_ptr[j]..end;
                    for (&i, a) in row_idx[range.clone()].iter().zip(&self.values[range]) {
                        for c in 0..C {
                            y[c][i as usize] -= a * own[c];
                        }
                    }
                }
                Kind::Symmetric => {
                    // (i, j) with i > j stands for (j, i) too.
                    let mut sum = own.map(|x| self.values[self.diagonal[j]] * x);
                    let range = self.diagonal[j] + 1..end;
                    for (&i, a) in row_idx[range.clone()].iter().zip(&self.values[range]) {
                        for c in 0..C {
                            y[c][i as usize] -= a * own[c];
                            sum[c] += a * x[c][i as usize];
                        }
                    }
                    for c in 0..C {
                        y[c][j] -= sum[c];
                    }
                }
            }
        }
    }

    /// r = b − A x, and how large it is.
    pub fn residual(&self, x: &[f64], b: &[f64], r: &mut [f64]) -> Residual {
        let n = self.pattern.n();
        // f64::max drops NaN; this must not.
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
        for (x, r) in x.chunks(2 * n).zip(r.chunks_mut(2 * n)) {
            if x.len() > n {
                let (r, r_next) = r.split_at_mut(n);
                self.subtract([&x[..n], &x[n..]], &mut [r, r_next]);
            } else {
                self.subtract([x], &mut [r]);
            }
        }
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

/// Size of a residual r = b − A x, the largest over the columns; NaN if any is NaN.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Residual {
    /// ‖r‖∞ / (‖A‖∞ ‖x‖∞ + ‖b‖∞)
    pub backward: f64,
    /// ‖r‖∞ / ‖b‖∞
    pub relative: f64,
}
