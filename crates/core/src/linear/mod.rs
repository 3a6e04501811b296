//! Sparse direct solution of A x = b with structurally symmetric A, and by it the lowest eigenpairs of symmetric
//! matrices ([`eigen`]).
//!
//! A [`Pattern`] is analysed once; matrices with it are factorised and solved for right-hand sides. Every solution
//! is checked against the stored matrix (theory/linear-solver.md, eqs 5 and 6). While the residual r = b − A x
//! exceeds [`Options::target`], the solution is refined by x ← x + A⁻¹ r, at most [`Options::refinements`] times. A
//! solution whose backward error stays above [`Options::accept`] is rejected.

mod ahead;
mod assembly;
mod directions;
mod dissection;
pub mod eigen;
mod error;
mod extend;
mod faer_llt;
mod faer_lu;
mod kernels;
mod mixed;
#[cfg(test)]
mod mixed_tests;
mod multifrontal;
mod near;
#[cfg(test)]
mod near_tests;
mod number;
mod operator;
mod ordering;
mod pattern;
mod region;
mod reuse;
#[cfg(test)]
mod reuse_tests;
mod schur;
mod share;
mod single;
#[cfg(test)]
mod stencils;
mod substitution;
mod tasks;
#[cfg(test)]
mod tests;
mod tiles;
mod tree;

use std::sync::Arc;
use std::time::Instant;

pub use error::LinearError;
pub use ordering::Ordering;
pub use pattern::Pattern;
pub use region::Region;

use faer_llt::FaerLlt;
use faer_lu::FaerLu;
use mixed::Mixed;
use multifrontal::{Multifrontal, Plan};
use near::Near;
use operator::Operator;
use ordering::Graph;

/// Values of the matrix that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A = Aᵀ, positive definite. Only the lower triangle is read.
    Symmetric,
    /// General values. All are read.
    Unsymmetric,
}

/// Factorisation method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Backend {
    /// Multifrontal L Lᵀ. Branches of the tree run in parallel, with the same bits on any number of threads.
    MultifrontalLlt,
    /// The same in single precision, refined with the matrix in double precision. A matrix for which that does not
    /// suffice is factorised in double precision, as are those after it ([`LinearSolver::trust_single`]).
    MixedLlt,
    /// Multifrontal L U with pivots within the block that a front eliminates, parallel likewise. Where these pivots
    /// do not suffice, [`Backend::FaerLu`] factorises the matrix.
    MultifrontalLu,
    /// Sparse L Lᵀ of faer, serial.
    FaerLlt,
    /// Sparse L U of faer with pivots anywhere in a column. Slow and serial, the last resort.
    FaerLu,
}

impl Backend {
    /// Values of the matrix that this factorisation reads.
    pub fn kind(self) -> Kind {
        match self {
            Self::MultifrontalLlt | Self::MixedLlt | Self::FaerLlt => Kind::Symmetric,
            Self::MultifrontalLu | Self::FaerLu => Kind::Unsymmetric,
        }
    }
}

/// Backward error that no refinement improves: a few rounding errors.
const ROUNDING: f64 = 1e-15;

/// Options of a [`LinearSolver`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Factorisation.
    pub backend: Backend,
    /// Ordering, for back ends that accept one.
    pub ordering: Ordering,
    /// Largest number of refinement steps in a solve.
    pub refinements: usize,
    /// ‖b − A x‖∞ / ‖b‖∞ below which no refinement is done. None is done either if the backward error is at the
    /// level of rounding.
    pub target: f64,
    /// Backward error above which a solution is rejected.
    pub accept: f64,
}

impl Options {
    /// Default options of a back end.
    ///
    /// No backward error above 1e-10 is accepted. There are at most two refinements, to 1e-10 of the right-hand
    /// side. In single precision there are five, to 1e-5: the next residual of Newton's method is many times as
    /// large anyway, and equilibrium is decided by the forces.
    pub fn new(backend: Backend) -> Self {
        let (refinements, target) = match backend {
            Backend::MixedLlt => (5, 1e-5),
            _ => (2, 1e-10),
        };
        Self {
            backend,
            ordering: Ordering::default(),
            refinements,
            target,
            accept: 1e-10,
        }
    }

    /// Whether a solution needs no refinement. False for NaN.
    fn refined(&self, report: SolveReport) -> bool {
        report.residual <= ROUNDING
            || report.relative <= self.target && report.residual <= self.accept
    }
}

/// Cost of a factorisation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FactorStats {
    /// Numbers stored in the factors (0: unknown).
    pub nnz: usize,
    /// Floating-point operations (0: unknown).
    pub flops: f64,
    /// Part of the operations of the last factorisation that were saved by reusing factors.
    pub reused: f64,
    /// Wall time of the last numeric factorisation [s].
    pub seconds: f64,
    /// Wall time of the analysis [s].
    pub analysis_seconds: f64,
}

/// Accuracy of a solution.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolveReport {
    /// ‖b − A x‖∞ / (‖A‖∞ ‖x‖∞ + ‖b‖∞), the largest over the right-hand sides.
    pub residual: f64,
    /// ‖b − A x‖∞ / ‖b‖∞, the largest over the right-hand sides.
    pub relative: f64,
    /// Number of refinement steps.
    pub refinements: usize,
}

/// All factorisations.
#[derive(Debug)]
enum Engine {
    Multifrontal(Box<Multifrontal<f64>>),
    Mixed(Box<Mixed>),
    FaerLlt(FaerLlt),
    FaerLu(FaerLu),
}

impl Engine {
    fn solve(&mut self, x: &mut [f64], columns: usize) -> Result<(), LinearError> {
        match self {
            Self::Multifrontal(f) => {
                f.solve(x, columns);
                Ok(())
            }
            Self::Mixed(f) => {
                f.solve(x, columns);
                Ok(())
            }
            Self::FaerLlt(f) => f.solve(x, columns),
            Self::FaerLu(f) => f.solve(x, columns),
        }
    }
}

/// A pattern and its order of elimination.
#[derive(Clone, Debug)]
pub struct Analysis {
    pattern: Arc<Pattern>,
    plan: Arc<Plan>,
    ordering: Ordering,
}

impl Analysis {
    /// Whether an analysis of this pattern would give the same result.
    fn serves(&self, pattern: &Pattern, options: Options) -> bool {
        self.plan.kind() == options.backend.kind()
            && self.ordering == options.ordering
            && self.pattern.is_same(pattern)
    }
}

/// Scalar product Σ a_i b_i.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Solver for one matrix pattern, with its symbolic analysis, the last matrix and its factors.
#[derive(Debug)]
pub struct LinearSolver {
    options: Options,
    analysis: Option<Analysis>, // of a multifrontal engine
    operator: Operator,
    engine: Engine,
    refuge: Option<FaerLu>, // for a multifrontal L U, once needed
    in_refuge: bool,        // whether the last matrix was factorised there
    factorised: bool,
    stats: FactorStats,
    rhs: Vec<f64>,      // [column][equation], b for the residual
    residual: Vec<f64>, // [column][equation]
    previous: Vec<f64>, // [column][equation], x before a refinement
    near: Near,
}

impl LinearSolver {
    /// Orders and analyses a pattern.
    ///
    /// # Errors
    /// [`LinearError::TooLarge`] if memory or 32-bit indices run out.
    pub fn analyse(pattern: &Pattern, options: Options) -> Result<Self, LinearError> {
        Self::analyse_beside(pattern.clone(), options, None)
    }

    /// The same, but takes over the analysis `known` if it belongs to an equal pattern.
    ///
    /// # Errors
    /// As [`LinearSolver::analyse`].
    pub fn analyse_beside(
        pattern: Pattern,
        options: Options,
        known: Option<&Analysis>,
    ) -> Result<Self, LinearError> {
        let start = Instant::now();
        let mut stats = FactorStats::default();
        let kind = options.backend.kind();
        let known = known.filter(|known| known.serves(&pattern, options));
        let pattern = known.map_or_else(|| Arc::new(pattern), |known| Arc::clone(&known.pattern));
        let mut analysis = None;
        let engine = match options.backend {
            Backend::MultifrontalLlt | Backend::MultifrontalLu | Backend::MixedLlt => {
                let plan = match known {
                    Some(known) => Arc::clone(&known.plan),
                    None => Arc::new(Plan::analyse(&pattern, options.ordering, kind)?),
                };
                (stats.nnz, stats.flops) = (plan.factor_nnz(), plan.flops());
                analysis = Some(Analysis {
                    pattern: Arc::clone(&pattern),
                    plan: Arc::clone(&plan),
                    ordering: options.ordering,
                });
                if options.backend == Backend::MixedLlt {
                    Engine::Mixed(Box::new(Mixed::new(plan, &pattern)?))
                } else {
                    Engine::Multifrontal(Box::new(Multifrontal::new(plan, &pattern)?))
                }
            }
            Backend::FaerLlt => {
                let graph = Graph::of(&pattern)?;
                let order = ordering::order(&pattern, &graph, options.ordering)?;
                let llt = FaerLlt::analyse(&pattern, ordering::expand(&pattern, &order))?;
                (stats.nnz, stats.flops) = (llt.factor_nnz(), llt.flops());
                Engine::FaerLlt(llt)
            }
            Backend::FaerLu => Engine::FaerLu(FaerLu::analyse(&pattern)?),
        };
        stats.analysis_seconds = start.elapsed().as_secs_f64();
        let operator = Operator::new(pattern, kind);
        Ok(Self {
            options,
            analysis,
            operator,
            engine,
            refuge: None,
            in_refuge: false,
            factorised: false,
            stats,
            rhs: Vec::new(),
            residual: Vec::new(),
            previous: Vec::new(),
            near: Near::default(),
        })
    }

    /// Number of equations.
    pub fn n(&self) -> usize {
        self.operator.pattern().n()
    }

    /// Pattern that was analysed.
    pub fn pattern(&self) -> &Pattern {
        self.operator.pattern()
    }

    /// Cost of the last factorisation.
    pub fn stats(&self) -> FactorStats {
        self.stats
    }

    /// Analysis of the pattern, for reuse with equal patterns. None for faer's back ends.
    pub fn analysis(&self) -> Option<&Analysis> {
        self.analysis.as_ref()
    }

    /// Options of this solver.
    pub fn options(&self) -> Options {
        self.options
    }

    /// Sets whether [`Backend::MixedLlt`] tries single precision first, until a matrix needs double precision. A
    /// new solver tries it. Results after this call do not depend on earlier matrices.
    pub fn trust_single(&mut self, trusted: bool) {
        if let Engine::Mixed(f) = &mut self.engine {
            f.trust(trusted);
        }
    }

    /// Whether [`Backend::MixedLlt`] continues in double precision, by choice or because a matrix needed it.
    pub fn distrusts_single(&self) -> bool {
        matches!(&self.engine, Engine::Mixed(f) if !f.is_trusted())
    }

    /// Factorises the matrix with these values `[entry]`, in the order of the pattern. They are stored for the
    /// residual check.
    ///
    /// # Errors
    /// [`LinearError::Length`], [`LinearError::NotFinite`], [`LinearError::Singular`] or, from a symmetric back
    /// end, [`LinearError::NotPositiveDefinite`]. No pivot is ever perturbed. After an error no system can be
    /// solved.
    pub fn factorise(&mut self, values: &[f64]) -> Result<FactorStats, LinearError> {
        let start = Instant::now();
        self.factorised = false;
        self.in_refuge = false;
        self.stats.reused = 0.0;
        self.note(values)?;
        self.operator.sum_rows()?;
        let pattern = self.operator.pattern();
        match &mut self.engine {
            Engine::Multifrontal(f) => match f.factorise(values, self.operator.row_sums()) {
                // The matrix is singular, or its pivots within fronts do not suffice.
                Err(first) if self.options.backend == Backend::MultifrontalLu => {
                    self.seek_refuge().map_err(|_| first)?;
                }
                other => self.stats.reused = other?,
            },
            Engine::Mixed(f) => {
                self.stats.reused = f.factorise(pattern, values, self.operator.row_sums())?;
            }
            Engine::FaerLlt(f) => f.factorise(pattern, values)?,
            Engine::FaerLu(f) => {
                f.factorise(pattern, values)?;
                self.probe()?;
            }
        }
        self.factorised = true;
        self.stats.seconds = start.elapsed().as_secs_f64();
        Ok(self.stats)
    }

    /// Stores the values of a matrix. Fronts with changed values count as stale until they are factorised again.
    fn note(&mut self, values: &[f64]) -> Result<(), LinearError> {
        let known = match &mut self.engine {
            Engine::Multifrontal(f) => f.compare(self.operator.values(), values),
            Engine::Mixed(f) => f.compare(self.operator.values(), values),
            _ => false,
        };
        if known {
            return Ok(());
        }
        self.operator.store(values)
    }

    /// Factorises the stored matrix with pivots anywhere in a column.
    fn seek_refuge(&mut self) -> Result<(), LinearError> {
        let pattern = self.operator.pattern();
        let refuge = match &mut self.refuge {
            Some(refuge) => refuge,
            none => none.insert(FaerLu::analyse(pattern)?),
        };
        refuge.factorise(pattern, self.operator.values())?;
        self.in_refuge = true;
        self.probe()
    }

    /// x ← A⁻¹ x with the last factors.
    fn substitute(&mut self, x: &mut [f64], columns: usize) -> Result<(), LinearError> {
        match &self.refuge {
            Some(refuge) if self.in_refuge => refuge.solve(x, columns),
            _ => self.engine.solve(x, columns),
        }
    }

    /// Detects a factorisation that divided by (nearly) zero without an error. It solves for a vector of ±1: a
    /// vanished pivot makes ‖A‖ ‖x‖ / ‖b‖ as large as the reciprocal of a rounding error.
    fn probe(&mut self) -> Result<(), LinearError> {
        let mut x: Vec<f64> = (0..self.n() as u64)
            // Pseudo-random signs, so that no regular null vector is orthogonal to them.
            .map(|i| {
                if (i.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 61) & 1 == 0 {
                    1.0
                } else {
                    -1.0
                }
            })
            .collect();
        self.substitute(&mut x, 1)?;
        let growth = |v: f64| v.abs() * self.operator.norm();
        let worst = (0..x.len()).max_by(|&i, &j| f64::total_cmp(&growth(x[i]), &growth(x[j])));
        match worst {
            // 1/(64 ε) = 7e13. `<` is false for NaN.
            Some(equation) if !growth(x[equation]).lt(&(1.0 / (64.0 * f64::EPSILON))) => {
                Err(LinearError::Singular { equation })
            }
            _ => Ok(()),
        }
    }

    /// Solves A x = b in place for the columns of `rhs`, `[column][equation]`.
    ///
    /// # Errors
    /// [`LinearError::NotFactorised`], [`LinearError::Length`], [`LinearError::NotFinite`], or
    /// [`LinearError::Inaccurate`]. In the last case `rhs` contains the best solution found.
    pub fn solve(&mut self, rhs: &mut [f64]) -> Result<SolveReport, LinearError> {
        if !self.factorised {
            return Err(LinearError::NotFactorised);
        }
        let n = self.n();
        if n == 0 || rhs.is_empty() {
            return Ok(SolveReport::default());
        }
        let columns = rhs.len() / n;
        if columns * n != rhs.len() {
            let expected = (columns + 1) * n;
            return Err(LinearError::Length {
                what: "right-hand side",
                expected,
                got: rhs.len(),
            });
        }
        if let Some(k) = rhs.iter().position(|b| !b.is_finite()) {
            return Err(LinearError::NotFinite { equation: k % n });
        }
        self.rhs.clear();
        self.rhs.extend_from_slice(rhs);
        self.residual.resize(rhs.len(), 0.0);
        let mut report = self.refine(rhs, columns)?;
        let accurate = |report: SolveReport| report.residual <= self.options.accept;
        if self.options.backend == Backend::MultifrontalLu && !self.in_refuge && !accurate(report) {
            self.seek_refuge()?;
            rhs.copy_from_slice(&self.rhs);
            report = self.refine(rhs, columns)?;
        }
        if let Engine::Mixed(f) = &mut self.engine
            && !f.in_double()
            && !self.options.refined(report)
        {
            let (pattern, values) = (self.operator.pattern(), self.operator.values());
            self.factorised = false;
            f.factorise_in_double(pattern, values, self.operator.row_sums())?;
            self.factorised = true;
            rhs.copy_from_slice(&self.rhs);
            report = self.refine(rhs, columns)?;
        }
        // NaN is not below the limit.
        if report.residual <= self.options.accept {
            Ok(report)
        } else {
            let (residual, limit) = (report.residual, self.options.accept);
            Err(LinearError::Inaccurate { residual, limit })
        }
    }

    /// Solves A x = b in place with the last factors, which may be those of a near matrix, and does not refine the
    /// solution.
    ///
    /// # Errors
    /// [`LinearError::NotFactorised`], or [`LinearError::Length`].
    pub fn estimate(&mut self, rhs: &mut [f64]) -> Result<(), LinearError> {
        if !self.factorised {
            return Err(LinearError::NotFactorised);
        }
        if rhs.len() != self.n() {
            let (expected, got) = (self.n(), rhs.len());
            let what = "right-hand side";
            return Err(LinearError::Length {
                what,
                expected,
                got,
            });
        }
        self.substitute(rhs, 1)
    }

    /// Solves for `x`, of which `self.rhs` is a copy, and refines the solution.
    fn refine(&mut self, x: &mut [f64], columns: usize) -> Result<SolveReport, LinearError> {
        self.substitute(x, columns)?;
        let residual = self.operator.residual(x, &self.rhs, &mut self.residual);
        let mut report = SolveReport {
            residual: residual.backward,
            relative: residual.relative,
            refinements: 0,
        };
        while !self.options.refined(report) && report.refinements < self.options.refinements {
            // x' = x + A⁻¹ (b − A x), accepted only if it is better.
            self.previous.clear();
            self.previous.extend_from_slice(x);
            let mut change = std::mem::take(&mut self.residual);
            let substituted = self.substitute(&mut change, columns);
            self.residual = change;
            substituted?;
            for (x, d) in x.iter_mut().zip(&self.residual) {
                *x += d;
            }
            let refined = self.operator.residual(x, &self.rhs, &mut self.residual);
            if refined.relative < report.relative {
                report.residual = refined.backward;
                report.relative = refined.relative;
                report.refinements += 1;
            } else {
                x.copy_from_slice(&self.previous);
                break;
            }
        }
        Ok(report)
    }
}
