//! Points of solids and joints in one increment.

use wythe_contact::{InterfaceHistory, PointPair, PointStatus};

use crate::assembly::bulk::Marks;
use crate::assembly::general::Live;
use crate::material::{MaterialHistory, PointEnergy};

/// Gauss points of the elements.
#[derive(Clone, Debug, Default)]
pub struct TrialSolids {
    /// New histories. `[element][gauss point]`
    pub history: Vec<MaterialHistory>,
    /// Energies, integrated over each element [N mm]. `[element]`
    pub energy: Vec<PointEnergy>,
    /// Points with a history in each element. Empty: not determined yet. `[element]`
    pub(in crate::assembly) marks: Vec<Marks>,
}

/// Contact points of the joints.
#[derive(Clone, Debug, Default)]
pub struct TrialJoints {
    /// New histories. `[point]`
    pub history: Vec<InterfaceHistory>,
    /// Elastic energy and dissipation [N mm]. `[point]`
    pub energy: Vec<[f64; 2]>,
    /// Status. `[point]`
    pub status: Vec<PointStatus>,
    /// Present master facet and the foot of the perpendicular on it. `[point]`
    pub pairs: Vec<PointPair>,
    /// Position from which the slip of this increment is measured: the pair at the last commit, or the position
    /// at which a point came into contact. `[point]`
    pub anchors: Vec<PointPair>,
    /// Whether a point had no master facet at the last commit. `[point]`
    pub free: Vec<bool>,
    /// Normal gaps at the last evaluation of forces [mm]. `[point]`
    pub(in crate::assembly) gaps: Vec<f64>,
    /// Positions at that evaluation [mm]. Empty where points were paired anew since. `[node]`
    pub(in crate::assembly) seen_at: Vec<[f64; 3]>,
}

impl TrialJoints {
    /// Begins an increment from the committed histories and pairs.
    pub(super) fn start(&mut self, history: &Vec<InterfaceHistory>, pairs: &Vec<PointPair>) {
        self.history.clone_from(history);
        self.pairs.clone_from(pairs);
        self.anchors.clone_from(pairs);
        self.free.clear();
        self.free
            .extend(pairs.iter().map(|pair| pair.facet.is_none()));
        // A resumed run does not have these positions.
        self.seen_at.clear();
        // An evaluation that fails ends early. Its missing entries must be empty, not those of an earlier increment.
        self.energy.clear();
    }

    /// Makes room for the gaps of `points`, and forgets where they were evaluated unless that was at the present
    /// positions.
    pub(in crate::assembly) fn forget_unless(&mut self, seen: bool, points: usize) {
        if !seen {
            self.seen_at.clear();
        }
        self.gaps.resize(points, 0.0);
    }
}

/// Touches of general contact.
#[derive(Clone, Debug, Default)]
pub struct TrialTouches {
    /// Touches, and pairs close to touching.
    pub touches: Vec<Live>,
    /// Energy released by touches that ended, and the work of their last forces in the increment [N mm].
    pub loss: [f64; 2],
}
