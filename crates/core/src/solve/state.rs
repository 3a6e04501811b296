//! What a run changes, and no more than that: exactly one checkpoint.

use serde::{Deserialize, Serialize};
use wythe_contact::{InterfaceHistory, PointPair};

use crate::assembly::{Poses, Touch};
use crate::material::MaterialHistory;
use crate::results::curve::is_moving;

/// Energies since the start [N mm].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Energies {
    /// Work of reactions, loads, gravity and the ground, and the energy of initial velocities.
    pub external: f64,
    /// Elastic energy of solids and interfaces now.
    pub elastic: f64,
    /// Plastic work and damage of the solids.
    pub plastic_damage: f64,
    /// Dissipation of the interfaces.
    pub interface: f64,
    /// Viscous dissipation.
    pub viscous: f64,
    /// Kinetic energy now, relative to the ground.
    pub kinetic: f64,
    /// Work of the Rayleigh damping, and of the dashpots of relaxations.
    pub damping: f64,
    /// What the time integration has taken out.
    pub numerical: f64,
    /// What increments in equilibrium have left open: taken beyond the work done.
    #[serde(default)]
    pub leaked: f64,
}

impl Energies {
    /// What solids and interfaces have taken [N mm].
    pub fn taken(&self) -> f64 {
        self.elastic + self.plastic_damage + self.interface + self.viscous
    }

    /// Work done that is not accounted for [N mm].
    pub fn open(&self) -> f64 {
        self.external - self.taken() - self.kinetic - self.damping - self.numerical
    }

    /// Kinetic energy over what solids and interfaces have taken [-].
    pub fn moving(&self) -> f64 {
        if self.kinetic > 0.0 {
            self.kinetic / self.taken()
        } else {
            0.0
        }
    }

    /// Whether bodies move, or begin to, in the increment since `before`.
    pub fn moves_on(&self, before: &Self) -> bool {
        is_moving(self.kinetic, before.kinetic, self.taken())
    }

    /// What was dissipated since `before`, over that and the change of the elastic energy [-].
    pub fn dissipated_share(&self, before: &Self) -> f64 {
        let sum = |e: &Self| e.plastic_damage + e.interface + e.viscous;
        let dissipated = sum(self) - sum(before);
        let stored = (self.elastic - before.elastic).abs();
        if dissipated > 0.0 {
            dissipated / (dissipated + stored)
        } else {
            0.0
        }
    }
}

/// The last committed increment: what extrapolation starts from.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LastIncrement {
    /// Change of the generalised displacements [mm]. `[slot]`
    pub dq: Vec<f64>,
    /// Change of the tractions of the contact points [MPa]. `[slave facet][point]`
    pub dtraction: Vec<[f64; 3]>,
    /// Its step time [s].
    pub dt: f64,
    /// Part of the step's loads that it added.
    pub load: f64,
}

/// Converged state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Increments done.
    pub increments: usize,
    /// Step time since the start of the run [s].
    pub time: f64,
    /// Generalised displacements [mm]. `[slot]`
    pub q: Vec<f64>,
    /// Generalised velocities [mm/s]; zero after a step without inertia. `[slot]`
    pub velocity: Vec<f64>,
    /// Generalised accelerations [mm/s²]; zero after a step without inertia. `[slot]`
    pub acceleration: Vec<f64>,
    /// Generalised internal forces at the last commit [N]. `[slot]`
    pub force: Vec<f64>,
    /// Where the driven ends of the springs are [mm]. `[spring][xyz]`
    pub spring_ends: Vec<[f64; 3]>,
    /// Forces of the springs on their nodes [N]. `[spring][xyz]`
    pub spring_forces: Vec<[f64; 3]>,
    /// Values of the loads with a name. `[load]`
    pub loads: Vec<[f64; 3]>,
    /// Forces that act on the beams from outside at the last commit [N]; zero at nodes. `[slot]`
    pub applied: Vec<f64>,
    /// Forces of the Rayleigh damping, or of the dashpots of a relaxation, at the last commit [N]. `[slot]`
    pub damping: Vec<f64>,
    /// Histories of the solids. `[element][gauss point]`, eight to an element
    pub material: Vec<MaterialHistory>,
    /// Histories of the interfaces. `[slave facet][point]`, four to a facet
    pub interface: Vec<InterfaceHistory>,
    /// Which master facet each contact point faces. `[slave facet][point]`
    pub pairs: Vec<PointPair>,
    /// Where bodies touch by general contact.
    pub touches: Vec<Touch>,
    /// Where the stiffness of what hardly turns is taken.
    pub poses: Poses,
    /// Last increment, none after a change of the boundary conditions.
    pub last: Option<LastIncrement>,
    /// The last increment that inertia carried, from then on until another one is committed.
    pub moved: Option<LastIncrement>,
    /// Largest mean nodal force of any commit [N]: what is left of it when all forces vanish scales
    /// the tolerance.
    pub largest_mean_force: f64,
    /// Energies.
    pub energies: Energies,
    /// `auto` took inertia, and something went farther than its joints reach: it lies where it did not at rest.
    pub fell: bool,
    /// Matrices of this step wanted factors of double precision.
    pub wants_double: bool,
}
