//! Scratch of one increment, and how the tractions of its iterates follow one another.

use super::branch_holding::HeldBranches;
use super::bulk::Marks;
use super::general::Live;
use super::stiffness_reuse::Held;
use crate::material::{MaterialHistory, PointEnergy};
use crate::state::State;
use wythe_contact::{InterfaceHistory, PointPair, PointStatus};

/// Largest factor of the numerical stiffness [-].
pub(super) const STIFFEST: f64 = 8.0;
/// The same under loads with a name, which may be small beside the weight [-]: as stiff as the law.
pub const STIFFEST_UNDER_LOADS: f64 = 512.0;
/// Growth of the factor from the first of these on [-]; below it is 2.
const QUICKER: f64 = 4.0;

/// Scratch of one increment; may be dropped at any time without changing a result.
#[derive(Clone, Debug, Default)]
pub struct Trial {
    /// Current positions [mm]. `[node]`
    pub x: Vec<[f64; 3]>,
    pub(super) displacement: Vec<[f64; 3]>,
    /// Nodal forces of each cell [N]: elements, then contact pairs. `[cell][node][xyz]`
    pub cell_force: Vec<[[f64; 3]; 8]>,
    /// Stiffness of each cell [N/mm]. `[cell][CELL]`
    pub(super) cells: Vec<f64>,
    /// What the cells hold.
    pub(super) held: Held,
    /// Cells that have a stiffness now. `[cell]`
    pub(super) active: Vec<bool>,
    /// Cells whose stiffness was written, or began or ceased to count, since a matrix was last filled. `[cell]`
    pub(super) changed: Vec<bool>,
    /// Which filling that was.
    pub(super) filling: u64,
    /// Internal forces of the nodes, held ones too [N]. `[node][xyz]`
    pub node_force: Vec<[f64; 3]>,
    /// Generalised internal forces [N]. `[slot]`
    pub force: Vec<f64>,
    /// New histories of the solids. `[element][gauss point]`
    pub material: Vec<MaterialHistory>,
    /// Energies of the solids, integrated over each element [N mm]. `[element]`
    pub element_energy: Vec<PointEnergy>,
    /// What both histories of the solids hold; none: not looked at yet. `[element]`
    pub(super) marks: Vec<Marks>,
    /// New histories of the interfaces. `[point]`
    pub interface: Vec<InterfaceHistory>,
    /// Elastic energy and dissipation of each point [N mm]. `[point]`
    pub point_energy: Vec<[f64; 2]>,
    /// What each point does. `[point]`
    pub status: Vec<PointStatus>,
    /// Master facet of each point now, and the foot of its perpendicular. `[point]`
    pub pairs: Vec<PointPair>,
    /// Where the slip of this increment is measured from: the pair at the last commit, or where a
    /// point came into contact. `[point]`
    pub anchors: Vec<PointPair>,
    /// Whether a point faced nothing at the last commit. `[point]`
    pub free: Vec<bool>,
    /// Positions at the last commit [mm], none when the run begins. `[node]`
    pub x_start: Vec<[f64; 3]>,
    /// Tractions of the last iterate (shifted penalty) [MPa]. `[point]`
    pub traction: Vec<[f64; 3]>,
    /// Normal traction that bounds the shear of the next iterate (shifted penalty) [MPa]. `[point]`
    pub bounding: Vec<f64>,
    /// Its last change [MPa]: one of the other sign is a swing. `[point]`
    swing: Vec<f64>,
    /// Factor of the numerical stiffness of all points (shifted penalty) [-].
    pub stiffening: f64,
    /// The largest that it may grow to in this increment [-].
    pub stiffest: f64,
    /// Whether points at their shear limit resist along the slip: where a load turns round, what slid
    /// sticks.
    pub sticks: bool,
    /// Where the driven ends of the springs are [mm]. `[spring][xyz]`
    pub spring_ends: Vec<[f64; 3]>,
    /// Values of the loads with a name. `[load]`
    pub loads: Vec<[f64; 3]>,
    /// Least numerical stiffness of the points over the mass behind them [1/s²]; 0 without inertia.
    pub inertia: f64,
    /// What touches by general contact, or is near.
    pub touches: Vec<Live>,
    /// Energy that touches set free which are no more, and the work of their last forces in the increment
    /// [N mm].
    pub touch_loss: [f64; 2],
    /// Normal gaps where the forces were taken last [mm]. `[point]`
    pub(super) gaps: Vec<f64>,
    /// Positions there [mm], none where points were paired anew since. `[node]`
    pub(super) seen_at: Vec<[f64; 3]>,
    /// Points on branches without stiffness (shifted penalty).
    pub loose: HeldBranches,
    /// What each point did in the last iterate. `[point]`
    before: Vec<PointStatus>,
    /// Mean magnitude of the elements' nodal forces [N].
    pub mean_nodal_force: f64,
    /// What is evaluated; none: everything.
    pub awake: Option<Awake>,
}

/// Cells near what moves: the forces and stiffness of all others are those of the last evaluation.
#[derive(Clone, Debug, Default)]
pub struct Awake {
    /// Solids. `[element]`
    pub(super) elements: Vec<bool>,
    /// Planned contact. `[slave facet]`
    pub(super) facets: Vec<bool>,
}

impl Trial {
    /// Begins an increment from the committed state.
    pub fn start(&mut self, state: &State) {
        self.material.clone_from(&state.material);
        self.marks.clear();
        self.interface.clone_from(&state.interface);
        self.pairs.clone_from(&state.pairs);
        self.anchors.clone_from(&state.pairs);
        self.free.clear();
        self.free
            .extend(state.pairs.iter().map(|pair| pair.facet.is_none()));
        self.traction.clear();
        self.traction
            .extend(state.interface.iter().map(|h| h.traction));
        self.bound_by_traction();
        self.stiffening = 1.0;
        self.stiffest = STIFFEST;
        self.held.begin(&state.poses);
        self.inertia = 0.0;
        self.before.clear();
        self.loose.start();
        // A run that is resumed here does not have them.
        self.seen_at.clear();
        // Where a law gives no answer the evaluation ends early: what it leaves out is nothing, not
        // something of the increment before.
        self.cell_force.clear();
        self.element_energy.clear();
        self.point_energy.clear();
        self.touches.clear();
        self.touch_loss = [0.0; 2];
        self.awake = None;
    }

    /// A copy to go back to, without the stiffness: most of a trial's memory.
    #[must_use]
    pub fn without_stiffness(&mut self) -> Self {
        let cells = std::mem::take(&mut self.cells);
        let copy = self.clone();
        self.cells = cells;
        copy
    }

    /// Goes back to a copy without stiffness. The cells keep what they hold now: the next evaluation with tangents finds
    /// there what need not be written.
    pub fn go_back(&mut self, copy: Self) {
        let now = std::mem::replace(self, copy);
        self.cells = now.cells;
        self.held = now.held;
        self.active = now.active;
        self.changed = now.changed;
        self.filling = now.filling;
    }

    /// Whether the numerical stiffness may grow to that of the law.
    pub(super) fn is_under_loads(&self) -> bool {
        self.stiffest > STIFFEST
    }

    /// Whether the tractions of the last iterate are those of what touches.
    pub fn is_settled(&self) -> bool {
        self.touches.iter().all(|one| one.settled)
    }

    /// Whether anything near does not touch now.
    pub fn may_meet(&self) -> bool {
        self.touches.iter().any(Live::is_open)
    }

    /// The normal tractions of the last iterate bound the shear of the next one.
    pub(super) fn bound_by_traction(&mut self) {
        self.bounding.clear();
        self.bounding.extend(self.traction.iter().map(|t| t[0]));
        self.swing.clear();
        self.swing.resize(self.traction.len(), 0.0);
        self.touches.iter_mut().for_each(Live::bound_by_traction);
    }

    /// The tractions of this iterate become those of the last, but those of some points others.
    pub fn take_tractions(&mut self, others: Vec<(usize, [f64; 3])>) {
        self.keep_tractions();
        for (point, traction) in others {
            self.traction[point] = traction;
        }
        self.bound_by_traction();
    }

    /// The tractions of this iterate become those of the last. Where pressure and friction swing
    /// against one another, the bound moves by half the change only: the fixed point is the same. Where
    /// no point changed what it does, the numerical stiffness doubles, and where it may grow beyond the usual
    /// bound grows fourfold there: nothing chatters, and a stiffer one gets there sooner.
    pub fn keep_tractions(&mut self) {
        if let Some(awake) = &self.awake {
            // An iterate of these alone: what all points do is told by those of the whole.
            for (p, history) in self.interface.iter().enumerate() {
                if awake.facets[p / 4] {
                    self.traction[p] = history.traction;
                    self.bounding[p] = history.traction[0];
                }
            }
            return;
        }
        self.loose.keep();
        for (p, history) in self.interface.iter().enumerate() {
            self.traction[p] = history.traction;
            let change = history.traction[0] - self.bounding[p];
            let part = if change * self.swing[p] < 0.0 {
                0.5
            } else {
                1.0
            };
            self.bounding[p] += part * change;
            self.swing[p] = change;
        }
        let mut steady = self.before == self.status;
        for one in &mut self.touches {
            steady &= one.keep_traction();
        }
        let grows = if self.stiffening < STIFFEST {
            2.0
        } else {
            QUICKER
        };
        self.stiffening = if steady {
            (grows * self.stiffening).min(self.stiffest)
        } else {
            1.0
        };
        self.before.clone_from(&self.status);
    }
}
