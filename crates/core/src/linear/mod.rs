//! Sparse direct solution of A x = b, A structurally symmetric.
//!
//! Analyse a [`Pattern`] once, factorise many times, solve many right-hand sides. Every solution
//! is checked against the stored matrix: residual r = b − A x, refined x ← x + A⁻¹ r while it
//! exceeds [`Options::target`], at most [`Options::refinements`] times, and refused if it stays
//! above [`Options::accept`].

mod ahead;
mod assembly;
mod directions;
mod dissection;
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

/// Which values of the matrix count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A = Aᵀ, positive definite: only the lower triangle is read.
    Symmetric,
    /// All values are read.
    Unsymmetric,
}

/// Which factorisation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Backend {
    /// Multifrontal L Lᵀ; the tree's branches in parallel, the same bits on any number of threads.
    MultifrontalLlt,
    /// The same in single precision, refined with the matrix itself; in double from where that does not suffice
    /// ([`LinearSolver::trust_single`]).
    MixedLlt,
    /// Multifrontal L U, pivots within the block a front eliminates; parallel likewise. Where they
    /// do not suffice, [`Backend::FaerLu`] takes over for that matrix.
    MultifrontalLu,
    /// faer's sparse L Lᵀ; serial.
    FaerLlt,
    /// faer's sparse LU, pivots anywhere in a column; slow, serial: the last refuge.
    FaerLu,
}

impl Backend {
    /// Which values of the matrix this factorisation reads.
    pub fn kind(self) -> Kind {
        match self {
            Self::MultifrontalLlt | Self::MixedLlt | Self::FaerLlt => Kind::Symmetric,
            Self::MultifrontalLu | Self::FaerLu => Kind::Unsymmetric,
        }
    }
}

/// Backward error that no refinement betters: a few roundings.
const ROUNDING: f64 = 1e-15;

/// Choices of a [`LinearSolver`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// The factorisation.
    pub backend: Backend,
    /// The ordering, where the back end lets itself be told.
    pub ordering: Ordering,
    /// Most refinement steps a solve.
    pub refinements: usize,
    /// ‖b − A x‖∞ / ‖b‖∞ below which no refinement is done. Nor is it where the backward error is
    /// a rounding already.
    pub target: f64,
    /// Backward error above which a solution is refused.
    pub accept: f64,
}

impl Options {
    /// The defaults for a back end: no backward error above 1e-10 is accepted; at most two refinements, aiming at
    /// 1e-10 of the right-hand side, of single precision five and 1e-5 (a Newton direction leaves residuals of its own
    /// many times as large, and equilibrium is judged by the forces).
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

    /// Whether a solution needs no refinement. False where anything is NaN.
    fn refined(&self, report: SolveReport) -> bool {
        report.residual <= ROUNDING
            || report.relative <= self.target && report.residual <= self.accept
    }
}

/// What a factorisation costs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FactorStats {
    /// Numbers stored in the factors (0: unknown).
    pub nnz: usize,
    /// Floating-point operations (0: unknown).
    pub flops: f64,
    /// Share of the operations of the last factorisation that the one before it saved.
    pub reused: f64,
    /// Wall time of the last numeric factorisation [s].
    pub seconds: f64,
    /// Wall time of the analysis [s].
    pub analysis_seconds: f64,
}

/// How well a system was solved.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolveReport {
    /// ‖b − A x‖∞ / (‖A‖∞ ‖x‖∞ + ‖b‖∞), the largest over the right-hand sides.
    pub residual: f64,
    /// ‖b − A x‖∞ / ‖b‖∞, the largest over the right-hand sides.
    pub relative: f64,
    /// Refinement steps done.
    pub refinements: usize,
}

/// The closed family of factorisations.
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

/// A pattern and the order of elimination that was found for it.
#[derive(Clone, Debug)]
pub struct Analysis {
    pattern: Arc<Pattern>,
    plan: Arc<Plan>,
    ordering: Ordering,
}

impl Analysis {
    /// Whether an analysis of this pattern would find the same.
    fn serves(&self, pattern: &Pattern, options: Options) -> bool {
        self.plan.kind() == options.backend.kind()
            && self.ordering == options.ordering
            && self.pattern.is_same(pattern)
    }
}

/// Σ a_i b_i.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// One matrix pattern, its symbolic analysis, the last matrix and its factors.
#[derive(Debug)]
pub struct LinearSolver {
    options: Options,
    analysis: Option<Analysis>, // of a multifrontal engine
    operator: Operator,
    engine: Engine,
    refuge: Option<FaerLu>, // of a multifrontal LU, once it was needed
    in_refuge: bool,        // the last matrix was factorised there
    factorised: bool,
    stats: FactorStats,
    rhs: Vec<f64>,      // [column][equation], b kept for the residual
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

    /// The same, with what is `known` of another matrix, where its pattern is this one.
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

    /// The pattern that was analysed.
    pub fn pattern(&self) -> &Pattern {
        self.operator.pattern()
    }

    /// What the factorisation costs.
    pub fn stats(&self) -> FactorStats {
        self.stats
    }

    /// What was found of the pattern, for others that are equal; none of faer's back ends.
    pub fn analysis(&self) -> Option<&Analysis> {
        self.analysis.as_ref()
    }

    /// The choices this solver was made with.
    pub fn options(&self) -> Options {
        self.options
    }

    /// Whether [`Backend::MixedLlt`] tries single precision first from here on, until a matrix wants double. A solver is
    /// made with trust in it. What comes after this hangs on nothing before.
    pub fn trust_single(&mut self, trusted: bool) {
        if let Engine::Mixed(f) = &mut self.engine {
            f.trust(trusted);
        }
    }

    /// Whether [`Backend::MixedLlt`] goes on in double precision, because it was told to or a matrix wanted it.
    pub fn distrusts_single(&self) -> bool {
        matches!(&self.engine, Engine::Mixed(f) if !f.is_trusted())
    }

    /// Factorises the matrix with these values `[entry]`, in the pattern's order; they are kept
    /// for the residual check.
    ///
    /// # Errors
    /// [`LinearError::Length`], [`LinearError::NotFinite`], [`LinearError::Singular`] or, from a
    /// symmetric back end, [`LinearError::NotPositiveDefinite`]. No pivot is ever perturbed. After
    /// an error there is no factorisation to solve with.
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
                // Singular, or only in want of pivots.
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

    /// Keeps the values of a matrix. Fronts that they change are stale from here on, whenever that is factorised.
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

    /// A back end that divides by (nearly) zero in silence is found out by solving for a vector of
    /// ±1: a vanished pivot lets ‖A‖ ‖x‖ / ‖b‖ grow to the reciprocal of a rounding.
    fn probe(&mut self) -> Result<(), LinearError> {
        let mut x: Vec<f64> = (0..self.n() as u64)
            // Signs without a pattern a null vector could be orthogonal to.
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
            // 1/(64 ε) = 7e13; `<` is false for NaN.
            Some(equation) if !growth(x[equation]).lt(&(1.0 / (64.0 * f64::EPSILON))) => {
                Err(LinearError::Singular { equation })
            }
            _ => Ok(()),
        }
    }

    /// x = A⁻¹ b for the columns of `rhs`, `[column][equation]`, in place.
    ///
    /// # Errors
    /// [`LinearError::NotFactorised`], [`LinearError::Length`], [`LinearError::NotFinite`], or
    /// [`LinearError::Inaccurate`] (then `rhs` holds the best solution found).
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
        // A NaN residual is not below the limit.
        if report.residual <= self.options.accept {
            Ok(report)
        } else {
            let (residual, limit) = (report.residual, self.options.accept);
            Err(LinearError::Inaccurate { residual, limit })
        }
    }

    /// Solves for `x`, a copy of which is in `self.rhs`, and refines the solution.
    fn refine(&mut self, x: &mut [f64], columns: usize) -> Result<SolveReport, LinearError> {
        self.substitute(x, columns)?;
        let residual = self.operator.residual(x, &self.rhs, &mut self.residual);
        let mut report = SolveReport {
            residual: residual.backward,
            relative: residual.relative,
            refinements: 0,
        };
        while !self.options.refined(report) && report.refinements < self.options.refinements {
            // x' = x + A⁻¹ (b − A x), kept only if it is better.
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
