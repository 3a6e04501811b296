//! Attempts at an increment and their outcomes.

use crate::assembly::{System, Trial};
use crate::linear::LinearError;
use crate::material::LocalFailure;
use crate::solve::stepping::path::Advance;
use crate::solve::stepping::step_size::Increment;
use crate::state::State;

/// Reason why an increment was rejected.
#[derive(Clone, Debug, PartialEq)]
pub enum Rejection {
    /// The residual was not below the tolerance after the allowed iterations.
    Iterations {
        /// Largest out-of-balance force over the mean nodal force.
        residual: f64,
        /// Root mean square of the out-of-balance forces over the mean nodal force.
        root_mean_square: f64,
        /// Work of these forces along the increment over the work turned over; 0 where the forces themselves are too
        /// large.
        work: f64,
        /// Node with the largest out-of-balance force.
        node: usize,
    },
    /// A law or an element failed.
    Local {
        /// Index of the element.
        element: usize,
        /// Kind of failure.
        why: LocalFailure,
    },
    /// The matrix could not be factorised.
    Linear {
        /// Kind of failure.
        why: LinearError,
        /// Node and direction of the faulty equation, if one is known.
        dof: Option<(usize, usize)>,
    },
    /// The residual is not finite.
    NotFinite,
    /// The increment snapped through to a distant equilibrium.
    Snap,
    /// The increment left the path for a distant equilibrium.
    Leap,
    /// The path has slid back beyond the start of the drive.
    Back,
    /// Part of all work done that the increment leaves unaccounted for [-].
    Energy(f64),
    /// No load factor leads as far along the path as the increment prescribes.
    NoSuchLoad,
}

/// Settings of an attempt at an increment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attempt<'a> {
    /// The part of the step; where the load factor is an unknown, the part of its time.
    pub increment: Increment,
    /// Part of the step's loads that acts at the start of the increment.
    pub load: f64,
    /// Part that acts at its end, where the load is prescribed.
    pub load_end: f64,
    /// Whether the predictor repeats the last increment; else it uses the tangent.
    pub repeat: bool,
    /// Prescribed advance.
    pub advance: Advance<'a>,
}

/// Problem of an attempt: the equilibrium at the end of an increment.
pub struct Problem<'a> {
    /// Equations of the scene.
    pub system: &'a mut System,
    /// Committed state, from which the increment starts.
    pub state: &'a State,
    /// Working data of the increment.
    pub trial: &'a mut Trial,
    /// Settings.
    pub attempt: Attempt<'a>,
    /// Counter of the linear solves.
    pub solves: Solves<'a>,
}

/// Report on a converged increment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Report {
    /// Linear solves.
    pub iterations: usize,
    /// Largest out-of-balance force of the equations solved, over the mean nodal force.
    pub residual: f64,
    /// The same with the laws themselves; larger where solids were extrapolated.
    pub out_of_balance: f64,
    /// Root mean square of the force error of the extrapolation, over the mean nodal force.
    pub extrapolation_error: f64,
    /// Part of the step's loads that acts at the end.
    pub load_factor: f64,
}

/// Outcome of an attempt.
#[derive(Clone, Debug)]
pub enum Outcome {
    /// Equilibrium was found; the trial holds it.
    Converged(Report),
    /// Equilibrium was not found; the state is unchanged. The number counts the linear solves.
    Rejected(Rejection, usize),
}

/// Counts linear solves and reports each.
pub struct Solves<'a> {
    /// Number of solves so far.
    pub count: usize,
    tell: &'a mut dyn FnMut(usize),
}

impl<'a> Solves<'a> {
    /// Starts at zero; `tell` is called after each solve with their number.
    pub fn new(tell: &'a mut dyn FnMut(usize)) -> Self {
        Self { count: 0, tell }
    }

    /// Counts one more solve.
    pub fn one_more(&mut self) {
        self.count += 1;
        (self.tell)(self.count);
    }
}
