//! Convergence criteria of an iterate (docs/theory/equilibrium.md, eqs 14 to 18).

use super::body_balance::Bodies;
use super::external_forces::Loads;
use super::newton::Newton;
use crate::assembly::{System, Trial};
use crate::model::scene::Step;
use crate::state::State;

/// Largest root mean square of the out-of-balance forces over the mean nodal force. It bounds their sum, however
/// loose the tolerance of a single force is. The increment size of extrapolated solids is chosen to stay below it
/// too.
pub const IMBALANCE: f64 = 2e-3;

/// Largest work of the out-of-balance forces along an increment over the work turned over. Where a crack runs, few
/// nodes at its tip carry all the dissipation. A force that is small beside the mean nodal force can hold the crack
/// back there.
pub const WORK: f64 = 1.5e-3;

/// Factor on the tolerance below which forces are in balance whatever work they do: parted bodies move far and turn
/// over no work.
pub(in crate::solve) const NEGLIGIBLE: f64 = 1e-2;

/// Least scale of the tolerance, as a part of the largest mean nodal force so far. When a joint has parted all forces
/// vanish; without this bound the tolerance would vanish with them.
const LEAST_SCALE: f64 = 0.01;

/// Forces below this many roundings count as zero. Without it a scene without load has no scale for its residual.
pub(in crate::solve) const ROUNDINGS: f64 = 1e3;

/// Scales of the out-of-balance forces of a step.
pub(in crate::solve) struct Scales {
    /// Smallest force by which they are scaled [N], see [`least_scale`].
    pub(in crate::solve) least: f64,
    /// Bodies, each of which balances by itself.
    pub(in crate::solve) bodies: Bodies,
    /// Number of further increments whose tolerance of a single force is loosened.
    pub(in crate::solve) loosened: u32,
}

/// Factor of the tolerance of a single force where the run would end otherwise.
pub(in crate::solve) const LOOSENED: f64 = 4.0;

/// Number of increments that are solved so: a run that ends at one would soon end at the next.
pub(in crate::solve) const LOOSENED_FOR: u32 = 20;

/// Measures of the out-of-balance forces.
#[derive(Clone, Copy, Debug)]
pub(in crate::solve) struct Balance {
    /// Largest out-of-balance force over the mean nodal force.
    pub(in crate::solve) largest: f64,
    /// Equation of the largest force.
    pub(in crate::solve) worst: usize,
    /// Root mean square of the forces over the mean nodal force.
    pub(in crate::solve) root_mean_square: f64,
}

impl Balance {
    /// Measures a residual [N] by the mean nodal force `scale` [N]. Not finite if any entry is not.
    pub(in crate::solve) fn new(residual: &[f64], scale: f64) -> Self {
        let (largest, worst) = largest(residual);
        Self {
            largest: largest / scale,
            worst,
            root_mean_square: root_mean_square(residual) / scale,
        }
    }

    /// Whether the forces are below `part` of their tolerances.
    pub(in crate::solve) fn holds(&self, part: f64, tolerance: f64) -> bool {
        self.largest <= part * tolerance && self.root_mean_square <= part * IMBALANCE
    }
}

impl Newton<'_> {
    /// Scale of residuals [N] (docs/theory/equilibrium.md, eqs 14 and 15): the mean nodal force, or that of loads or
    /// inertia if larger, with lower bounds for scenes under little or no load.
    pub(in crate::solve) fn scale(&self, system: &System, state: &State, trial: &Trial) -> f64 {
        let moving = self.motion.as_ref();
        trial
            .mean_nodal_force
            .max(LEAST_SCALE * state.largest_mean_force)
            .max(self.loading.loads.mean)
            .max(moving.map_or(0.0, |m| m.mean_force(&system.mass)))
            .max(self.scales.least)
            .max(f64::MIN_POSITIVE)
    }

    /// Work of the out-of-balance forces along the increment, and the work turned over [N mm]. `way`: displacements
    /// of the increment [mm] `[slot]`
    pub(in crate::solve) fn works(
        &self,
        system: &System,
        state: &State,
        trial: &Trial,
        way: &[f64],
    ) -> [f64; 2] {
        let slots = self.equations.slot_of.iter().map(|&slot| slot as usize);
        let lost = slots
            .zip(&self.vectors.residual)
            .map(|(slot, r)| r * way[slot]);
        let loads = self
            .loading
            .loads
            .total
            .iter()
            .zip(way)
            .map(|(f, u)| (f * u).abs());
        // A body in free flight turns over its kinetic energy alone.
        let moving = state.energies.kinetic + loads.sum::<f64>();
        [lost.sum(), system.work_turned_over(trial, way) + moving]
    }
}

/// Lower bound of the scale of residuals [N]: a number of roundings. In steps that load it is at most the nodal mean
/// of their loads, because roundings of stiff elements may exceed small loads, which would then count as zero.
pub(in crate::solve) fn least_scale(step: &Step, system: &System, loads: &Loads) -> f64 {
    let roundings = ROUNDINGS * system.rounding_force;
    let mut full = loads.clone();
    full.at(step, system, 1.0, 1.0);
    let sum: f64 = full.total.iter().map(|force| force.abs()).sum();
    let mean = sum / system.bulk.reference.len() as f64;
    if mean > 0.0 {
        roundings.min(mean)
    } else {
        roundings
    }
}

/// Root mean square.
pub(in crate::solve) fn root_mean_square(values: &[f64]) -> f64 {
    let square: f64 = values.iter().map(|v| v * v).sum();
    (square / values.len().max(1) as f64).sqrt()
}

/// Largest magnitude and its index; not finite if any entry is not.
pub(in crate::solve) fn largest(values: &[f64]) -> (f64, usize) {
    let mut worst = (0.0, 0);
    for (i, v) in values.iter().enumerate() {
        if !v.is_finite() {
            return (f64::NAN, i);
        }
        if v.abs() > worst.0 {
            worst = (v.abs(), i);
        }
    }
    worst
}
