//! Commit of a converged increment: its state, its history row and its frame.

use super::joint_damage::joint_damage;
use super::run::{Run, RunError};
use super::step_run::{IncrementRequest, StepRun};
use crate::model::scene::Step;
use crate::solve::Recorder;
use crate::solve::increment::newton::Newton;
use crate::solve::increment::outcome::Report;
use crate::state::HistoryRow;
use crate::state::LastIncrement;
use std::time::Instant;
use wythe_contact::PointStatus;

impl Run<'_> {
    /// Makes the trial the state. Returns the displacements of the increment [mm]. `[slot]`
    pub(in crate::solve) fn commit(
        &mut self,
        newton: &mut Newton,
        step: &Step,
        size: f64,
        load: f64,
    ) -> Vec<f64> {
        let (state, trial) = (&mut self.state, &mut self.trial);
        let dq: Vec<f64> = newton
            .q()
            .iter()
            .zip(&state.q)
            .map(|(new, old)| new - old)
            .collect();
        let dtraction = trial
            .joints
            .history
            .iter()
            .zip(&state.interface)
            .map(|(new, old)| [0, 1, 2].map(|i| new.traction[i] - old.traction[i]))
            .collect();
        newton.note_leak(&self.system, state, trial);
        let account = newton.account(&self.system, state, trial, &dq);
        newton.enter(account, state, trial);
        let dt = size * step.duration;
        state.time += dt;
        state.increments += 1;
        state.q.copy_from_slice(newton.q());
        state.force.copy_from_slice(&trial.force);
        state.material.copy_from_slice(&trial.solids.history);
        state.interface.copy_from_slice(&trial.joints.history);
        state.pairs.copy_from_slice(&trial.joints.pairs);
        for (history, segment) in state.ties.iter_mut().zip(&trial.ties.segments) {
            *history = segment.history;
        }
        state.touches = self.system.general.committed(trial);
        self.system.follow(&mut state.poses, trial);
        state.wants_double |= newton.wanted_double();
        state.largest_mean_force = state.largest_mean_force.max(trial.mean_nodal_force);
        state.moved = None;
        state.last = Some(LastIncrement {
            dq: dq.clone(),
            dtraction,
            dt,
            load,
        });
        dq
    }

    /// History row of the last commit, which took `solves` with those of the rejected attempts.
    pub(in crate::solve) fn row(
        &self,
        step_run: &StepRun,
        request: IncrementRequest,
        report: Report,
        solves: usize,
    ) -> HistoryRow {
        let (state, trial, step) = (&self.state, &self.trial, step_run.index);
        let (displacement, force, reaction) = self.driven(step);
        let reactions = self.reactions();
        // Of general contact, only pressed touches count.
        let touching = |status: PointStatus| {
            let pressed = trial
                .general
                .touches
                .iter()
                .filter(|t| t.touch.history.traction[0] < 0.0);
            pressed.filter(|t| t.status == status).count()
        };
        let count = |status: PointStatus| {
            let joints = self.system.contact.count(&trial.joints.status, status);
            joints + touching(status)
        };
        let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
        let e = &state.energies;
        HistoryRow {
            increment: state.increments,
            step,
            time: state.time,
            displacement_mm: displacement,
            force_kN: force * 1e-3,
            reaction_kN: reaction * 1e-3,
            iterations: solves,
            cutbacks: step_run.attempts.cutbacks,
            external_work_J: e.external * 1e-3,
            elastic_energy_J: e.elastic * 1e-3,
            plastic_damage_dissipation_J: e.plastic_damage * 1e-3,
            interface_dissipation_J: e.interface * 1e-3,
            viscous_dissipation_J: e.viscous * 1e-3,
            open_points: count(PointStatus::Open),
            sliding_points: count(PointStatus::Slip),
            max_interface_damage: most(
                &mut joint_damage(self.model, state).map(|(_, damage)| damage),
            ),
            max_tensile_damage: most(&mut state.material.iter().map(|h| h.tensile_damage)),
            max_compressive_damage: most(&mut state.material.iter().map(|h| h.compressive_damage)),
            out_of_balance: report.out_of_balance,
            residual: report.residual,
            kinetic_energy_J: e.kinetic * 1e-3,
            damping_dissipation_J: e.damping * 1e-3,
            numerical_dissipation_J: e.numerical * 1e-3,
            contact_area_mm2: self.system.pressed_area(state),
            load_factor: report.load_factor,
            procedure: request.method,
            probes: self.columns(&reactions),
            reactions,
        }
    }

    /// Passes the commit to the recorder; false if the recorder asks to stop.
    pub(in crate::solve) fn record(
        &mut self,
        row: &HistoryRow,
        recorder: &mut dyn Recorder,
        last: bool,
    ) -> Result<bool, RunError> {
        let start = Instant::now();
        let every = self.model.output.every.max(1);
        let frame = (last || row.increment.is_multiple_of(every)).then(|| self.frame(row));
        recorder.observe(&self.state);
        let keep = recorder.take(self.model, row, frame.as_ref())?;
        if frame.is_none() && recorder.wants_fields() {
            recorder.keep(self.model, self.frame(row));
        }
        self.output_seconds += start.elapsed().as_secs_f64();
        Ok(keep)
    }
}
