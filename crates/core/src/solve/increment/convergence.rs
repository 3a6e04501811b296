//! Whether an iterate is equilibrium.

use super::external_forces::Loads;
use super::newton::Newton;
use crate::assembly::{System, Trial};
use crate::model::scene::Step;
use crate::state::State;

/// Largest root mean square of the out-of-balance forces, over the mean nodal force: a bound on what
/// they may add up to, however loose the tolerance of a single one. The extrapolation of solids is
/// steered to leave no more.
pub const IMBALANCE: f64 = 2e-3;

/// Largest work that these forces may do along an increment, over the work that it turns over. Where a
/// crack runs, a few nodes at its tip carry all of what dissipates; a force that is small beside the
/// mean nodal force holds the crack back there.
pub const WORK: f64 = 1.5e-3;

/// Part of the tolerance below which forces are in balance whatever work they do: what has parted goes
/// far and turns over nothing.
pub(in crate::solve) const NEGLIGIBLE: f64 = 1e-2;

/// Part of the largest mean nodal force so far that the tolerance refers to at least: when a joint
/// has parted all forces vanish, and a tolerance that vanishes with them asks for less than nothing.
const LEAST_SCALE: f64 = 0.01;

/// Nodal forces of fewer roundings than this are none: without it a scene under no load has nothing to
/// measure its residual in.
pub(in crate::solve) const ROUNDINGS: f64 = 1e3;

/// What is out of balance.
#[derive(Clone, Copy, Debug)]
pub(in crate::solve) struct Balance {
    /// Largest out-of-balance force over the mean nodal force.
    pub(in crate::solve) largest: f64,
    /// Its equation.
    pub(in crate::solve) worst: usize,
    /// Root mean square of these forces, over the same.
    pub(in crate::solve) root_mean_square: f64,
}

impl Balance {
    /// That of a residual [N] beside the mean nodal force `scale` [N]. Not finite if any entry is not.
    pub(in crate::solve) fn new(residual: &[f64], scale: f64) -> Self {
        let (largest, worst) = largest(residual);
        Self {
            largest: largest / scale,
            worst,
            root_mean_square: root_mean_square(residual) / scale,
        }
    }

    /// Whether the forces are below `part` of the tolerance.
    pub(in crate::solve) fn holds(&self, part: f64, tolerance: f64) -> bool {
        self.largest <= part * tolerance && self.root_mean_square <= part * IMBALANCE
    }
}

impl Newton<'_> {
    /// Force that residuals are measured in: the mean nodal force (theory F), or that of loads and
    /// inertia where it is larger, or what rounding leaves where nothing is loaded [N].
    pub(in crate::solve) fn scale(&self, system: &System, state: &State, trial: &Trial) -> f64 {
        let moving = self.motion.as_ref();
        trial
            .mean_nodal_force
            .max(LEAST_SCALE * state.largest_mean_force)
            .max(self.loads.mean)
            .max(moving.map_or(0.0, |m| m.mean_force(&system.mass)))
            .max(self.least_scale)
            .max(f64::MIN_POSITIVE)
    }

    /// Work that the out-of-balance forces do along the increment, and the work that it turns over
    /// [N mm]. `way`: displacements of the increment [mm] `[slot]`
    pub(in crate::solve) fn works(
        &self,
        system: &System,
        state: &State,
        trial: &Trial,
        way: &[f64],
    ) -> [f64; 2] {
        let slots = self.equations.slot_of.iter().map(|&slot| slot as usize);
        let lost = slots.zip(&self.residual).map(|(slot, r)| r * way[slot]);
        let loads = self.loads.total.iter().zip(way).map(|(f, u)| (f * u).abs());
        // What flies freely turns over its kinetic energy alone.
        let moving = state.energies.kinetic + loads.sum::<f64>();
        [lost.sum(), system.work_turned_over(trial, way) + moving]
    }
}

/// Some roundings; in a step that loads no more than the mean of its loads over the nodes, which a tolerance measured in the
/// roundings of stiff elements would take for none [N].
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

/// Largest magnitude and its place; not finite if any entry is not.
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
