//! The energy that an increment in balance still leaves open.
//!
//! Work and dissipation go by the trapezoidal rule. With internal forces p and out-of-balance forces r
//! the energies that solids and interfaces have taken exceed the work done on them by
//!
//! ```text
//! w = ΔE + D − ½ (p₀ + p₁)·Δq + ½ (r₀ + r₁)·Δq
//! ```
//!
//! The last term is what the tolerance of forces leaves. The others vanish where interfaces have taken
//! over the tractions of their gaps; the shifted penalty stops when the nodes feel no difference, and
//! patterns of tractions that they do not feel swing on from increment to increment, sliding forth and
//! back at the Coulomb bound: dissipation of which no force did the work
//! (docs/decisions/energy-balance.md).

use super::newton::Newton;
use crate::assembly::{System, Trial};
use crate::state::Method;
use crate::state::{Energies, State};

/// Part of the energy taken so far that is much to be left open: a quarter of what an energy balance is
/// asked to close to.
const LEAK: f64 = 2.5e-3;
/// Twice that: beyond it an increment in balance must not add to what is open.
const LEAKING: f64 = 5e-3;
/// How often such an increment takes over its tractions again, without a solve, to close its energy.
const PURSUIT: usize = 12;
/// The same where a displacement steers the load, and each of these wants a solve to find balance again.
const PURSUIT_STEERED: usize = 2;
/// Part of the last change of tractions that the next increment starts with, where too much is left open:
/// patterns that no node feels die out.
const DAMPED: f64 = 0.5;

/// What an increment takes [N mm].
#[derive(Default)]
pub(in crate::solve) struct Taken {
    /// What it leaves open, w.
    pub(in crate::solve) leak: f64,
    /// ΔE + D.
    pub(in crate::solve) net: f64,
    /// |ΔE| + |D|.
    gross: f64,
}

/// How often an increment in balance is asked to close its energy, too.
pub(in crate::solve) fn pursuit(method: Method) -> usize {
    if method == Method::DisplacementControl {
        PURSUIT_STEERED
    } else {
        PURSUIT
    }
}

impl Newton<'_> {
    /// The energies of the increment that `trial` ends; none where extrapolated solids leave other errors.
    pub(in crate::solve) fn taken(&self, system: &System, state: &State, trial: &Trial) -> Taken {
        if self.method() == Method::Implex {
            return Taken::default();
        }
        if self.method().has_inertia() {
            return self.taken_in_motion(system, state, trial);
        }
        let springs = system.spring_forces(trial);
        let stored = system.elastic_energy(trial, &springs) - state.energies.elastic;
        let solids = trial.element_energy.iter();
        let dissipated = solids.map(|e| e.plastic_damage + e.viscous).sum::<f64>()
            + system.interface_dissipation(trial);
        let mut work = -system.crossing_work(self.model, state, trial);
        for (slot, (q, start)) in self.q.iter().zip(&state.q).enumerate() {
            work += 0.5 * (state.force[slot] + trial.force[slot]) * (q - start);
        }
        for (s, force) in springs.iter().enumerate() {
            for i in 0..3 {
                let way = trial.spring_ends[s][i] - state.spring_ends[s][i];
                work += 0.5 * (state.spring_forces[s][i] + force[i]) * way;
            }
        }
        let forces = self.residual.iter().zip(&self.left);
        for ((r, left), &slot) in forces.zip(&self.equations.slot_of) {
            let slot = slot as usize;
            work -= 0.5 * (r + left) * (self.q[slot] - state.q[slot]);
        }
        Taken {
            leak: stored + dissipated - work,
            net: stored + dissipated,
            gross: stored.abs() + dissipated.abs(),
        }
    }

    /// The same with inertia, whose work and scheme the account knows.
    fn taken_in_motion(&self, system: &System, state: &State, trial: &Trial) -> Taken {
        let dq: Vec<f64> = self.q.iter().zip(&state.q).map(|(q, s)| q - s).collect();
        let energies = self.account(system, state, trial, &dq).energies;
        let stored = energies.elastic - state.energies.elastic;
        let net = energies.taken() - state.energies.taken();
        Taken {
            leak: state.energies.open() - energies.open(),
            net,
            gross: stored.abs() + (net - stored).abs(),
        }
    }

    /// Whether the energies close well enough with the increment that `trial` ends.
    pub(in crate::solve) fn closes(&self, system: &System, state: &State, trial: &Trial) -> bool {
        let taken = self.taken(system, state, trial);
        let before = &state.energies;
        let after = (before.leaked + taken.leak).abs();
        after <= LEAKING * (before.taken() + taken.net)
            || after <= before.leaked.abs()
            || taken.leak.abs() <= LEAKING * taken.gross
    }

    /// Part of the last change of tractions that the next increment starts with.
    pub(in crate::solve) fn momentum(&self, before: &Energies) -> f64 {
        let open = before.leaked.abs() > LEAK * before.taken();
        if open && !self.method().has_inertia() {
            DAMPED
        } else {
            1.0
        }
    }

    /// Notes what the increment that `trial` ends leaves, before it becomes the state.
    pub(in crate::solve) fn note_leak(
        &mut self,
        system: &System,
        state: &mut State,
        trial: &Trial,
    ) {
        state.energies.leaked += self.taken(system, state, trial).leak;
        self.left.copy_from_slice(&self.residual);
    }
}
