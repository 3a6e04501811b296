//! Energy that an increment in balance leaves open (docs/theory/energies.md, eqs 14 to 16).
//!
//! Work and dissipation follow the trapezoidal rule. With internal forces p and out-of-balance forces r, the energy
//! taken by solids and interfaces exceeds the work done on them by
//!
//! ```text
//! w = ΔE + D − ½ (p₀ + p₁)·Δq + ½ (r₀ + r₁)·Δq
//! ```
//!
//! The last term is due to the force tolerance. The others vanish once interfaces carry the tractions of their
//! gaps. The shifted penalty stops when nodal forces no longer change. Traction patterns without nodal forces may
//! then oscillate from increment to increment, with slip forth and back at the Coulomb bound. This dissipates energy
//! without work of any force (see the decisions there).

use super::newton::Newton;
use crate::assembly::{System, Trial};
use crate::state::Method;
use crate::state::{Energies, State};

/// Open energy, as a part of the energy taken so far, from which the tractions are damped: a quarter of the 1 % to
/// which the energy balance must close.
const LEAK: f64 = 2.5e-3;
/// Twice that. Beyond it an increment in balance must not add to the open energy.
const LEAKING: f64 = 5e-3;
/// How often an increment takes over its tractions again, without a solve, to close its energy.
const TRACTION_UPDATES: usize = 12;
/// The same where a displacement steers the load: here each repetition needs a solve to find balance again.
const TRACTION_UPDATES_STEERED: usize = 2;
/// Part of the last traction change with which the next increment starts where too much energy is open. Patterns
/// without nodal forces then decay.
const DAMPED: f64 = 0.5;

/// Energies of an increment [N mm].
#[derive(Default)]
pub(in crate::solve) struct Taken {
    /// w, the energy left open.
    pub(in crate::solve) open: f64,
    /// ΔE + D.
    pub(in crate::solve) net: f64,
    /// |ΔE| + |D|.
    gross: f64,
}

/// Number of attempts to close the energy of an increment in balance.
pub(in crate::solve) fn traction_updates(method: Method) -> usize {
    if method == Method::DisplacementControl {
        TRACTION_UPDATES_STEERED
    } else {
        TRACTION_UPDATES
    }
}

impl Newton<'_> {
    /// Energies of the increment that ends at `trial`; zero for extrapolated solids, whose errors are measured
    /// otherwise.
    pub(in crate::solve) fn taken(&self, system: &System, state: &State, trial: &Trial) -> Taken {
        if self.method() == Method::Implex {
            return Taken::default();
        }
        if self.method().has_inertia() {
            return self.taken_in_motion(system, state, trial);
        }
        let springs = system.spring_forces(trial);
        let stored = system.elastic_energy(trial, &springs) - state.energies.elastic;
        let solids = trial.solids.energy.iter();
        let dissipated = solids.map(|e| e.plastic_damage + e.viscous).sum::<f64>()
            + trial.ties.sum(|tie| tie.dissipated)
            + system.interface_dissipation(trial);
        let mut work =
            trial.ties.sum(|tie| tie.jacked) - system.crossing_work(self.model, state, trial);
        for (slot, (q, start)) in self.q.iter().zip(&state.q).enumerate() {
            work += 0.5 * (state.force[slot] + trial.force[slot]) * (q - start);
        }
        for (s, force) in springs.iter().enumerate() {
            for i in 0..3 {
                let way = trial.spring_ends[s][i] - state.spring_ends[s][i];
                work += 0.5 * (state.spring_forces[s][i] + force[i]) * way;
            }
        }
        let forces = self.vectors.residual.iter().zip(&self.vectors.left);
        for ((r, left), &slot) in forces.zip(&self.equations.slot_of) {
            let slot = slot as usize;
            work -= 0.5 * (r + left) * (self.q[slot] - state.q[slot]);
        }
        Taken {
            open: stored + dissipated - work,
            net: stored + dissipated,
            gross: stored.abs() + dissipated.abs(),
        }
    }

    /// The same with inertia, whose work and scheme are part of the account.
    fn taken_in_motion(&self, system: &System, state: &State, trial: &Trial) -> Taken {
        let dq: Vec<f64> = self.q.iter().zip(&state.q).map(|(q, s)| q - s).collect();
        let energies = self.account(system, state, trial, &dq).energies;
        let stored = energies.elastic - state.energies.elastic;
        let net = energies.taken() - state.energies.taken();
        Taken {
            open: state.energies.open() - energies.open(),
            net,
            gross: stored.abs() + (net - stored).abs(),
        }
    }

    /// Whether the energies close well enough with the increment that ends at `trial` (docs/theory/energies.md, eq.
    /// 15).
    pub(in crate::solve) fn closes(&self, system: &System, state: &State, trial: &Trial) -> bool {
        let taken = self.taken(system, state, trial);
        let before = &state.energies;
        let after = (before.leaked + taken.open).abs();
        after <= LEAKING * (before.taken() + taken.net)
            || after <= before.leaked.abs()
            || taken.open.abs() <= LEAKING * taken.gross
    }

    /// Part of the last traction change with which the next increment starts (docs/theory/energies.md, eq. 16).
    pub(in crate::solve) fn traction_extrapolation(&self, before: &Energies) -> f64 {
        let open = before.leaked.abs() > LEAK * before.taken();
        if open && !self.method().has_inertia() {
            DAMPED
        } else {
            1.0
        }
    }

    /// Notes the open energy and the residual of the increment that ends at `trial`, before it becomes the state.
    pub(in crate::solve) fn note_leak(
        &mut self,
        system: &System,
        state: &mut State,
        trial: &Trial,
    ) {
        state.energies.leaked += self.taken(system, state, trial).open;
        self.vectors.left.copy_from_slice(&self.vectors.residual);
    }
}
