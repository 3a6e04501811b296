//! Linear equations of an iterate and the loads of an increment: the parts of [`super::newton::Newton`].

use super::direction::Factors;
use super::external_forces::Loads;
use crate::linear::LinearSolver;

/// Matrix of the present iterate and its factors.
#[derive(Default)]
pub(in crate::solve) struct TangentMatrix {
    pub(in crate::solve) solver: Option<LinearSolver>,
    /// The factors at hand, if they belong to a matrix of this increment. Factors of earlier increments are not used,
    /// so that a resumed run, which knows the state alone, finds the same results.
    pub(in crate::solve) factors: Option<Factors>,
    /// [`crate::state::State::wants_double`] at the start of the increment.
    pub(in crate::solve) wants_double: bool,
    /// Values of the matrix [N/mm]. `[entry]`
    pub(in crate::solve) values: Vec<f64>,
    /// Identifier of the assembly that filled `values`; none if their content is unknown.
    pub(in crate::solve) filled: Option<u64>,
}

/// Vectors over the equations of the step.
pub(in crate::solve) struct Vectors {
    /// Search direction d = −K⁻¹ r [mm]. `[equation]`
    pub(in crate::solve) direction: Vec<f64>,
    /// Out-of-balance forces r of the present iterate [N]. `[equation]`
    pub(in crate::solve) residual: Vec<f64>,
    /// Out-of-balance forces at the last commit [N]. `[equation]`
    pub(in crate::solve) left: Vec<f64>,
    /// Forces added to −r on the right-hand side of the next solve [N] `[equation]`; empty if there are none.
    pub(in crate::solve) pull: Vec<f64>,
    /// −K⁻¹ ∂r/∂λ [mm] `[equation]`, where the load factor is an unknown.
    pub(in crate::solve) by_load: Vec<f64>,
}

impl Vectors {
    /// Zeros for `n` equations.
    pub(in crate::solve) fn new(n: usize) -> Self {
        Self {
            direction: vec![0.0; n],
            residual: vec![0.0; n],
            left: vec![0.0; n],
            pull: Vec::new(),
            by_load: Vec::new(),
        }
    }
}

/// Loads and drives of the step and of the increment.
pub(in crate::solve) struct Loading {
    /// λ, the part of the step's loads that acts at the last iterate.
    pub(in crate::solve) factor: f64,
    /// Part of the step's time at the end of the increment.
    pub(in crate::solve) moment: f64,
    /// dλ/ds, the change of λ with the part of the step's time, where λ is prescribed.
    pub(in crate::solve) slope: f64,
    /// Loads at the end of the increment.
    pub(in crate::solve) loads: Loads,
    /// Loads at the start of the increment.
    pub(in crate::solve) loads_start: Loads,
    /// Positions of the spring ends at the start of the step [mm]. `[spring][xyz]`
    pub(in crate::solve) ends_start: Vec<[f64; 3]>,
}
