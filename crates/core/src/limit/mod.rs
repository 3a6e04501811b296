//! Limit analysis: the largest factor of the live loads that rigid units on their joints carry
//! (docs/theory/limit-analysis.md).
//!
//! Joints are the polygons in which faces of units touch at rest. Forces act at their corners, within a cone of
//! friction, without tension unless the bond counts. The static theorem gives the factor, its dual the mechanism.

mod actions;
mod answer;
mod bodies;
mod borders;
mod interior;
mod joints;
mod matrix;
mod mirror;
mod program;
mod rods;
mod scales;
mod scene;
mod search;
mod unknowns;

pub use actions::Live;
pub use answer::{JointForce, LightBody, LimitAnalysis, MovedUnit, TieForce};
pub use joints::{Strength, convex_outline};

use crate::model::Model;
use actions::live_step;
use scene::RigidScene;
use search::Search;

/// What is asked.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LimitSettings {
    /// Associated friction: joints that slide also open, by the friction times the slip. The factor is then an upper
    /// bound. Otherwise sliding has no dilatancy.
    pub associated: bool,
    /// Whether joints have their tensile strength and cohesion, as if they softened never.
    pub bonded: bool,
    /// Compressive strength of the joints [MPa]; infinite if none.
    pub strength: Option<f64>,
    /// Direction of a body force over the weight that is the live load; that of the steps if none.
    pub along: Option<[f64; 3]>,
    /// Whether the program has the forces at all corners even where the scene is its own mirror image. The factor is
    /// the same.
    pub whole: bool,
}

/// Reason why there is no factor.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LimitError {
    /// No step drives, loads or tilts.
    #[error("no step drives, loads or tilts: there is nothing that a factor could multiply")]
    NothingLive,
    /// Planes of symmetry.
    #[error(
        "the deck models a part of a scene by [[symmetry]], and a mechanism need not be symmetric"
    )]
    Symmetry,
    /// A layer.
    #[error("the layer {0} is no rigid unit: it cracks over the joints that it covers")]
    Layer(String),
    /// No weight for a body force.
    #[error("the bodies have no weight before the live step, and the live load is a part of it")]
    Weightless,
    /// The dead loads alone cannot be carried; number of a body that moves.
    #[error(
        "the dead loads alone are more than the joints carry: the mechanism moves body {0} most"
    )]
    Falls(usize),
    /// The same, with the name of the body.
    #[error("the dead loads alone are more than the joints carry: the mechanism moves {0} most")]
    FallsAt(String),
    /// Every factor is carried.
    #[error("rigid units carry any factor: no mechanism lets the live loads do work")]
    Unbounded,
    /// No body can move.
    #[error("supports hold every body: no mechanism can form")]
    AllHeld,
    /// Every factor is carried by springs and ties, whose names these are.
    #[error("rigid units carry any factor: the live loads are held without limit by {0}")]
    Held(String),
    /// The solver of the program failed.
    #[error("the cone program was not solved: {0}")]
    Solver(String),
}

impl LimitError {
    /// What a user can do.
    pub fn advice(&self) -> &'static str {
        match self {
            Self::NothingLive => {
                "add a step of the kind drive, load or tilt, or give the direction of a body force (--along x); \
                 ground that settles loads nothing"
            }
            Self::Symmetry => "model the whole scene for a limit analysis",
            Self::Layer(_) => {
                "leave [[layers]] out for a limit analysis, or take strategy = \"simplified\""
            }
            Self::Weightless => "give the materials a density, and a step of gravity before",
            Self::Falls(_) | Self::FallsAt(_) => {
                "look at supports and contacts there; with bond: --bonded; a sloping dry joint needs friction"
            }
            Self::Unbounded => {
                "strut action between supports that do not yield: give a compressive strength (--strength), or \
                 let the top move vertically"
            }
            Self::AllHeld => "look at the supports: free the units that shall move",
            Self::Held(_) => {
                "springs have no strength: leave out those that may yield, or drive them in the live step; f_y gives \
                 one to a tie"
            }
            Self::Solver(_) => "look for joints that almost do not touch, or report the deck",
        }
    }
}

/// Largest number of programs of both searches without dilatancy.
pub const MOST_PROGRAMS: usize = 60;

/// How far a limit analysis has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Number of programs of the search without dilatancy that were solved; 0 before it.
    pub programs: usize,
    /// Factor of the last program; before the search the associated one, an upper bound. Of a drive the force [N].
    pub factor: f64,
    /// The same as a force along the drive [kN]; `None` if the live load is none.
    pub force: Option<f64>,
}

/// Limit analysis of a model.
///
/// # Errors
/// [`LimitError`].
pub fn analyse(model: &Model, settings: &LimitSettings) -> Result<LimitAnalysis, LimitError> {
    analyse_told(model, settings, &mut |_| ())
}

/// The same, which tells its progress: the associated factor, then each program of the search without dilatancy.
///
/// # Errors
/// [`LimitError`].
pub fn analyse_told(
    model: &Model,
    settings: &LimitSettings,
    tell: &mut dyn FnMut(Progress),
) -> Result<LimitAnalysis, LimitError> {
    if let Some(layer) = model.layers.first() {
        return Err(LimitError::Layer(layer.clone()));
    }
    let (step, live) = match (live_step(model), settings.along) {
        // In place of the live step, if the deck has one.
        (Some((step, _)), Some(_)) => (step, Live::BodyForce),
        (None, Some(_)) => (model.steps.len().saturating_sub(1), Live::BodyForce),
        (Some(found), None) => found,
        (None, None) => return Err(LimitError::NothingLive),
    };
    let Some(live_step) = model.steps.get(step) else {
        return Err(LimitError::NothingLive);
    };
    let scene = RigidScene::of(model, (step, live), settings)?;
    let first = scene.solve(settings, &[]);
    let first = first.map_err(|why| scene.reason(why, (step, live), settings))?;
    scene.stands(settings, &first)?;
    let associated_factor = first.factor;
    let search = if settings.associated {
        Search::associated(first)
    } else {
        tell(scene.progress(0, first.factor));
        Search::without_dilatancy(&scene, first, settings, tell)?
    };
    let best = &search.best;
    Ok(LimitAnalysis {
        factor: best.factor,
        live,
        step,
        live_load: live.told(&live_step.name),
        force: scene.force(best.factor),
        gap: best.gap,
        associated_factor,
        programs: search.programs,
        converged: search.converged,
        opening_work: best.opening_work,
        sizes: scene.sizes(),
        mirror: scene
            .unknowns
            .mirror
            .as_ref()
            .map(|mirror| ["x", "y", "z"][mirror.axis]),
        mechanism: scene.mechanism(best),
        joints: scene.joint_forces(best),
        ties: scene.tie_forces(best),
        light_body: scene.light_body(),
        note: scene.note(best.factor, associated_factor),
    })
}
