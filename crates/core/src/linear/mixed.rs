//! L Lᵀ in single precision, and in double precision where single does not suffice.
//!
//! A factor of single precision takes half of the memory and 0.55 to 0.65 of the time. It leaves a residual of some
//! 1e-5 of the right-hand side. A few refinements with the matrix in double precision reduce it (Wilkinson 1963;
//! Buttari et al. 2007), far below the residual that Newton's method leaves. Single precision never decides that a
//! matrix is singular or not positive definite. Where it finds no good pivots, or refinement does not converge, the
//! matrix is factorised in double precision. So are those after it, until single precision is tried again
//! ([`Mixed::trust`]). Results depend on the matrices and right-hand sides since then only.

use std::sync::Arc;

use super::multifrontal::{Multifrontal, Plan};
use super::number::Number;
use super::{LinearError, Pattern};

/// Factors of one precision at a time, because they take most of a run's memory.
#[derive(Debug)]
pub(super) struct Mixed {
    plan: Arc<Plan>,
    single: Option<Multifrontal<f32>>,
    double: Option<Multifrontal<f64>>, // of the last matrix, if in use
    unchanged: bool,                   // whether the next matrix equals the last one
    trusted: bool,                     // whether single precision is tried first
}

impl Mixed {
    /// Allocates the memory for factorisations in single precision.
    pub fn new(plan: Arc<Plan>, pattern: &Pattern) -> Result<Self, LinearError> {
        Ok(Self {
            single: Some(Multifrontal::new(Arc::clone(&plan), pattern)?),
            double: None,
            plan,
            unchanged: false,
            trusted: true,
        })
    }

    /// Sets whether single precision is tried first, independent of earlier matrices.
    pub fn trust(&mut self, trusted: bool) {
        self.trusted = trusted;
    }

    /// Whether single precision is tried first.
    pub fn is_trusted(&self) -> bool {
        self.trusted
    }

    /// Whether the present factors are of double precision.
    pub fn in_double(&self) -> bool {
        self.double.is_some()
    }

    /// Whether factors of both precisions are in memory.
    #[cfg(test)]
    pub fn holds_both(&self) -> bool {
        self.single.is_some() && self.double.is_some()
    }

    /// As [`Multifrontal::compare`].
    pub fn compare(&mut self, old: &[f64], new: &[f64]) -> bool {
        self.unchanged = match (&mut self.single, &mut self.double) {
            (Some(single), _) if self.trusted => single.compare(old, new),
            (_, Some(double)) if !self.trusted => double.compare(old, new),
            _ => false, // the other precision is next
        };
        self.unchanged
    }

    /// As [`Multifrontal::factorise`].
    pub fn factorise(
        &mut self,
        pattern: &Pattern,
        values: &[f64],
        sums: &[f64],
    ) -> Result<f64, LinearError> {
        if std::mem::take(&mut self.unchanged) {
            return Ok(1.0);
        }
        if self.trusted {
            self.double = None;
            let single = kept_or_new(&mut self.single, &self.plan, pattern)?;
            if let Ok(saved) = single.factorise(values, sums) {
                return Ok(saved);
            }
        }
        self.factorise_in_double(pattern, values, sums)
    }

    /// The same in double precision, without a trial of single precision. Later matrices do not try it either.
    pub fn factorise_in_double(
        &mut self,
        pattern: &Pattern,
        values: &[f64],
        sums: &[f64],
    ) -> Result<f64, LinearError> {
        self.trusted = false;
        self.single = None;
        kept_or_new(&mut self.double, &self.plan, pattern)?.factorise(values, sums)
    }

    /// x ← A⁻¹ x with the present factors.
    pub fn solve(&mut self, x: &mut [f64], columns: usize) {
        if let Some(double) = &mut self.double {
            double.solve(x, columns);
        } else if let Some(single) = &mut self.single {
            single.solve(x, columns);
        }
    }
}

/// Existing factors, or new ones without a matrix.
fn kept_or_new<'a, T: Number>(
    factors: &'a mut Option<Multifrontal<T>>,
    plan: &Arc<Plan>,
    pattern: &Pattern,
) -> Result<&'a mut Multifrontal<T>, LinearError> {
    Ok(match factors {
        Some(kept) => kept,
        none => none.insert(Multifrontal::new(Arc::clone(plan), pattern)?),
    })
}
