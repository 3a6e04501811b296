//! Conjugate gradients with the factors of an earlier matrix (theory/linear-solver.md, eqs 8 and 9).
//!
//! From one iterate of an increment to the next a few points slide or open and a few elements crack. The existing
//! factors then belong to a matrix M close to the present one, A, and nearly all eigenvalues of M⁻¹A are near 1.
//! Conjugate gradients preconditioned with M find a direction with a few substitutions, whereas a factorisation
//! costs as much as ten or twenty. Newton's method leaves residuals of its own, and equilibrium is decided by the
//! forces. A twentieth of the residual in the norm of M⁻¹ therefore takes no more iterates than an exact solution
//! (an inexact Newton method; Dembo, Eisenstat and Steihaug, SIAM J. Numer. Anal. 19, 1982).

use std::ops::Range;

use super::{Kind, LinearError, LinearSolver, dot};

/// Part of the right-hand side that may remain. Both are measured by √(rᵀM⁻¹r).
const TARGET: f64 = 0.05;
/// Operations of a factorisation that take as long as one iteration, over the numbers in its factors. An iteration
/// reads each of these twice.
const OPERATIONS: f64 = 20.0;
/// Largest number of iterations. A matrix that needs more is not close.
const MOST: f64 = 12.0;
/// Number of iterations before they may be given up.
const PATIENCE: f64 = 2.0;
/// Least number of iterations in the time of a factorisation for which a trial is worthwhile.
const FEWEST: f64 = 4.0;

/// Working arrays of the iterations. `[column][equation]`
#[derive(Debug, Default)]
pub(super) struct Near {
    x: Vec<f64>,
    residual: Vec<f64>,
    preconditioned: Vec<f64>,
    direction: Vec<f64>,
    product: Vec<f64>,
    columns: Vec<Column>,
}

/// Convergence of one right-hand side.
#[derive(Clone, Copy, Debug)]
struct Column {
    /// rᵀM⁻¹r, now and for a zero solution.
    square: f64,
    whole: f64,
}

impl Column {
    /// Remaining part of the right-hand side. Zero for a zero right-hand side. NaN does not count as converged.
    fn left(self) -> f64 {
        if self.square == 0.0 {
            0.0
        } else {
            (self.square / self.whole).sqrt()
        }
    }

    fn is_done(self) -> bool {
        self.left() <= TARGET
    }
}

impl LinearSolver {
    /// Solves A x = b to a twentieth for the columns of `rhs` `[column][equation]`, in place, by conjugate
    /// gradients with the last factors.
    ///
    /// `values` `[entry]` are those of A, in the order of the pattern. `guess` is an estimate of the solution of
    /// the last columns, as many as it contains. Returns false, with `rhs` unchanged, if there are no factors of a
    /// symmetric matrix, or if the iterations would take longer than a factorisation.
    ///
    /// # Errors
    /// [`LinearError::Length`].
    pub fn solve_near(
        &mut self,
        values: &[f64],
        rhs: &mut [f64],
        guess: &[f64],
    ) -> Result<bool, LinearError> {
        let n = self.n();
        let most = self.most();
        let applies = self.factorised && self.options.backend.kind() == Kind::Symmetric;
        let fits = n > 0 && rhs.len().is_multiple_of(n) && guess.len() <= rhs.len();
        if !applies || !fits || most < FEWEST {
            return Ok(false);
        }
        self.note(values)?;
        let mut near = std::mem::take(&mut self.near);
        let found = self
            .begin(&mut near, rhs, guess)
            .and_then(|()| self.iterate(&mut near, most));
        if let Ok(true) = found {
            rhs.copy_from_slice(&near.x);
        }
        self.near = near;
        found
    }

    /// Number of iterations that take as long as a factorisation.
    fn most(&self) -> f64 {
        (self.stats.flops / (OPERATIONS * self.stats.nnz as f64)).min(MOST)
    }

    /// Computes the residuals of the right-hand sides `b` for `guess`, and the first search directions.
    fn begin(&mut self, near: &mut Near, b: &[f64], guess: &[f64]) -> Result<(), LinearError> {
        let n = self.n();
        let guessed = b.len() - guess.len()..b.len();
        near.x.clear();
        near.x.resize(guessed.start, 0.0);
        near.x.extend_from_slice(guess);
        near.residual.clear();
        near.residual.extend_from_slice(b);
        near.product.resize(b.len(), 0.0);
        if !guess.is_empty() {
            let product = &mut near.product[guessed.clone()];
            self.operator.multiply(guess, product);
            for (r, a_x) in near.residual[guessed].iter_mut().zip(product) {
                *r -= *a_x;
            }
        }
        near.preconditioned.clone_from(&near.residual);
        self.substitute(&mut near.preconditioned, b.len() / n)?;
        near.direction.clone_from(&near.preconditioned);
        near.columns.clear();
        for ((b, x), (r, z)) in (b.chunks(n).zip(near.x.chunks(n)))
            .zip(near.residual.chunks(n).zip(near.preconditioned.chunks(n)))
        {
            let (square, guessed) = (dot(r, z), dot(b, x));
            near.columns.push(Column {
                square,
                whole: if guessed > 0.0 { guessed } else { square },
            });
        }
        Ok(())
    }

    /// Conjugate gradients for all columns together, so that the factors are read once. Returns whether they
    /// converged.
    fn iterate(&mut self, near: &mut Near, most: f64) -> Result<bool, LinearError> {
        let n = self.n();
        let part = |c: usize| c * n..(c + 1) * n;
        let Near {
            x,
            residual,
            preconditioned,
            direction,
            product,
            columns,
        } = near;
        let mut iterations = 0.0;
        while let Some(active) = active(columns) {
            iterations += 1.0;
            let all = active.start * n..active.end * n;
            self.operator
                .multiply(&direction[all.clone()], &mut product[all.clone()]);
            for c in active.clone() {
                let part = part(c);
                let bends = dot(&direction[part.clone()], &product[part.clone()]);
                let step = columns[c].square / bends;
                // The matrix is not positive definite. A factorisation finds the equation. NaN cannot converge.
                if !(bends > 0.0 && step.is_finite()) {
                    return Ok(false);
                }
                for i in part {
                    x[i] += step * direction[i];
                    residual[i] -= step * product[i];
                }
            }
            preconditioned[all.clone()].copy_from_slice(&residual[all.clone()]);
            self.substitute(&mut preconditioned[all], active.len())?;
            let mut worst: f64 = 0.0;
            for c in active {
                let (part, column) = (part(c), &mut columns[c]);
                let before = column.square;
                column.square = dot(&residual[part.clone()], &preconditioned[part.clone()]);
                let turn = column.square / before;
                for i in part {
                    direction[i] = preconditioned[i] + turn * direction[i];
                }
                if !column.is_done() {
                    worst = worst.max(column.left());
                }
            }
            // The number needed is estimated from the convergence so far. The first iteration alone says little.
            let needs = iterations * TARGET.ln() / worst.ln();
            let promises = worst < 1.0 && needs <= most;
            if worst > 0.0 && iterations >= PATIENCE && !promises {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

/// Range from the first column that has not converged to the last one. None if all have converged.
fn active(columns: &[Column]) -> Option<Range<usize>> {
    let first = columns.iter().position(|column| !column.is_done())?;
    let last = columns.iter().rposition(|column| !column.is_done())?;
    Some(first..last + 1)
}
