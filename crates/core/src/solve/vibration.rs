//! Natural vibrations: frequencies, shapes and modal masses of small motions about a state (docs/theory/vibration.md).
//!
//! The state is that at rest, or that of a frame of a run, from whose fields the stiffness is made: damage of the
//! solids, tractions and openings of the joints. So a frame of a run of a mirror half is that of the whole wall.

use std::cell::RefCell;
use std::f64::consts::TAU;

use nalgebra::Vector6;
use rustc_hash::FxHashSet;
use wythe_contact::JointLaw;

use crate::assembly::{Equations, PointMotion, System, Trial, bulk::BulkError};
use crate::linear::Backend;
use crate::linear::eigen::{EigenError, EigenPair, MassMatrix, lowest};
use crate::material::damage_plasticity::tension_weight;
use crate::material::{LocalFailure, MaterialHistory, MaterialParameters};
use crate::model::Model;
use crate::model::scene::{BeamMotion, HeldBy, Step};
use crate::model::ties::Installed;
use crate::state::{Frame, State};

/// Part of the mean edge of the facets up to which the gap of a joint at rest counts as rounding.
const CLOSED: f64 = 1e-6;
/// Part of the shift up to which an eigenvalue is zero: rounding errors of the stiffness.
const FREE: f64 = 1e-5;

/// State about which the model vibrates.
#[derive(Clone, Copy, Debug)]
pub enum About<'a> {
    /// At rest: elastic, without stress. All joints that touch are closed with their elastic stiffness.
    Rest,
    /// At a frame of a run: secant stiffness.
    Frame {
        /// Fields of the whole model.
        frame: &'a Frame,
        /// Step of the frame, whose beams are free or held.
        step: usize,
        /// When each tie was installed. Empty: all at rest. `[tie]`
        ties: &'a [Installed<'a>],
    },
}

/// A natural mode.
#[derive(Clone, Debug)]
pub struct Mode {
    /// ω² [1/s²]. Negative: the state is unstable, and the motion grows.
    pub eigenvalue: f64,
    /// Frequency ω/2π [Hz]; 0 if a body moves freely, or if ω² is negative.
    pub frequency: f64,
    /// Participation factors Γ of motion in x, y, z, for the shape as given.
    pub participation: [f64; 3],
    /// Effective modal masses in x, y, z [tonne].
    pub effective_mass: [f64; 3],
    /// Relative residual of the eigenpair.
    pub residual: f64,
    /// Shape, with a largest displacement of 1. `[node][xyz]`
    pub shape: Vec<[f64; 3]>,
}

impl Mode {
    /// Period [s]; infinite without a frequency.
    pub fn period(&self) -> f64 {
        1.0 / self.frequency
    }
}

/// The lowest modes of a model.
#[derive(Clone, Debug)]
pub struct Modes {
    /// The modes, the lowest first.
    pub modes: Vec<Mode>,
    /// Mass of the model [tonne].
    pub total_mass: f64,
    /// Mass in x, y, z that moves against the supports [tonne]: all modes together have this effective mass.
    pub moving_mass: [f64; 3],
    /// Number of modes without frequency: bodies that nothing holds.
    pub free: usize,
    /// Number of modes with a negative ω².
    pub unstable: usize,
    /// Part of the area of the planned joints that carries stiffness [-]; 1 without joints.
    pub closed_area: f64,
}

/// Errors of a search for modes.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum VibrationError {
    /// Something that can move has no mass.
    #[error("{place} has no mass, so it has no frequency: {}", densities(.materials))]
    NoMass {
        /// What has no mass.
        place: String,
        /// Names of the materials without density.
        materials: Vec<String>,
    },
    /// More modes than a study of a model asks for.
    #[error("{count} modes are too many: at most {most}")]
    TooMany {
        /// Number asked for.
        count: usize,
        /// Largest number.
        most: usize,
    },
    /// Supports and beams hold everything.
    #[error("nothing can move: supports and beams hold every node")]
    NothingMoves,
    /// The fields do not fit the model.
    #[error("the fields of the frame do not fit the model: {0}")]
    OtherModel(&'static str),
    /// An element or its material cannot be prepared.
    #[error(transparent)]
    Element(#[from] BulkError),
    /// An element has no stiffness.
    #[error("element {element}: {why}")]
    Local {
        /// The element.
        element: usize,
        /// The reason.
        why: LocalFailure,
    },
    /// The eigenvalue problem has no solution.
    #[error("the frequencies cannot be computed: {0}")]
    Eigen(#[from] EigenError),
}

fn densities(materials: &[String]) -> String {
    match materials {
        [] => "give every material a density".to_owned(),
        names => format!("give a density to {}", names.join(", ")),
    }
}

/// The `count` lowest modes, or all if the model has fewer. Supports hold their nodes, beams move as in the step,
/// ends of springs stay. General contact and follower pressures have no stiffness here. Ties that broke before a frame
/// count as whole.
///
/// # Errors
/// [`VibrationError`].
pub fn modes(model: &Model, about: About<'_>, count: usize) -> Result<Modes, VibrationError> {
    // Work on a thread of the pool, as runs do.
    rayon::scope(|_| Vibration::new(model, about)?.solve(count))
}

/// A model with its state.
struct Vibration<'a> {
    model: &'a Model,
    about: About<'a>,
    system: System,
    state: State,
    equations: Equations,
}

impl<'a> Vibration<'a> {
    fn new(model: &'a Model, about: About<'a>) -> Result<Self, VibrationError> {
        let mut system = System::deformable(model)?;
        let mut state = system.initial_state(model);
        let mut step = 0;
        if let About::Frame {
            frame,
            step: of,
            ties,
        } = about
        {
            step = of;
            check(model, frame, ties)?;
            for (slot, q) in state.q.iter_mut().enumerate() {
                let (node, _) = system.dofs.node_of(slot);
                if let Some(u) = frame.displacement.get(node) {
                    *q = system.dofs.of_node(slot, u);
                }
            }
            damage(model, frame, &mut state);
        }
        let steps = &model.steps;
        let held = Step {
            motion: vec![[BeamMotion::Locked; 3]; model.beams.len()],
            ..Step::default()
        };
        let step = steps.get(step).or(steps.first()).unwrap_or(&held);
        let equations = Equations::new(&system.dofs, step);
        Ok(Self {
            model,
            about,
            system,
            state,
            equations,
        })
    }

    fn solve(mut self, count: usize) -> Result<Modes, VibrationError> {
        if self.equations.is_empty() {
            return Err(VibrationError::NothingMoves);
        }
        let mass = self.mass()?;
        let mut trial = Trial::default();
        trial.start(&self.state);
        if let About::Frame { ties, .. } = self.about {
            self.system.install_ties(ties, &mut self.state, &mut trial);
        }
        let closed_area = self.write(&mut trial)?;
        let (entries, mut solver) = self
            .system
            .analyse(&self.equations, Backend::MultifrontalLlt)
            .map_err(EigenError::from)?;
        let mut values = vec![0.0; entries];
        self.system.fill(&trial, &mut values);
        let found = lowest(&mut solver, &values, &mass, count)?;
        let zero = FREE * found.shift.abs();
        let modes = found.pairs.iter().map(|pair| self.mode(pair, zero));
        let modes: Vec<Mode> = modes.collect();
        Ok(Modes {
            free: modes.iter().filter(|m| m.eigenvalue.abs() <= zero).count(),
            unstable: modes.iter().filter(|m| m.eigenvalue < -zero).count(),
            modes,
            total_mass: self.system.mass.total(),
            moving_mass: self.moving_mass(&mass),
            closed_area,
        })
    }

    /// Masses of the equations [tonne].
    fn mass(&self) -> Result<MassMatrix, VibrationError> {
        let dofs = &self.system.dofs;
        let slots = self.equations.slot_of.iter().map(|&slot| slot as usize);
        let lumped: Vec<f64> = slots.map(|slot| self.system.mass.slot[slot]).collect();
        let Some(light) = lumped.iter().position(|m| *m <= 0.0) else {
            return Ok(self.system.mass_of(&self.equations));
        };
        let slot = self.equations.slot_of[light] as usize;
        let mesh = &self.model.mesh;
        let place = if slot >= dofs.beam_start {
            let beam = (slot - dofs.beam_start) / 3;
            format!("the beam {}", self.model.beams[beam].name)
        } else {
            let node = dofs.node_of(slot).0;
            let own = |nodes: &[u32; 8]| nodes.contains(&(node as u32));
            match mesh.elements.iter().position(own) {
                Some(element) => mesh.body_of(element),
                None => format!("node {node}"),
            }
        };
        let without = self.model.materials.iter();
        let without = without.filter(|m| m.parameters.elastic().density <= 0.0);
        Err(VibrationError::NoMass {
            place,
            materials: without.map(|m| m.name.clone()).collect(),
        })
    }

    /// Writes the stiffness and returns the part of the joints' area that has some.
    fn write(&mut self, trial: &mut Trial) -> Result<f64, VibrationError> {
        let laws = &self.model.contact;
        let law = |point: usize| &laws.laws[usize::from(laws.slave_law[point / 4])];
        let edge = self.system.contact.edge();
        let points = &self.system.contact.points;
        let all: f64 = points.iter().map(|point| point.area).sum();
        let mirrors = mirrors(self.model);
        let closed = RefCell::new(0.0);
        let about = self.about;
        let stiffness = |at: PointMotion| {
            let law = law(at.point);
            let [normal, shear] = law.stiffness();
            let part = match about {
                About::Rest if at.gap > CLOSED * edge => 0.0,
                About::Rest => 1.0,
                About::Frame { frame, .. } => closed_part(frame, at.point, normal, law.is_dry()),
            };
            if part > 0.0 {
                *closed.borrow_mut() += at.area;
            }
            // The image behind a mirror slides alike.
            let facet = &laws.master_facets[at.facet as usize];
            let slides = facet.iter().all(|n| mirrors.contains(n));
            [part * normal, if slides { 0.0 } else { part * shear }]
        };
        self.system
            .write_small_motion(&self.state, trial, &stiffness)
            .map_err(|(element, why)| VibrationError::Local { element, why })?;
        let closed = closed.into_inner();
        Ok(if all > 0.0 { closed / all } else { 1.0 })
    }

    fn mode(&self, pair: &EigenPair, zero: f64) -> Mode {
        let dofs = &self.system.dofs;
        let mut q = vec![0.0; dofs.slots];
        for (&slot, x) in self.equations.slot_of.iter().zip(&pair.vector) {
            q[slot as usize] = *x;
        }
        let mut shape = vec![[0.0; 3]; self.model.mesh.nodes.len()];
        dofs.spread(&q, &mut shape);
        // L = Σ m u with uᵀ M u = 1.
        let mut momentum = [0.0; 3];
        for (u, m) in shape.iter().zip(&self.system.mass.node) {
            (0..3).for_each(|i| momentum[i] += m * u[i]);
        }
        let largest = shape.iter().map(|u| length(*u)).fold(0.0, f64::max);
        // The sign of a shape is free; its largest displacement is positive.
        let farthest =
            shape.iter().flatten().fold(
                0.0,
                |most: f64, u| if u.abs() > most.abs() { *u } else { most },
            );
        let scale = largest.max(f64::MIN_POSITIVE).copysign(farthest);
        shape
            .iter_mut()
            .flatten()
            .for_each(|u| *u = if *u == 0.0 { 0.0 } else { *u / scale });
        Mode {
            eigenvalue: pair.value,
            frequency: if pair.value > zero {
                pair.value.sqrt() / TAU
            } else {
                0.0
            },
            participation: momentum.map(|l| l * scale),
            effective_mass: momentum.map(|l| l * l),
            residual: pair.residual,
            shape,
        }
    }

    /// Mass in x, y, z that moves against the supports [tonne].
    fn moving_mass(&self, mass: &MassMatrix) -> [f64; 3] {
        let mut forces = vec![0.0; self.system.dofs.slots];
        [0, 1, 2].map(|axis| {
            let mut way = [0.0; 3];
            way[axis] = 1.0;
            self.system.mass.forces(way, &mut forces);
            let slots = self.equations.slot_of.iter();
            let own: Vec<f64> = slots.map(|slot| forces[*slot as usize]).collect();
            mass.inverse_product(&own)
        })
    }
}

/// Nodes of mirrors, which stand for the other half of joints in planes of symmetry.
fn mirrors(model: &Model) -> FxHashSet<u32> {
    let supports = model.supports.iter();
    let mirrors = supports.filter(|support| support.by == HeldBy::Mirror);
    mirrors
        .flat_map(|support| support.nodes.iter().copied())
        .collect()
}

/// Part of the elastic stiffness of a joint at a point of a frame (docs/theory/vibration.md, eq. 2): all under
/// pressure, the secant σ/(k_n u) of a bond in tension, nothing where it is open.
fn closed_part(frame: &Frame, point: usize, normal: f64, dry: bool) -> f64 {
    let joints = &frame.interfaces;
    let (sigma, opening) = (joints.traction[point][0], joints.opening[point]);
    if sigma < 0.0 {
        1.0
    } else if sigma > 0.0 && opening > 0.0 {
        (sigma / (normal * opening)).min(1.0)
    } else if dry || joints.damage[point] > 0.0 {
        0.0
    } else {
        1.0
    }
}

/// Histories of the solids by the fields of a frame, those of an element alike at its points.
fn damage(model: &Model, frame: &Frame, state: &mut State) {
    for (e, points) in state.material.chunks_exact_mut(8).enumerate() {
        let (tension, compression) = (frame.tensile_damage[e], frame.compressive_damage[e]);
        let stress = Vector6::from(frame.stress[e]);
        let plastic = Vector6::from(frame.plastic_strain[e]);
        let material = &model.materials[usize::from(model.mesh.material[e])].parameters;
        let recovery = match material {
            MaterialParameters::DamagePlasticity(p) => [p.tension_recovery, p.compression_recovery],
            // Defaults of the damage law (docs/theory/damage-plasticity.md).
            _ => [0.0, 1.0],
        };
        let r = tension_weight(&stress);
        let [s_t, s_c] = [1.0 - recovery[0] * r, 1.0 - recovery[1] * (1.0 - r)];
        let damage = 1.0 - (1.0 - s_t * compression) * (1.0 - s_c * tension);
        points.fill(MaterialHistory {
            plastic_strain: plastic,
            viscous_strain: plastic,
            damage,
            viscous_damage: damage,
            tensile_damage: tension,
            compressive_damage: compression,
            stress,
            ..MaterialHistory::default()
        });
    }
}

/// Checks that the fields have the sizes of the model.
fn check(model: &Model, frame: &Frame, ties: &[Installed<'_>]) -> Result<(), VibrationError> {
    let (nodes, elements) = (model.mesh.nodes.len(), model.mesh.elements.len());
    let points = 4 * model.contact.slave_facets.len();
    let joints = &frame.interfaces;
    let fits = |since: &Installed<'_>| match since {
        Installed::At(u) => u.len() == nodes,
        Installed::AtRest | Installed::Later => true,
    };
    let fields = [
        (frame.displacement.len() == nodes, "its nodes are others"),
        (
            frame.stress.len() == elements
                && frame.plastic_strain.len() == elements
                && frame.tensile_damage.len() == elements
                && frame.compressive_damage.len() == elements,
            "its elements are others",
        ),
        (
            joints.traction.len() == points
                && joints.opening.len() == points
                && joints.damage.len() == points,
            "its joints are others",
        ),
        (
            (ties.is_empty() || ties.len() == model.ties.len()) && ties.iter().all(fits),
            "its ties are others",
        ),
    ];
    match fields.iter().find(|(fits, _)| !fits) {
        Some((_, why)) => Err(VibrationError::OtherModel(why)),
        None => Ok(()),
    }
}

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}
