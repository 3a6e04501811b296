//! State of a run: all data that an increment changes permanently, its energies, and the rows and fields of its
//! results.

mod clock;
mod energies;
mod energy_balance;
mod first_damage;
mod frame;
mod history_row;
mod method;
mod motion;
mod pose;
mod summary;
mod tie;
mod touch;

use serde::{Deserialize, Serialize};
use wythe_contact::{InterfaceHistory, PointPair};

use crate::material::MaterialHistory;

pub use clock::Clock;
pub(crate) use energies::is_moving;
pub use energies::{Energies, QUIET};
pub use energy_balance::EnergyBalance;
pub use first_damage::{CRACKED, CRUSHED, FirstDamage, Onset};
pub use frame::{Frame, InterfaceFrame, InterfaceState, OutputField};
pub use history_row::HistoryRow;
pub use method::Method;
pub use motion::{ForceBy, Motion};
pub use pose::{PointPose, Poses};
pub use summary::{Fall, FallenBody, Lost, Status, Summary};
pub use tie::TieHistory;
pub use touch::{Kind, Touch};

/// The last committed increment, from which the next one is extrapolated.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LastIncrement {
    /// Change of the generalised displacements [mm]. `[slot]`
    pub dq: Vec<f64>,
    /// Change of the tractions of the contact points [MPa]. `[slave facet][point]`
    pub dtraction: Vec<[f64; 3]>,
    /// Its size in step time [s].
    pub dt: f64,
    /// Part of the step's loads that it added.
    pub load: f64,
}

/// Converged state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
// More than 15 fields: all that a commit changes, which a checkpoint holds.
pub struct State {
    /// Number of increments.
    pub increments: usize,
    /// Step time since the start of the run [s].
    pub time: f64,
    /// Generalised displacements [mm]. `[slot]`
    pub q: Vec<f64>,
    /// Generalised velocities [mm/s]. Zero after a step without inertia. `[slot]`
    pub velocity: Vec<f64>,
    /// Generalised accelerations [mm/s²]. Zero after a step without inertia. `[slot]`
    pub acceleration: Vec<f64>,
    /// Generalised internal forces at the last commit [N]. `[slot]`
    pub force: Vec<f64>,
    /// Positions of the driven ends of the springs [mm]. `[spring][xyz]`
    pub spring_ends: Vec<[f64; 3]>,
    /// Forces of the springs on their nodes [N]. `[spring][xyz]`
    pub spring_forces: Vec<[f64; 3]>,
    /// Histories of the ties. `[segment]`
    pub ties: Vec<TieHistory>,
    /// Values of the named loads. `[load]`
    pub loads: Vec<[f64; 3]>,
    /// Acceleration of the weights, less that of the ground, at the last commit [mm/s²].
    pub weights: [f64; 3],
    /// External forces on the beams at the last commit [N]. Zero at nodes. `[slot]`
    pub applied: Vec<f64>,
    /// Forces of the Rayleigh damping, or of the dashpots of a relaxation, at the last commit [N]. `[slot]`
    pub damping: Vec<f64>,
    /// Histories of the solids, eight to an element. `[element][gauss point]`
    pub material: Vec<MaterialHistory>,
    /// Histories of the joints, four to a facet. `[slave facet][point]`
    pub interface: Vec<InterfaceHistory>,
    /// Master facet and foot of each contact point. `[slave facet][point]`
    pub pairs: Vec<PointPair>,
    /// Touches of general contact.
    pub touches: Vec<Touch>,
    /// Positions at which stiffness is reused.
    pub poses: Poses,
    /// Last increment. None after a change of the boundary conditions.
    pub last: Option<LastIncrement>,
    /// The last increment with inertia, until another one is committed.
    pub moved: Option<LastIncrement>,
    /// Largest mean nodal force of all commits [N]. A part of it scales the tolerance where all forces vanish.
    pub largest_mean_force: f64,
    /// Energies.
    pub energies: Energies,
    /// Whether a body has moved farther than its joints reach while `auto` used inertia. The scene then differs from
    /// that at rest.
    pub fell: bool,
    /// Whether matrices of this step needed factors of double precision.
    pub wants_double: bool,
}
