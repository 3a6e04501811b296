//! What came of one case with one method.

/// How a case went with a method.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// It ended as it should and every expectation holds; with the largest error against the
    /// references [-], if there are any that have one.
    Completed(Option<f64>),
    /// It ended as it should, with a wrong answer: each thing that is wrong.
    Wrong(Vec<String>),
    /// It lost convergence: where, and the refusal in short.
    Diverged(Place, String),
    /// It took longer than it was given.
    Stopped(Place),
    /// The method does not apply: why.
    Inapplicable(String),
    /// The run broke off with an error or a panic.
    Broken(String),
}

/// How far a run came.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Place {
    /// Step, from 0.
    pub step: usize,
    /// Part of it that is done [-].
    pub done: f64,
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "step {} at {:.1} %", self.step, 100.0 * self.done)
    }
}

/// What it took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    /// Committed increments.
    pub increments: usize,
    /// Linear solves.
    pub iterations: usize,
    /// Cut-backs.
    pub cutbacks: usize,
    /// CPU seconds of the thread; wall seconds where the system does not tell.
    pub seconds: f64,
}

/// One case with one method.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Name of the method.
    pub method: String,
    /// How it went.
    pub verdict: Verdict,
    /// What it took.
    pub cost: Cost,
    /// Every expectation in words, as measured.
    pub measured: Vec<String>,
    /// Largest out-of-balance force of any row over the mean nodal force, all laws implicit [-].
    pub out_of_balance: f64,
    /// Energy imbalance [-].
    pub energy: f64,
    /// What solved its increments and how many of them, where that changed.
    pub procedures: Vec<(String, usize)>,
}

impl Cell {
    /// Why it is not completed, in words.
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
