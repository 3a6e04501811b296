//! Work and energies of an increment by the trapezoidal rule (docs/theory/energies.md).

use super::newton::Newton;
use crate::assembly::{System, Trial};
use crate::state::{Energies, State};

impl Newton<'_> {
    /// Work of the step's loads over the last increment, per unit of the load factor [N mm].
    pub(in crate::solve) fn work_of_loads(
        &self,
        system: &System,
        state: &State,
        x: &[[f64; 3]],
    ) -> f64 {
        let rate = self
            .loading
            .loads
            .rate(self.step, system, self.loading.factor, x);
        let way = self.q.iter().zip(&state.q).map(|(q, s)| q - s);
        rate.iter().zip(way).map(|(rate, way)| rate * way).sum()
    }

    /// Energy that the time integration dissipates in the increment that ends at `trial`, with the term of points
    /// that change facets [N mm].
    pub fn numerical_dissipation(&self, system: &System, state: &State, trial: &Trial) -> f64 {
        let dq: Vec<f64> = self.q.iter().zip(&state.q).map(|(q, s)| q - s).collect();
        let scheme = self.motion.as_ref().map_or(0.0, |motion| {
            motion.dissipations(&system.mass, state, trial, &dq, &self.loading.loads.total)[0]
        });
        scheme + system.crossing_work(self.model, state, trial)
    }

    /// Dashpot forces of an increment without inertia [N]. `[slot]`
    fn dashpots_of_slots(&self, slots: usize) -> Vec<f64> {
        let mut forces = vec![0.0; slots];
        let of_equations = self.dashpot_forces().into_iter();
        for (force, &slot) in of_equations.zip(&self.equations.slot_of) {
            forces[slot as usize] = force;
        }
        forces
    }

    /// Force on a beam in the increment that ends at `trial` [N].
    pub fn applied(&self, system: &System, trial: &Trial, slot: usize) -> f64 {
        let given = self.loading.loads.given(slot);
        match &self.motion {
            Some(motion) if !motion.is_prescribed(slot) => self.loading.loads.total[slot] - given,
            Some(motion) => motion.reaction(&system.mass, slot, trial.force[slot], given),
            None => trial.force[slot] - given,
        }
    }

    /// Work of the forces on beams and on ends of springs from `state` to `trial`, by the trapezoidal rule [N mm].
    pub(in crate::solve) fn driven_work(
        &self,
        system: &System,
        state: &State,
        trial: &Trial,
    ) -> f64 {
        let of_beam = |slot: usize| {
            let force = state.applied[slot] + self.applied(system, trial, slot);
            0.5 * force * (self.q[slot] - state.q[slot])
        };
        let beams = (system.dofs.beam_start..system.dofs.slots).map(of_beam);
        let forces = system.spring_forces(trial);
        let springs = forces.iter().enumerate().map(|(s, force)| {
            let along = |i: usize| {
                let way = trial.spring_ends[s][i] - state.spring_ends[s][i];
                0.5 * (state.spring_forces[s][i] + force[i]) * way
            };
            (0..3).map(along).sum::<f64>()
        });
        beams.sum::<f64>() + springs.sum::<f64>()
    }

    /// Energy account of the increment that ends at `trial`, by the trapezoidal rule. `dq`: displacements of the
    /// increment [mm] `[slot]`
    pub(in crate::solve) fn account(
        &self,
        system: &System,
        state: &State,
        trial: &Trial,
        dq: &[f64],
    ) -> Account {
        let mut energies = state.energies;
        energies.external += self.loading.loads.work(&self.loading.loads_start, dq);
        energies.numerical += system.crossing_work(self.model, state, trial)
            + system.turning_work(self.model, state, trial);
        let mut applied = state.applied.clone();
        for (slot, force) in applied.iter_mut().enumerate().skip(system.dofs.beam_start) {
            *force = self.applied(system, trial, slot);
        }
        energies.external += self.driven_work(system, state, trial);
        let spring_forces = system.spring_forces(trial);
        let mut dashpots = None;
        if let Some(motion) = &self.motion {
            let loads = &self.loading.loads.total;
            let [numerical, damping] = motion.dissipations(&system.mass, state, trial, dq, loads);
            energies.numerical += numerical;
            energies.damping += damping;
            energies.kinetic = motion.kinetic_energy(&system.mass);
        } else {
            let now = self.dashpots_of_slots(state.damping.len());
            let forces = now.iter().zip(&state.damping);
            let work: f64 = forces.zip(dq).map(|((a, b), u)| 0.5 * (a + b) * u).sum();
            energies.damping += work;
            dashpots = Some(now);
        }
        energies.external += trial.ties.sum(|tie| tie.jacked);
        energies.elastic = system.elastic_energy(trial, &spring_forces);
        let solids = &trial.solids.energy;
        energies.plastic_damage += solids.iter().map(|e| e.plastic_damage).sum::<f64>();
        energies.plastic_damage += trial.ties.sum(|tie| tie.dissipated);
        energies.viscous += solids.iter().map(|e| e.viscous).sum::<f64>();
        energies.interface += system.interface_dissipation(trial);
        Account {
            energies,
            applied,
            spring_forces,
            dashpots,
        }
    }

    /// Enters the account of the increment that ends at `trial` into the state: energies, external forces,
    /// velocities.
    pub(in crate::solve) fn enter(&self, account: Account, state: &mut State, trial: &Trial) {
        state.energies = account.energies;
        state.loads.clone_from(&self.loading.loads.values);
        state.weights = self.loading.loads.weights;
        state.applied = account.applied;
        state.spring_forces = account.spring_forces;
        state.spring_ends.clone_from(&trial.spring_ends);
        if let Some(dashpots) = account.dashpots {
            state.damping = dashpots;
        }
        if let Some(motion) = &self.motion {
            motion.commit(state);
        }
    }
}

/// Energies and external forces at the end of an increment.
pub(in crate::solve) struct Account {
    /// Energies at its end.
    pub(in crate::solve) energies: Energies,
    /// Forces on the beams [N]. `[slot]`
    applied: Vec<f64>,
    /// Forces of the springs [N]. `[spring][xyz]`
    spring_forces: Vec<[f64; 3]>,
    /// Dashpot forces, without inertia [N]. `[slot]`
    dashpots: Option<Vec<f64>>,
}
