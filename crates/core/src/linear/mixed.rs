//! L Lᵀ in single precision, and in double where that does not do.
//!
//! A factor of single precision takes half of the time and of the memory. What it leaves of the right-hand side, some 1e-5, a
//! few refinements with the matrix itself take away (Wilkinson 1963; Buttari et al. 2007), far below what a Newton
//! direction leaves. Whether a matrix is singular or not positive definite is never its verdict: where it finds no
//! good pivots, or refinement leads nowhere, the matrix is factorised in double precision, and so are those that follow
//! until single precision is trusted again ([`Mixed::trust`]). What is found hangs on the matrices and right-hand sides
//! since then, on nothing before.

use std::sync::Arc;

use super::multifrontal::{Multifrontal, Plan};
use super::number::Number;
use super::{LinearError, Pattern};

/// Factors of one or the other precision: never of both, for they are most of a run's memory.
#[derive(Debug)]
pub(super) struct Mixed {
    plan: Arc<Plan>,
    single: Option<Multifrontal<f32>>,
    double: Option<Multifrontal<f64>>, // of the last matrix, if there
    unchanged: bool,                   // the next one is the last one
    trusted: bool,                     // single precision is tried first
}

impl Mixed {
    /// Allocates what factorisations in single precision need.
    pub fn new(plan: Arc<Plan>, pattern: &Pattern) -> Result<Self, LinearError> {
        Ok(Self {
            single: Some(Multifrontal::new(Arc::clone(&plan), pattern)?),
            double: None,
            plan,
            unchanged: false,
            trusted: true,
        })
    }

    /// Whether single precision is tried first from here on, whatever came before.
    pub fn trust(&mut self, trusted: bool) {
        self.trusted = trusted;
    }

    /// Whether single precision is tried first.
    pub fn is_trusted(&self) -> bool {
        self.trusted
    }

    /// Whether the factors at hand are of double precision.
    pub fn in_double(&self) -> bool {
        self.double.is_some()
    }

    /// Whether memory is taken by factors of both precisions.
    #[cfg(test)]
    pub fn holds_both(&self) -> bool {
        self.single.is_some() && self.double.is_some()
    }

    /// As [`Multifrontal::compare`].
    pub fn compare(&mut self, old: &[f64], new: &[f64]) -> bool {
        self.unchanged = match (&mut self.single, &mut self.double) {
            (Some(single), _) if self.trusted => single.compare(old, new),
            (_, Some(double)) if !self.trusted => double.compare(old, new),
            _ => false, // the other's turn
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

    /// The same without a trial of single precision, which is not trusted any more.
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

    /// x ← A⁻¹ x with the factors at hand.
    pub fn solve(&mut self, x: &mut [f64], columns: usize) {
        if let Some(double) = &mut self.double {
            double.solve(x, columns);
        } else if let Some(single) = &mut self.single {
            single.solve(x, columns);
        }
    }
}

/// What is there; else new, and knows of no matrix.
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
