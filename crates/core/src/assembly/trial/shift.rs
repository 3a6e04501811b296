//! The shifted penalty: tractions carried over from iterate to iterate (docs/theory/shifted-penalty.md).

use wythe_contact::{InterfaceHistory, PointStatus};

use super::Awake;
use crate::assembly::branch_holding::HeldBranches;

/// Largest factor on the numerical stiffness [-].
pub(in crate::assembly) const STIFFEST: f64 = 8.0;
/// Largest factor under named loads, which may be small beside the weight [-]. The numerical stiffness may then
/// reach that of the law.
pub const STIFFEST_UNDER_LOADS: f64 = 512.0;
/// Growth of the factor from [`STIFFEST`] upwards [-]. Below, it doubles.
const QUICKER: f64 = 4.0;

/// Tractions and numerical stiffness of the shifted penalty.
#[derive(Clone, Debug, Default)]
pub struct TrialShift {
    /// Tractions of the last iterate [MPa]. `[point]`
    pub traction: Vec<[f64; 3]>,
    /// Normal traction that bounds the shear of the next iterate [MPa]. `[point]`
    pub bounding: Vec<f64>,
    /// Last change of `bounding` [MPa]. A next change of the opposite sign is an oscillation. `[point]`
    swing: Vec<f64>,
    /// Factor of the numerical stiffness of all points [-].
    pub stiffening: f64,
    /// Largest value of that factor in this increment [-].
    pub stiffest: f64,
    /// Whether points at their shear limit keep their stiffness along the slip. It is set where a load
    /// reverses, because sliding points stick then.
    pub sticks: bool,
    /// Points on branches without stiffness, and those that are given a secant there.
    pub branches: HeldBranches,
    /// Status of each point in the last iterate. `[point]`
    status_before: Vec<PointStatus>,
}

impl TrialShift {
    /// Begins an increment from the tractions of the last commit.
    pub(super) fn start(&mut self, committed: &[InterfaceHistory]) {
        self.traction.clear();
        self.traction.extend(committed.iter().map(|h| h.traction));
        self.bound_by_traction();
        self.stiffening = 1.0;
        self.stiffest = STIFFEST;
        self.status_before.clear();
        self.branches.start();
    }

    /// Takes the normal tractions of the last iterate as bounds of the shear of the next one.
    pub(super) fn bound_by_traction(&mut self) {
        self.bounding.clear();
        self.bounding.extend(self.traction.iter().map(|t| t[0]));
        self.swing.clear();
        self.swing.resize(self.traction.len(), 0.0);
    }

    /// Takes over the tractions of an iterate in which only the cells near moving nodes were evaluated.
    pub(super) fn keep_awake(&mut self, iterate: &[InterfaceHistory], awake: &Awake) {
        for (p, history) in iterate.iter().enumerate() {
            if awake.facets[p / 4] {
                self.traction[p] = history.traction;
                self.bounding[p] = history.traction[0];
            }
        }
    }

    /// Takes over the tractions of this iterate as those of the last one. Where pressure and friction
    /// oscillate, the bound changes by half only; the fixed point is the same.
    pub(super) fn keep(&mut self, iterate: &[InterfaceHistory]) {
        self.branches.keep();
        for (p, history) in iterate.iter().enumerate() {
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
    }

    /// Whether no point has changed its status since the last iterate. `status` is remembered.
    pub(super) fn is_steady(&mut self, status: &[PointStatus]) -> bool {
        let steady = self.status_before == status;
        status.clone_into(&mut self.status_before);
        steady
    }

    /// Doubles the numerical stiffness where no point changed its status, and beyond the usual bound quadruples it:
    /// nothing oscillates, and a stiffer penalty converges faster. Otherwise starts again from 1.
    pub(super) fn stiffen(&mut self, steady: bool) {
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
    }
}
