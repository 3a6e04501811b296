//! Result of one case with one method.

/// Verdict on a case with a method.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// The run ended as required and every expectation holds. Largest error against the references [-]; none if no
    /// expectation has one.
    Completed(Option<f64>),
    /// The run ended as required, but with a wrong answer: a list of the errors found.
    Wrong(Vec<String>),
    /// The run lost convergence: the place, and the solver's reason in short.
    Diverged(Place, String),
    /// The run exceeded its time limit.
    Stopped(Place),
    /// The method does not apply, for this reason.
    Inapplicable(String),
    /// The run ended with an error or a panic.
    Broken(String),
}

/// Last point of the load history that a run reached.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Place {
    /// Step, from 0.
    pub step: usize,
    /// Completed part of the step [-].
    pub done: f64,
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "step {} at {:.1} %", self.step, 100.0 * self.done)
    }
}

/// Cost of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    /// Committed increments.
    pub increments: usize,
    /// Linear solves.
    pub iterations: usize,
    /// Cut-backs.
    pub cutbacks: usize,
    /// CPU time of the thread [s]; wall time if the system does not report CPU time.
    pub seconds: f64,
}

/// One case with one method.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Name of the method.
    pub method: String,
    /// Verdict on the run.
    pub verdict: Verdict,
    /// Cost of the run.
    pub cost: Cost,
    /// Every expectation in words, with its measured value.
    pub measured: Vec<String>,
    /// Largest out-of-balance force of any row over the mean nodal force, with all laws implicit [-].
    pub out_of_balance: f64,
    /// Energy imbalance [-].
    pub energy: f64,
    /// Procedures that solved the increments, with the number of increments of each; empty if one procedure solved
    /// all.
    pub procedures: Vec<(String, usize)>,
}

impl Cell {
    /// Reason in words why the cell is not completed.
    pub fn why(&self) -> Option<String> {
        match &self.verdict {
            Verdict::Completed(_) | Verdict::Stopped(_) => None,
            Verdict::Wrong(reasons) => Some(reasons.join("; ")),
            Verdict::Diverged(_, why) | Verdict::Inapplicable(why) | Verdict::Broken(why) => {
                Some(why.clone())
            }
        }
    }
}
