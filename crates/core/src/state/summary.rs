//! How a run ended, as the solver knows it.

use crate::model::mirrored::MirrorPlane;
use crate::model::sizes::Sizes;

/// Bodies that a sentence names; the others are counted.
const NAMES: usize = 4;

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// All steps done.
    Completed,
    /// Statics found no equilibrium, inertia took over, and bodies fell: there is none.
    Collapsed,
    /// Convergence was lost; everything before is kept.
    NotConverged,
    /// Stopped by the user after a whole increment.
    Interrupted,
}

/// Bodies that move under inertia, to which `auto` went over because statics found no equilibrium.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[allow(non_snake_case)]
pub struct Fall {
    /// Step in which inertia took over, from 0.
    pub step: usize,
    /// Its name in the deck.
    pub step_name: String,
    /// Part of that step's loads and displacements at the last equilibrium [-].
    pub load_factor: f64,
    /// Kinetic energy at the end [J].
    pub kinetic_energy_J: f64,
    /// Bodies that moved most, those that moved farther than half as far; the farthest first.
    pub bodies: Vec<FallenBody>,
}

/// A body that moved under inertia.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FallenBody {
    /// Name in the deck.
    pub name: String,
    /// Its number, as `unit` of the fields.
    pub unit: u32,
    /// Mean displacement since the last equilibrium [mm].
    pub moved_mm: f64,
    /// Its part along gravity [mm].
    pub fall_mm: f64,
}

/// Where convergence was lost, and why.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Lost {
    /// Where, in words: load factor, step and its name.
    pub place: String,
    /// What was not found.
    pub why: String,
}

/// What `solve` returns when it ends: everything of `summary.json` that the solver knows.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct Summary {
    /// How it ended.
    pub status: Status,
    /// Where, why and what to try, if it did not complete.
    pub message: String,
    /// What moved under inertia when it ended, if that took over from statics.
    pub fall: Option<Fall>,
    /// Where convergence was lost, if it was.
    pub lost: Option<Lost>,
    /// Sizes of the model.
    pub sizes: Sizes,
    /// Planes that the model is mirrored by, if one half of it was solved; two of a quarter.
    #[serde(skip)]
    pub mirror_planes: Vec<MirrorPlane>,
    /// Converged increments.
    pub increments: usize,
    /// Linear solves.
    pub iterations: usize,
    /// Cut-backs.
    pub cutbacks: usize,
    /// Factorisations.
    pub factorisations: usize,
    /// How many of them the branches of the matrix without a change saved, by their operations.
    pub reused: f64,
    /// Solves of regions by themselves, between those of the whole.
    pub local_solves: usize,
    /// Evaluations of all forces, those of the line search among them.
    pub evaluations: usize,
    /// CPU-independent wall seconds by phase: elements, contact, assembly, factorise, solve, output.
    pub seconds_by_phase: [f64; 6],
    /// Threads used.
    pub threads: usize,
    /// Warnings of the run (those of the model are the checker's).
    pub warnings: Vec<String>,
    /// Where the procedure changed, and why.
    pub log: Vec<String>,
}

impl Summary {
    /// Of a run that has done nothing yet; complete, if nothing happens to it.
    pub fn begun(sizes: Sizes, threads: usize) -> Self {
        Self {
            status: Status::Completed,
            message: String::new(),
            fall: None,
            lost: None,
            sizes,
            mirror_planes: Vec::new(),
            increments: 0,
            iterations: 0,
            cutbacks: 0,
            factorisations: 0,
            reused: 0.0,
            local_solves: 0,
            evaluations: 0,
            seconds_by_phase: [0.0; 6],
            threads,
            warnings: Vec::new(),
            log: Vec::new(),
        }
    }
}

impl Fall {
    /// A collapse in one sentence.
    pub fn collapsed(&self) -> String {
        format!(
            "collapsed at load factor {:.4} of step {} ({}): {}; kinetic energy {:.3} J",
            self.load_factor,
            self.step,
            self.step_name,
            self.moved(),
            self.kinetic_energy_J
        )
    }

    /// Which bodies moved, and how far.
    pub fn moved(&self) -> String {
        let Some(first) = self.bodies.first() else {
            return "nothing moved".to_owned();
        };
        let names: Vec<&str> = self.bodies.iter().map(|body| body.name.as_str()).collect();
        let names = match names[..] {
            [only] => only.to_owned(),
            [ref some @ .., last] if names.len() <= NAMES => {
                format!("{} and {last}", some.join(", "))
            }
            _ => format!(
                "{} and {} others",
                names[..NAMES - 1].join(", "),
                names.len() - (NAMES - 1)
            ),
        };
        // Down rather than aside.
        let falls = first.fall_mm > std::f64::consts::FRAC_1_SQRT_2 * first.moved_mm;
        let (verb, by) = if falls {
            ("fell", first.fall_mm)
        } else {
            ("moved", first.moved_mm)
        };
        let most = if self.bodies.len() == 1 { "" } else { "up to " };
        format!("{names} {verb} by {most}{by:.1} mm")
    }
}

impl Summary {
    /// The summary of a whole scene that ended, with its collapse in words.
    pub(crate) fn in_words(mut self) -> Self {
        if let (Status::Collapsed, Some(fall)) = (self.status, &self.fall) {
            self.message = fall.collapsed();
        }
        self
    }
}
