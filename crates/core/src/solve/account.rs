//! Work and energies of an increment, by the trapezoidal rule.

use super::newton::Newton;
use super::state::State;
use crate::system::{System, Trial};

impl Newton<'_> {
    /// Work that the loads of the step do along the last increment, for each unit of the load factor [N mm].
    pub(super) fn work_of_loads(&self, system: &System, state: &State, x: &[[f64; 3]]) -> f64 {
        let rate = self.loads.rate(self.step, system, self.load_factor, x);
        let way = self.q.iter().zip(&state.q).map(|(q, s)| q - s);
        rate.iter().zip(way).map(|(rate, way)| rate * way).sum()
    }

    /// Energy that the time integration takes out in the increment that `trial` ends [N mm].
    pub fn numerical_dissipation(&self, system: &System, state: &State, trial: &Trial) -> f64 {
        let dq: Vec<f64> = self.q.iter().zip(&state.q).map(|(q, s)| q - s).collect();
        let scheme = self.motion.as_ref().map_or(0.0, |motion| {
            motion.dissipations(&system.mass, state, trial, &dq, &self.loads.total)[0]
        });
        scheme + system.crossing_work(self.model, state, trial)
    }

    /// Work of the dashpots in an increment without inertia, by the trapezoidal rule. `dq`: its displacements [mm] `[slot]`
    fn account_dashpots(&self, state: &mut State, dq: &[f64]) {
        let mut now = vec![0.0; state.damping.len()];
        for (force, &slot) in self
            .dashpot_forces()
            .into_iter()
            .zip(&self.equations.slot_of)
        {
            now[slot as usize] = force;
        }
        let forces = now.iter().zip(&state.damping);
        let work: f64 = forces.zip(dq).map(|((a, b), u)| 0.5 * (a + b) * u).sum();
        state.energies.damping += work;
        state.damping = now;
    }

    /// Force on a beam in the increment that `trial` ends [N].
    pub fn applied(&self, system: &System, trial: &Trial, slot: usize) -> f64 {
        let given = self.loads.given(slot);
        match &self.motion {
            Some(motion) if !motion.is_prescribed(slot) => self.loads.total[slot] - given,
            Some(motion) => motion.reaction(&system.mass, slot, trial.force[slot], given),
            None => trial.force[slot] - given,
        }
    }

    /// Work from outside and the energies of motion of the increment that `trial` ends, by the
    /// trapezoidal rule; then the forces on the beams, velocities and accelerations of the state.
    /// `dq` are the displacements of the increment [mm]. `[slot]`
    pub fn account(&self, system: &System, state: &mut State, trial: &Trial, dq: &[f64]) {
        state.energies.external += self.loads.work(&self.loads_start, dq);
        state.loads.clone_from(&self.loads.values);
        state.energies.numerical += system.crossing_work(self.model, state, trial)
            + system.turning_work(self.model, state, trial);
        for slot in system.dofs.beam_start..system.dofs.slots {
            let applied = self.applied(system, trial, slot);
            state.energies.external += 0.5 * (state.applied[slot] + applied) * dq[slot];
            state.applied[slot] = applied;
        }
        let forces = system.spring_forces(trial);
        for (s, force) in forces.iter().enumerate() {
            for i in 0..3 {
                let way = trial.spring_ends[s][i] - state.spring_ends[s][i];
                state.energies.external += 0.5 * (state.spring_forces[s][i] + force[i]) * way;
            }
        }
        state.spring_forces = forces;
        state.spring_ends.clone_from(&trial.spring_ends);
        if self.motion.is_none() {
            self.account_dashpots(state, dq);
        }
        if let Some(motion) = &self.motion {
            motion.commit(&system.mass, state, trial, dq, &self.loads.total);
        }
    }
}
