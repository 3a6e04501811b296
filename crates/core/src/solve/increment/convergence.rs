//! Convergence criteria of an iterate (docs/theory/equilibrium.md, eqs 14 to 18).

use super::body_balance::{Bodies, LEAST, RESULTANT};
use super::external_forces::Loads;
use super::newton::Newton;
use super::outcome::{Problem, Rejection};
use crate::assembly::{System, Trial};
use crate::model::scene::{Procedure, Step};
use crate::solve::stepping::path::Advance;
use crate::solve::stepping::relaxation::AT_REST;
use crate::state::{Method, State};

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

/// Factor on the tolerances for a start that is accepted without a solve.
const START: f64 = 0.1;

/// Iterations after which `auto` gives up an increment if the root mean square of the out-of-balance forces still
/// exceeds `FAR_OFF` times its bound. A smaller increment or a relaxation is cheaper.
const PATIENCE: usize = 12;
const FAR_OFF: f64 = 10.0;

/// Largest out-of-balance force over that of the dashpots in a state that a relaxation passes through. With a half
/// instead, a random wall stood beyond the snap of its unit.
const FOLLOWED: f64 = 0.2;

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

    /// Whether the out-of-balance forces are below the tolerance, and their work along the increment over the work
    /// turned over; 0 where it was not needed.
    pub(super) fn is_balanced(
        &self,
        at: &Problem<'_>,
        balance: &Balance,
        scale: f64,
    ) -> (bool, f64) {
        // Without a solve the bounds are stricter: residuals of such starts would add up over the increments.
        let part = if at.solves.count == 0 { START } else { 1.0 };
        let loosened = if self.scales.loosened > 0 {
            LOOSENED
        } else {
            1.0
        };
        let most = loosened * self.step.tolerance.residual;
        if at.solves.count > 0 && self.passes_through(balance, scale) {
            return (self.bodies_balance(at, part, scale), 0.0);
        }
        let balanced = balance.holds(part, most);
        // Along a path the advance is prescribed, so no state lags behind a load. Nor does one without loads.
        let loaded = scale > self.scales.least;
        if !(balanced && loaded && at.attempt.advance == Advance::Load) {
            return (balanced, 0.0);
        }
        let way: Vec<f64> = (self.q.iter().zip(&at.state.q))
            .map(|(q, s)| q - s)
            .collect();
        let [lost, turned] = self.works(at.system, at.state, at.trial, &way);
        let work = lost.abs() / turned.max(f64::MIN_POSITIVE);
        let holds = work <= part * WORK || balance.holds(part * NEGLIGIBLE, most);
        (holds && self.bodies_balance(at, part, scale), work)
    }

    /// Whether the state is one that a relaxation passes through, and its motion is followed: dashpots still carry more
    /// than a structure at rest, and much more than is out of balance. The end of a relaxation is not one.
    fn passes_through(&self, balance: &Balance, scale: f64) -> bool {
        if (self.dashpots.as_ref()).is_none_or(|d| d.factor == 0.0 || !d.passes) {
            return false;
        }
        let drag = Balance::new(&self.dashpot_forces(), scale);
        let tolerance = self.step.tolerance.residual;
        !drag.holds(AT_REST, tolerance)
            && balance.largest <= tolerance.max(FOLLOWED * drag.largest)
            && balance.root_mean_square <= IMBALANCE.max(FOLLOWED * drag.root_mean_square)
    }

    /// Whether the out-of-balance forces of each body are below `part` of their tolerance.
    fn bodies_balance(&self, at: &Problem<'_>, part: f64, scale: f64) -> bool {
        // Without load all forces are roundings.
        let least = (LEAST * scale).max(self.scales.least);
        let residual = (&self.vectors.residual[..], &self.equations.slot_of[..]);
        let loads = &self.loading.loads.total;
        let motion = self.motion.as_ref();
        // Bodies that fly may have no forces but those of their inertia.
        let motion = motion.filter(|_| self.choice.method == Method::Dynamic);
        let acting = loads.iter().enumerate().map(|(slot, load)| {
            let inertia = motion.map_or(0.0, |motion| motion.size(&at.system.mass, slot));
            load.abs() + inertia
        });
        let worst = (self.scales.bodies).worst((at.system, at.trial), residual, acting, least);
        worst <= part * RESULTANT
    }

    /// Counts an increment that was solved with a loosened tolerance; false if it was not.
    pub(in crate::solve) fn tighten(&mut self) -> bool {
        let loosened = self.scales.loosened > 0;
        self.scales.loosened = self.scales.loosened.saturating_sub(1);
        loosened
    }

    /// Whether `auto` gives up the increment before the most iterations.
    pub(super) fn is_hopeless(&self, iteration: usize, balance: &Balance) -> bool {
        self.step.procedure == Procedure::Auto
            && self.motion.is_none()
            && iteration >= PATIENCE
            && balance.root_mean_square > FAR_OFF * IMBALANCE
    }

    pub(super) fn not_converged(&self, system: &System, balance: &Balance, work: f64) -> Rejection {
        let slot = self.equations.slot_of[balance.worst] as usize;
        Rejection::Iterations {
            residual: balance.largest,
            root_mean_square: balance.root_mean_square,
            work,
            node: system.dofs.node_of(slot).0,
        }
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
