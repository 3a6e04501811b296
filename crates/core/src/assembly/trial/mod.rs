//! Working data of one increment.

mod cells;
mod points;
mod shift;
mod ties;

pub use cells::TrialCells;
pub use points::{TrialJoints, TrialSolids, TrialTouches};
pub(super) use shift::STIFFEST;
pub use shift::{STIFFEST_UNDER_LOADS, TrialShift};
pub use ties::TrialTies;

use super::general::Live;
use crate::state::State;

/// Working data of one increment. It may be dropped at any time without a change of results.
#[derive(Clone, Debug, Default)]
// More than 15 fields: positions, forces and loads beside one for each kind of part.
pub struct Trial {
    /// Current positions [mm]. `[node]`
    pub x: Vec<[f64; 3]>,
    /// Positions at the last commit [mm]. Empty when the run begins. `[node]`
    pub x_start: Vec<[f64; 3]>,
    pub(super) displacement: Vec<[f64; 3]>,
    /// Forces and stiffness of the cells.
    pub cells: TrialCells,
    /// Internal forces of all nodes, supported ones included [N]. `[node][xyz]`
    pub node_force: Vec<[f64; 3]>,
    /// Generalised internal forces [N]. `[slot]`
    pub force: Vec<f64>,
    /// Mean magnitude of the elements' nodal forces [N].
    pub mean_nodal_force: f64,
    /// Points of the solids.
    pub solids: TrialSolids,
    /// Points of the joints.
    pub joints: TrialJoints,
    /// Touches of general contact.
    pub general: TrialTouches,
    /// Tractions and numerical stiffness of the shifted penalty.
    pub shift: TrialShift,
    /// Positions of the driven ends of the springs [mm]. `[spring][xyz]`
    pub spring_ends: Vec<[f64; 3]>,
    /// Ties.
    pub ties: TrialTies,
    /// Values of the named loads. `[load]`
    pub loads: Vec<[f64; 3]>,
    /// Least numerical stiffness of the points over the mass behind them [1/s²]; 0 without inertia.
    pub inertia: f64,
    /// Cells that are evaluated. None: all cells.
    pub awake: Option<Awake>,
}

/// Cells near moving nodes. Forces and stiffness of all others are those of the last evaluation.
#[derive(Clone, Debug, Default)]
pub struct Awake {
    /// Solids. `[element]`
    pub(in crate::assembly) elements: Vec<bool>,
    /// Planned contact. `[slave facet]`
    pub(in crate::assembly) facets: Vec<bool>,
}

impl Trial {
    /// Begins an increment from the committed state.
    pub fn start(&mut self, state: &State) {
        self.solids.history.clone_from(&state.material);
        self.solids.marks.clear();
        self.joints.start(&state.interface, &state.pairs);
        self.shift.start(&state.interface);
        self.cells.held.begin(&state.poses);
        self.inertia = 0.0;
        // An evaluation that fails ends early. Its missing entries must be empty, not those of an earlier
        // increment.
        self.cells.force.clear();
        self.solids.energy.clear();
        self.ties.segments.clear();
        self.general.touches.clear();
        self.general.loss = [0.0; 2];
        self.awake = None;
    }

    /// Copy to which the trial can be restored, without the cells' stiffness, which takes most of its memory.
    #[must_use]
    pub fn without_stiffness(&mut self) -> Self {
        let stiffness = std::mem::take(&mut self.cells.stiffness);
        let copy = self.clone();
        self.cells.stiffness = stiffness;
        copy
    }

    /// Restores a copy made without stiffness. The cells keep their present stiffness, so that the next
    /// evaluation with tangents can reuse it.
    pub fn go_back(&mut self, copy: Self) {
        let now = std::mem::replace(self, copy);
        self.cells.take_stiffness(now.cells);
    }

    /// Whether the increment has named loads: the numerical stiffness may grow to that of the law.
    pub(super) fn is_under_loads(&self) -> bool {
        self.shift.stiffest > STIFFEST
    }

    /// Whether the tractions of the last iterate belong to the touches of this one.
    pub fn is_settled(&self) -> bool {
        self.general.touches.iter().all(|one| one.settled)
    }

    /// Whether a pair of general contact is near but open.
    pub fn may_meet(&self) -> bool {
        self.general.touches.iter().any(Live::is_open)
    }

    /// Takes the normal tractions of the last iterate as bounds of the shear of the next one.
    pub(super) fn bound_by_traction(&mut self) {
        self.shift.bound_by_traction();
        let touches = self.general.touches.iter_mut();
        touches.for_each(Live::bound_by_traction);
    }

    /// Takes over the tractions of this iterate, and `others` at the given points.
    pub fn take_tractions(&mut self, others: Vec<(usize, [f64; 3])>) {
        self.keep_tractions();
        for (point, traction) in others {
            self.shift.traction[point] = traction;
        }
        self.bound_by_traction();
    }

    /// Takes over the tractions of this iterate as those of the last one, and adapts the numerical stiffness.
    pub fn keep_tractions(&mut self) {
        let history = &self.joints.history;
        if let Some(awake) = &self.awake {
            // Only part of the cells was evaluated. Status changes are counted in iterates of all cells only.
            self.shift.keep_awake(history, awake);
            return;
        }
        self.shift.keep(history);
        let mut steady = self.shift.is_steady(&self.joints.status);
        for one in &mut self.general.touches {
            steady &= one.keep_traction();
        }
        self.shift.stiffen(steady);
    }
}
