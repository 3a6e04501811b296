//! How an increment is tried, and what came of it.

use crate::linear::LinearError;
use crate::material::LocalFailure;
use crate::solve::stepping::path::Advance;
use crate::solve::stepping::step_size::Increment;

/// Why an increment was refused.
#[derive(Clone, Debug, PartialEq)]
pub enum Refusal {
    /// Not below the tolerance after the allowed iterations.
    Iterations {
        /// Largest out-of-balance force over the mean nodal force.
        residual: f64,
        /// Their root mean square, over the same.
        root_mean_square: f64,
        /// Work of these forces along the increment, over the work that it turns over; 0 where they
        /// are too large themselves.
        work: f64,
        /// Node with the largest out-of-balance force.
        node: usize,
    },
    /// A law or an element gave no answer.
    Local {
        /// Element.
        element: usize,
        /// What happened.
        why: LocalFailure,
    },
    /// The matrix could not be factorised.
    Linear {
        /// What happened.
        why: LinearError,
        /// Node and direction of the equation, if one is to blame.
        dof: Option<(usize, usize)>,
    },
    /// The residual is not finite.
    NotFinite,
    /// The increment has snapped through to an equilibrium far away.
    Snap,
    /// The increment has left the path for an equilibrium far away.
    Leap,
    /// The increment leaves this part of all work done unaccounted for [-].
    Energy(f64),
    /// No load leads as far along the path as the increment should go.
    NoSuchLoad,
}

/// How an increment is tried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attempt<'a> {
    /// The part of the step; where the load is an unknown, that of its time.
    pub increment: Increment,
    /// Part of the step's loads that act at its start.
    pub load: f64,
    /// Part that acts at its end, where that is prescribed.
    pub load_end: f64,
    /// Start from the last increment again, or else from the tangent.
    pub repeat: bool,
    /// How far to go.
    pub advance: Advance<'a>,
}

/// How an increment converged.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Report {
    /// Linear solves.
    pub iterations: usize,
    /// Largest out-of-balance force over the mean nodal force, of what was solved.
    pub residual: f64,
    /// The same of the laws themselves: larger where the solids were extrapolated.
    pub out_of_balance: f64,
    /// Root mean square of what the extrapolation left, over the mean nodal force.
    pub extrapolation_error: f64,
    /// Part of the step's loads that act at the end.
    pub load_factor: f64,
}

/// What came of an increment.
#[derive(Clone, Debug)]
pub enum Outcome {
    /// Equilibrium was found; the trial holds it.
    Converged(Report),
    /// It was not; nothing was changed.
    Refused(Refusal, usize),
}

/// Counts linear solves and tells of each.
pub struct Solves<'a> {
    /// How many.
    pub count: usize,
    tell: &'a mut dyn FnMut(usize),
}

impl<'a> Solves<'a> {
    /// None yet; `tell` hears of each, with their number.
    pub fn new(tell: &'a mut dyn FnMut(usize)) -> Self {
        Self { count: 0, tell }
    }

    /// Another solve was done.
    pub fn one_more(&mut self) {
        self.count += 1;
        (self.tell)(self.count);
    }
}
