//! Working data of one increment, and the tractions carried over from iterate to iterate.

use super::branch_holding::HeldBranches;
use super::bulk::Marks;
use super::general::Live;
use super::stiffness_reuse::Held;
use crate::material::{MaterialHistory, PointEnergy};
use crate::state::State;
use wythe_contact::{InterfaceHistory, PointPair, PointStatus};

/// Largest factor on the numerical stiffness [-].
pub(super) const STIFFEST: f64 = 8.0;
/// Largest factor under named loads, which may be small beside the weight [-]. The numerical stiffness may then
/// reach that of the law.
pub const STIFFEST_UNDER_LOADS: f64 = 512.0;
/// Growth of the factor from [`STIFFEST`] upwards [-]. Below, it doubles.
const QUICKER: f64 = 4.0;

/// Working data of one increment. It may be dropped at any time without a change of results.
#[derive(Clone, Debug, Default)]
pub struct Trial {
    /// Current positions [mm]. `[node]`
    pub x: Vec<[f64; 3]>,
    pub(super) displacement: Vec<[f64; 3]>,
    /// Nodal forces of each cell [N]: elements, then contact pairs. `[cell][node][xyz]`
    pub cell_force: Vec<[[f64; 3]; 8]>,
    /// Stiffness of each cell [N/mm]. `[cell][CELL]`
    pub(super) cells: Vec<f64>,
    /// Positions at which the stiffness in `cells` was written.
    pub(super) held: Held,
    /// Whether a cell contributes stiffness now. `[cell]`
    pub(super) active: Vec<bool>,
    /// Cells that changed since a matrix was last filled: their stiffness was written, or they began or ceased
    /// to contribute. `[cell]`
    pub(super) changed: Vec<bool>,
    /// Number of that filling.
    pub(super) filling: u64,
    /// Internal forces of all nodes, supported ones included [N]. `[node][xyz]`
    pub node_force: Vec<[f64; 3]>,
    /// Generalised internal forces [N]. `[slot]`
    pub force: Vec<f64>,
    /// New histories of the solids. `[element][gauss point]`
    pub material: Vec<MaterialHistory>,
    /// Energies of the solids, integrated over each element [N mm]. `[element]`
    pub element_energy: Vec<PointEnergy>,
    /// Points with a history in each element. Empty: not determined yet. `[element]`
    pub(super) marks: Vec<Marks>,
    /// New histories of the joints. `[point]`
    pub interface: Vec<InterfaceHistory>,
    /// Elastic energy and dissipation of each point [N mm]. `[point]`
    pub point_energy: Vec<[f64; 2]>,
    /// Status of each point. `[point]`
    pub status: Vec<PointStatus>,
    /// Present master facet of each point and the foot of the perpendicular on it. `[point]`
    pub pairs: Vec<PointPair>,
    /// Position from which the slip of this increment is measured: the pair at the last commit, or the position
    /// at which a point came into contact. `[point]`
    pub anchors: Vec<PointPair>,
    /// Whether a point had no master facet at the last commit. `[point]`
    pub free: Vec<bool>,
    /// Positions at the last commit [mm]. Empty when the run begins. `[node]`
    pub x_start: Vec<[f64; 3]>,
    /// Tractions of the last iterate (shifted penalty) [MPa]. `[point]`
    pub traction: Vec<[f64; 3]>,
    /// Normal traction that bounds the shear of the next iterate (shifted penalty) [MPa]. `[point]`
    pub bounding: Vec<f64>,
    /// Last change of `bounding` [MPa]. A next change of the opposite sign is an oscillation. `[point]`
    swing: Vec<f64>,
    /// Factor of the numerical stiffness of all points (shifted penalty) [-].
    pub stiffening: f64,
    /// Largest value of that factor in this increment [-].
    pub stiffest: f64,
    /// Whether points at their shear limit keep their stiffness along the slip. It is set where a load
    /// reverses, because sliding points stick then.
    pub sticks: bool,
    /// Positions of the driven ends of the springs [mm]. `[spring][xyz]`
    pub spring_ends: Vec<[f64; 3]>,
    /// Values of the named loads. `[load]`
    pub loads: Vec<[f64; 3]>,
    /// Least numerical stiffness of the points over the mass behind them [1/s²]; 0 without inertia.
    pub inertia: f64,
    /// Touches of general contact, and pairs close to touching.
    pub touches: Vec<Live>,
    /// Energy released by touches that ended, and the work of their last forces in the increment [N mm].
    pub touch_loss: [f64; 2],
    /// Normal gaps at the last evaluation of forces [mm]. `[point]`
    pub(super) gaps: Vec<f64>,
    /// Positions at that evaluation [mm]. Empty where points were paired anew since. `[node]`
    pub(super) seen_at: Vec<[f64; 3]>,
    /// Points on branches without stiffness (shifted penalty), and those that are given a secant there.
    pub loose: HeldBranches,
    /// Status of each point in the last iterate. `[point]`
    before: Vec<PointStatus>,
    /// Mean magnitude of the elements' nodal forces [N].
    pub mean_nodal_force: f64,
    /// Cells that are evaluated. None: all cells.
    pub awake: Option<Awake>,
}

/// Cells near moving nodes. Forces and stiffness of all others are those of the last evaluation.
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
        // A resumed run does not have these positions.
        self.seen_at.clear();
        // An evaluation that fails ends early. Its missing entries must be empty, not those of an earlier
        // increment.
        self.cell_force.clear();
        self.element_energy.clear();
        self.point_energy.clear();
        self.touches.clear();
        self.touch_loss = [0.0; 2];
        self.awake = None;
    }

    /// Copy to which the trial can be restored, without the cells' stiffness, which takes most of its memory.
    #[must_use]
    pub fn without_stiffness(&mut self) -> Self {
        let cells = std::mem::take(&mut self.cells);
        let copy = self.clone();
        self.cells = cells;
        copy
    }

    /// Restores a copy made without stiffness. The cells keep their present stiffness, so that the next
    /// evaluation with tangents can reuse it.
    pub fn go_back(&mut self, copy: Self) {
        let now = std::mem::replace(self, copy);
        self.cells = now.cells;
        self.held = now.held;
        self.active = now.active;
        self.changed = now.changed;
        self.filling = now.filling;
    }

    /// Whether the increment has named loads: the numerical stiffness may grow to that of the law.
    pub(super) fn is_under_loads(&self) -> bool {
        self.stiffest > STIFFEST
    }

    /// Whether the tractions of the last iterate belong to the touches of this one.
    pub fn is_settled(&self) -> bool {
        self.touches.iter().all(|one| one.settled)
    }

    /// Whether a pair of general contact is near but open.
    pub fn may_meet(&self) -> bool {
        self.touches.iter().any(Live::is_open)
    }

    /// Takes the normal tractions of the last iterate as bounds of the shear of the next one.
    pub(super) fn bound_by_traction(&mut self) {
        self.bounding.clear();
        self.bounding.extend(self.traction.iter().map(|t| t[0]));
        self.swing.clear();
        self.swing.resize(self.traction.len(), 0.0);
        self.touches.iter_mut().for_each(Live::bound_by_traction);
    }

    /// Takes over the tractions of this iterate, and `others` at the given points.
    pub fn take_tractions(&mut self, others: Vec<(usize, [f64; 3])>) {
        self.keep_tractions();
        for (point, traction) in others {
            self.traction[point] = traction;
        }
        self.bound_by_traction();
    }

    /// Takes over the tractions of this iterate as those of the last one. Where pressure and friction
    /// oscillate, the bound changes by half only; the fixed point is the same. Where no point changed its
    /// status, the numerical stiffness doubles, and beyond the usual bound it grows fourfold: nothing
    /// oscillates, and a stiffer penalty converges faster.
    pub fn keep_tractions(&mut self) {
        if let Some(awake) = &self.awake {
            // Only part of the cells was evaluated. Status changes are counted in iterates of all cells only.
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
