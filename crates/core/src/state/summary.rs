//! End of a run, as the solver knows it.

use super::FirstDamage;
use crate::model::mirrored::MirrorPlane;
use crate::model::sizes::Sizes;

/// Largest number of bodies that a sentence names. The others are counted.
const NAMES: usize = 4;

/// Outcome of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// All steps were completed.
    Completed,
    /// Statics found no equilibrium, inertia took over, and bodies fell.
    Collapsed,
    /// Convergence was lost. Earlier results are kept.
    NotConverged,
    /// Interrupted by the user (Ctrl-C, a signal) after a complete increment.
    Interrupted,
    /// Stopped by a callback of the calling program after a complete increment.
    Stopped,
}

/// Bodies that move under inertia, after `auto` found no static equilibrium.
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
    /// Bodies that moved at least half as far as the farthest one, in descending order.
    pub bodies: Vec<FallenBody>,
    /// Number and name of a later step, if the fall was found in that.
    #[serde(default)]
    pub found_in: Option<String>,
}

/// A body that moved under inertia.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FallenBody {
    /// Name in the deck.
    pub name: String,
    /// Its number, called `unit` in the fields.
    pub unit: u32,
    /// Mean displacement since the last equilibrium [mm].
    pub moved_mm: f64,
    /// Its part along gravity [mm].
    pub fall_mm: f64,
}

/// Place and reason of a loss of convergence.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Lost {
    /// Place in words: load factor, step and its name.
    pub place: String,
    /// Reason.
    pub why: String,
}

/// Result of `solve`: everything in `summary.json` that the solver knows.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
// More than 15 fields: one for each fact of a run.
pub struct Summary {
    /// Outcome.
    pub status: Status,
    /// Place, reason and advice, if the run did not complete.
    pub message: String,
    /// Bodies that moved under inertia at the end, if it had taken over from statics.
    pub fall: Option<Fall>,
    /// Loss of convergence, if any.
    pub lost: Option<Lost>,
    /// Sizes of the model.
    pub sizes: Sizes,
    /// Mirror planes, if one half of the model was solved; two planes for a quarter.
    #[serde(skip)]
    pub mirror_planes: Vec<MirrorPlane>,
    /// Whether the run ended because the part that was solved lost the symmetry of the whole.
    #[serde(skip)]
    pub lost_symmetry: bool,
    /// Converged increments.
    pub increments: usize,
    /// Linear solves.
    pub iterations: usize,
    /// Number of times that increments were cut.
    pub cutbacks: usize,
    /// Factorisations.
    pub factorisations: usize,
    /// Number of factorisations saved by reusing branches of the tree, measured by their operations.
    pub reused: f64,
    /// Solves of regions, between those of the whole model.
    pub local_solves: usize,
    /// Evaluations of all forces, with those of the line search.
    pub evaluations: usize,
    /// Wall seconds by phase: elements, contact, assembly, factorise, solve, output.
    pub seconds_by_phase: [f64; 6],
    /// Threads used.
    pub threads: usize,
    /// First damage of joints and solids.
    pub first_damage: FirstDamage,
    /// Warnings of the run. Those of the model belong to the checker.
    pub warnings: Vec<String>,
    /// Changes of procedure and their reasons.
    pub log: Vec<String>,
}

impl Summary {
    /// Summary at the start of a run. Its status is that of a run without incidents.
    pub fn begun(sizes: Sizes, threads: usize) -> Self {
        Self {
            status: Status::Completed,
            message: String::new(),
            fall: None,
            lost: None,
            sizes,
            mirror_planes: Vec::new(),
            lost_symmetry: false,
            increments: 0,
            iterations: 0,
            cutbacks: 0,
            factorisations: 0,
            reused: 0.0,
            local_solves: 0,
            evaluations: 0,
            seconds_by_phase: [0.0; 6],
            threads,
            first_damage: FirstDamage::default(),
            warnings: Vec::new(),
            log: Vec::new(),
        }
    }
}

impl Fall {
    /// Collapse in one sentence.
    pub fn collapsed(&self) -> String {
        let equilibrium = format!(
            "load factor {:.4} of step {} ({})",
            self.load_factor, self.step, self.step_name
        );
        let place = match &self.found_in {
            None => format!("at {equilibrium}"),
            Some(later) => format!("in {later}; the last equilibrium was at {equilibrium}"),
        };
        format!(
            "collapsed {place}: {}; kinetic energy {:.3} J",
            self.moved(),
            self.kinetic_energy_J
        )
    }

    /// Bodies that moved, and their displacements, in words.
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
        // Downwards rather than sideways.
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
    /// Summary of the whole scene, with its collapse in words.
    pub(crate) fn in_words(mut self) -> Self {
        if let (Status::Collapsed, Some(fall)) = (self.status, &self.fall) {
            self.message = fall.collapsed();
        }
        self
    }
}
