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
use super::{LinearError, Pattern};

/// Factors of one or the other precision.
#[derive(Debug)]
pub(super) struct Mixed {
    plan: Arc<Plan>,
    single: Multifrontal<f32>,
    double: Option<Multifrontal<f64>>, // once it was needed
    in_double: bool,                   // the last matrix
    unchanged: bool,                   // the next one is the last one
    trusted: bool,                     // single precision is tried first
}

impl Mixed {
    /// Allocates what factorisations in single precision need.
    pub fn new(plan: Plan, pattern: &Pattern) -> Result<Self, LinearError> {
        let plan = Arc::new(plan);
        Ok(Self {
            single: Multifrontal::new(Arc::clone(&plan), pattern)?,
            plan,
            double: None,
            in_double: false,
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
        self.in_double
    }

    /// As [`Multifrontal::compare`].
    pub fn compare(&mut self, old: &[f64], new: &[f64]) -> bool {
        self.unchanged = match &mut self.double {
            _ if self.in_double == self.trusted => false, // the other's turn
            Some(double) if self.in_double => double.compare(old, new),
            _ => self.single.compare(old, new),
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
            if std::mem::take(&mut self.in_double) {
                self.single.forget(); // it has not seen the last matrix
            }
            if let Ok(saved) = self.single.factorise(values, sums) {
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
        let double = match &mut self.double {
            Some(double) => double,
            none => none.insert(Multifrontal::new(Arc::clone(&self.plan), pattern)?),
        };
        self.trusted = false;
        if !std::mem::replace(&mut self.in_double, true) {
            double.forget(); // as above
        }
        double.factorise(values, sums)
    }

    /// x ← A⁻¹ x with the factors at hand.
    pub fn solve(&mut self, x: &mut [f64], columns: usize) {
        match &mut self.double {
            Some(double) if self.in_double => double.solve(x, columns),
            _ => self.single.solve(x, columns),
        }
    }
}
