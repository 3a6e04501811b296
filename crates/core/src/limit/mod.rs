//! Limit analysis: the largest factor of the live loads that rigid units on their joints carry
//! (docs/theory/limit-analysis.md).
//!
//! Joints are the polygons in which faces of units touch at rest. Forces act at their corners, within a cone of
//! friction, without tension unless the bond counts. The static theorem gives the factor, its dual the mechanism.

mod actions;
mod bodies;
mod joints;
mod picture;
mod program;
mod yield_surface;

use nalgebra::Vector3;
use serde::Serialize;

pub use actions::Live;
pub use joints::Strength;
pub use picture::picture;

use crate::model::Model;
use actions::{Actions, live_step};
use bodies::Bodies;
use joints::Joint;
use program::{Program, Solution};
use yield_surface::YieldSurface;

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
    /// The solver of the program failed.
    #[error("the cone program was not solved: {0}")]
    Solver(String),
}

impl LimitError {
    /// What a user can do.
    pub fn advice(&self) -> &'static str {
        match self {
            Self::NothingLive => {
                "add a step of the kind drive, load or tilt, or give the direction of a body force (--along x)"
            }
            Self::Symmetry => "model the whole scene for a limit analysis",
            Self::Weightless => "give the materials a density, and a step of gravity before",
            Self::Falls(_) | Self::FallsAt(_) => {
                "look at supports and contacts there; with bond: --bonded; a sloping dry joint needs friction"
            }
            Self::Unbounded => {
                "strut action between supports that do not yield: give a compressive strength (--strength), or \
                 let the top move vertically"
            }
            Self::Solver(_) => "look for joints that almost do not touch, or report the deck",
        }
    }
}

/// Result of a limit analysis.
#[derive(Clone, Debug, Serialize)]
pub struct LimitAnalysis {
    /// Largest factor of the live loads.
    pub factor: f64,
    /// What it multiplies.
    pub live: Live,
    /// Index of the live step.
    pub step: usize,
    /// What it multiplies, in words.
    pub live_load: String,
    /// Force along the drive [kN]; `None` if the live load is none.
    #[serde(rename = "force_kN")]
    pub force: Option<f64>,
    /// Certificate: distance of the factor to that of the mechanism, an upper bound of the last program, over the
    /// factor [-].
    pub gap: f64,
    /// Factor with associated friction, where sliding has no dilatancy.
    pub associated_factor: f64,
    /// Number of programs that were solved.
    pub programs: usize,
    /// Whether the forces of consecutive programs agree.
    pub converged: bool,
    /// Number of bodies that can move, of joints, and of their corners.
    pub sizes: [usize; 3],
    /// Units with their mechanism.
    pub mechanism: Vec<MovedUnit>,
    /// Resultants of the joints.
    pub joints: Vec<JointForce>,
}

/// Motion of a unit in the mechanism. The fastest point of all moves by 1.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MovedUnit {
    /// Number of the unit in the mesh.
    pub unit: u32,
    /// Its name.
    pub name: String,
    /// Point to which the velocity belongs [mm].
    pub centre_mm: [f64; 3],
    /// Velocity of the centre.
    pub velocity: [f64; 3],
    /// Spin [1/mm].
    pub spin: [f64; 3],
}

/// Resultant force in a joint: that of its second body on the first one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JointForce {
    /// Names of both bodies.
    pub bodies: [String; 2],
    /// Place: where the normal force acts, or the middle of a joint without one [mm].
    pub at_mm: [f64; 3],
    /// Force [N].
    #[serde(rename = "force_N")]
    pub force: [f64; 3],
    /// Normal force, compression positive [N].
    #[serde(rename = "normal_N")]
    pub normal: f64,
    /// Part of the shear strength that is used [-].
    pub sliding: f64,
    /// Corners of the joint [mm].
    pub corners_mm: Vec<[f64; 3]>,
}

/// Largest number of programs of a run.
const MOST_PROGRAMS: usize = 40;
/// Change of the factor from program to program at which the forces have settled.
const SETTLED: f64 = 1e-4;

/// Limit analysis of a model.
///
/// # Errors
/// [`LimitError`].
#[expect(clippy::too_many_lines, reason = "the steps of an analysis, in order")]
pub fn analyse(model: &Model, settings: &LimitSettings) -> Result<LimitAnalysis, LimitError> {
    let (step, live) = match (live_step(model), settings.along) {
        (_, Some(_)) => (model.steps.len().saturating_sub(1), Live::BodyForce),
        (Some(found), None) => found,
        (None, None) => return Err(LimitError::NothingLive),
    };
    let Some(live_step) = model.steps.get(step) else {
        return Err(LimitError::NothingLive);
    };
    let bodies = Bodies::of(model, live_step)?;
    let actions = Actions::of(model, &bodies, (step, live), settings.along)?;
    let joints = Joint::all(model, &bodies, settings.bonded);
    let reactions: Vec<_> = bodies
        .reactions
        .iter()
        .chain(&actions.springs)
        .cloned()
        .collect();
    let solve = |surface: &YieldSurface<'_>| {
        let program = Program {
            bodies: &bodies,
            joints: &joints,
            corners: surface.corners(),
            loads: [&actions.dead, &actions.live],
            strength: settings.strength,
            reactions: &reactions,
        };
        program.solve().map_err(|why| match why {
            LimitError::Falls(body) => {
                let unit = bodies.all.get(body).map_or(0, |body| body.unit);
                LimitError::FallsAt(model.mesh.called(unit))
            }
            other => other,
        })
    };
    let mut surface = YieldSurface::new(&joints);
    let first = solve(&surface)?;
    let associated_factor = first.factor;
    let iterates = !settings.associated;
    let mut search = Search {
        best: first,
        programs: 1,
        converged: !iterates,
    };
    if iterates {
        search.settle(&mut surface, &solve)?;
    }
    let shown = Shown {
        model,
        bodies: &bodies,
        joints: &joints,
        surface: &surface,
        solution: &search.best,
    };
    let factor = search.best.factor;
    Ok(LimitAnalysis {
        factor,
        live,
        step,
        live_load: live.told(&live_step.name),
        force: (live == Live::Drive).then_some(1e-3 * factor),
        gap: search.best.gap,
        associated_factor,
        programs: search.programs,
        converged: search.converged,
        sizes: [
            bodies
                .all
                .iter()
                .filter(|body| !body.motions.is_empty())
                .count(),
            joints.len(),
            surface.corners().len(),
        ],
        mechanism: shown.mechanism(),
        joints: shown.joint_forces(),
    })
}

/// Search for forces that lie on the yield surface that they define.
struct Search {
    best: Solution,
    programs: usize,
    converged: bool,
}

impl Search {
    /// Repeats the program with the surface of the last forces until the factor settles.
    fn settle(
        &mut self,
        surface: &mut YieldSurface<'_>,
        solve: &dyn Fn(&YieldSurface<'_>) -> Result<Solution, LimitError>,
    ) -> Result<(), LimitError> {
        let mut settled = 0;
        while self.programs < MOST_PROGRAMS {
            surface.follow(&self.best.forces, self.programs);
            let next = solve(surface)?;
            self.programs += 1;
            let change = (next.factor - self.best.factor).abs();
            let small = change <= SETTLED * next.factor.abs();
            settled = if small { settled + 1 } else { 0 };
            self.best = next;
            // Two small changes: one may be the turn of a swing.
            if settled == 2 && surface.holds(&self.best.forces) {
                self.converged = true;
                break;
            }
        }
        Ok(())
    }
}

/// What the result shows of a solution.
struct Shown<'a> {
    model: &'a Model,
    bodies: &'a Bodies,
    joints: &'a [Joint],
    surface: &'a YieldSurface<'a>,
    solution: &'a Solution,
}

impl Shown<'_> {
    fn called(&self, body: usize) -> String {
        self.model.mesh.called(self.bodies.all[body].unit)
    }

    /// Motions of all units, with the fastest node at a speed of 1.
    fn mechanism(&self) -> Vec<MovedUnit> {
        let mesh = &self.model.mesh;
        let of_unit = mesh.unit.iter().zip(&self.bodies.of_element);
        let of_unit: std::collections::BTreeMap<u32, usize> =
            of_unit.map(|(unit, body)| (*unit, *body)).collect();
        let speed = |(n, body): (usize, &Option<usize>)| {
            body.map_or(0.0, |body| {
                self.velocity(body, Vector3::from(mesh.nodes[n])).norm()
            })
        };
        let nodes = self.bodies.of_node.iter().enumerate();
        let fastest = nodes.map(speed).fold(0.0, f64::max);
        let scale = if fastest > 0.0 { 1.0 / fastest } else { 1.0 };
        let moved = of_unit.into_iter().map(|(unit, body)| {
            let [velocity, spin] = self.solution.mechanism[body];
            MovedUnit {
                unit,
                name: mesh.called(unit),
                centre_mm: self.bodies.all[body].centre.into(),
                velocity: (scale * velocity).into(),
                spin: (scale * spin).into(),
            }
        });
        moved.collect()
    }

    fn velocity(&self, body: usize, x: Vector3<f64>) -> Vector3<f64> {
        let [velocity, spin] = self.solution.mechanism[body];
        velocity + spin.cross(&(x - self.bodies.all[body].centre))
    }

    fn joint_forces(&self) -> Vec<JointForce> {
        let corners = self.surface.corners();
        let mut first = 0;
        let mut shown = Vec::with_capacity(self.joints.len());
        for joint in self.joints {
            let count = joint.corners.len();
            let own = first..first + count;
            first += count;
            let mut force = Vector3::zeros();
            let (mut normal, mut at, mut strength) = (0.0, Vector3::zeros(), 0.0);
            for v in own {
                let [n, a, b] = self.solution.forces[v];
                let along = [-joint.frame[0] * n, joint.frame[1] * a, joint.frame[2] * b];
                force += along.iter().sum::<Vector3<f64>>();
                normal += n;
                at += n * corners[v].at;
                strength += joint.strength.friction * n
                    + joint.strength.cohesion * joint.area / count as f64;
            }
            let shear = force - joint.frame[0] * force.dot(&joint.frame[0]);
            let pressed = normal > 0.0;
            shown.push(JointForce {
                bodies: joint.bodies.map(|body| self.called(body)),
                at_mm: if pressed { at / normal } else { joint.middle() }.into(),
                force: force.into(),
                normal,
                sliding: if strength > 0.0 {
                    shear.norm() / strength
                } else {
                    0.0
                },
                corners_mm: joint.corners.iter().map(|x| (*x).into()).collect(),
            });
        }
        shown
    }
}
