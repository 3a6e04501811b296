//! Equations of a matrix near one that was factorised: conjugate gradients with its factors.
//!
//! From one iterate of an increment to the next a few points slide or part and a few elements crack. The factors at hand are
//! then those of a matrix M near this one, A, and conjugate gradients preconditioned by them (M⁻¹A has nearly all of its
//! eigenvalues near 1) find a direction in a handful of substitutions, where a factorisation costs as much as ten or twenty. A
//! Newton direction leaves residuals of its own, and equilibrium is judged by the forces: a twentieth in the norm of M⁻¹ takes
//! no more iterates than all digits do (an inexact Newton method; Dembo, Eisenstat and Steihaug, SIAM J. Numer. Anal. 19,
//! 1982).

use std::ops::Range;

use super::{Kind, LinearError, LinearSolver, dot};

/// Part of the right-hand side that may be left, both as √(rᵀM⁻¹r).
const TARGET: f64 = 0.05;
/// Operations of a factorisation, over the numbers in its factors, that take as long as an iteration, which reads each of
/// these twice.
const OPERATIONS: f64 = 20.0;
/// Most iterations: what needs more is not near.
const MOST: f64 = 12.0;
/// Iterations before they are given up.
const PATIENCE: f64 = 2.0;
/// Fewest iterations in the time of a factorisation that are worth a trial.
const FEWEST: f64 = 4.0;

/// What the iterations work on. `[column][equation]`
#[derive(Debug, Default)]
pub(super) struct Near {
    x: Vec<f64>,
    residual: Vec<f64>,
    preconditioned: Vec<f64>,
    direction: Vec<f64>,
    product: Vec<f64>,
    columns: Vec<Column>,
}

/// How far the iterations of one right-hand side are.
#[derive(Clone, Copy, Debug)]
struct Column {
    /// rᵀM⁻¹r, now and where nothing is solved.
    square: f64,
    whole: f64,
}

impl Column {
    /// Part that is left; none of nothing, and NaN is not done.
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
    /// x = A⁻¹ b, to a twentieth, for the columns of `rhs` `[column][equation]`, in place, by conjugate gradients with the factors of the
    /// last matrix that was factorised. `values` `[entry]` are those of A, in the pattern's order; `guess` is what the
    /// last columns may be, as many as it has. False, and `rhs` as it was, if there are no factors of a symmetric matrix, or
    /// they would take more iterations than a factorisation is worth.
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

    /// Iterations that take as long as a factorisation.
    fn most(&self) -> f64 {
        (self.stats.flops / (OPERATIONS * self.stats.nnz as f64)).min(MOST)
    }

    /// What is left of the right-hand sides `b` by `guess`, and the way it points.
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

    /// Conjugate gradients, of all columns side by side so that the factors are read once. Whether they led there.
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
                // Not positive definite: a factorisation tells where. NaN leads nowhere.
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
            // As many more as it has taken so far for each part of the way; the first one tells little of it.
            let needs = iterations * TARGET.ln() / worst.ln();
            let promises = worst < 1.0 && needs <= most;
            if worst > 0.0 && iterations >= PATIENCE && !promises {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

/// From the first column that is not done to the last; none if all are.
fn active(columns: &[Column]) -> Option<Range<usize>> {
    let first = columns.iter().position(|column| !column.is_done())?;
    let last = columns.iter().rposition(|column| !column.is_done())?;
    Some(first..last + 1)
}
