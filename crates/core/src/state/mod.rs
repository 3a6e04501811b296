//! State of a run: all that an increment changes for good, its energies, and the rows and fields that show it.

mod clock;
mod energies;
mod energy_balance;
mod frame;
mod history_row;
mod method;
mod pose;
mod summary;
mod touch;

use serde::{Deserialize, Serialize};
use wythe_contact::{InterfaceHistory, PointPair};

use crate::material::MaterialHistory;

pub use clock::Clock;
pub use energies::{Energies, QUIET, is_moving};
pub use energy_balance::EnergyBalance;
pub use frame::{Frame, InterfaceFrame, InterfaceState};
pub use history_row::HistoryRow;
pub use method::Method;
pub use pose::{PointPose, Poses};
pub use summary::{Fall, FallenBody, Lost, Status, Summary};
pub use touch::{Kind, Touch};

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
