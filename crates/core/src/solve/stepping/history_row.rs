//! Values of a history row: displacement and force of the drive or load, probes, loads.

use super::probes::probes;
use super::run::Run;
use super::step_run::StepRun;
use crate::assembly::dofs::HELD;
use crate::model::Model;
use crate::model::scene::{Driven, HeldBy, Step};
use crate::model::steps::DrivenEnd;

/// Sign of the direction in which beam displacements and forces are counted: that of the first step that drives the
/// beam in this direction.
pub(in crate::solve) fn sense_of_beam(steps: &[Step], driven: Driven) -> f64 {
    let mut ways = steps.iter().filter_map(|step| driven.way(step));
    ways.find(|by| *by != 0.0).map_or(1.0, f64::signum)
}

/// The same as [`sense_of_beam`] for the driven end of a spring.
pub(in crate::solve) fn sense_of_spring(steps: &[Step], driven: DrivenEnd) -> f64 {
    let by = steps
        .iter()
        .filter_map(|step| step.springs.get(driven.spring));
    by.map(|by| driven.component(*by))
        .find(|by| *by != 0.0)
        .map_or(1.0, f64::signum)
}

/// The same for a displacement that steers a load.
pub(in crate::solve) fn sense_of_control(steps: &[Step]) -> f64 {
    let by = steps.iter().filter_map(|step| step.control);
    by.map(|control| control.displacement)
        .find(|by| *by != 0.0)
        .map_or(1.0, f64::signum)
}

/// A value along the drive, without negative zeros.
fn along(sense: f64, value: f64) -> f64 {
    if sense < 0.0 { 0.0 - value } else { value }
}

/// First value of a pressure other than 0 [MPa].
fn first_pressure(model: &Model, load: usize) -> f64 {
    let values = model.steps.iter().filter_map(|step| *step.loads.get(load)?);
    let mut values = values.map(|value| value[0]);
    values.find(|value| *value != 0.0).unwrap_or(0.0)
}

impl Run<'_> {
    /// Displacement of the drive [mm] and its force [N], both along the drive, and the force normal to its face,
    /// compression positive [N], at the last commit. For models with loads and without drive: displacement and force
    /// of a load, and 0.
    pub(in crate::solve) fn driven(&self, step: usize) -> (f64, f64, f64) {
        if !self.model.steps.iter().any(Step::drives)
            && let Some(live) = self.model.live_load()
        {
            let [displacement, force] = self.loaded(step, live);
            return (displacement, force, 0.0);
        }
        let (state, dofs) = (&self.state, &self.system.dofs);
        let Some(driven) = self.driven_beam(step) else {
            return self.driven_spring(step);
        };
        let slot = |axis| dofs.beam_slot(driven.beam, axis);
        let normal = self.model.beams[driven.beam].normal;
        let normal: f64 = (0..3).map(|i| normal[i] * state.applied[slot(i)]).sum();
        let sense = sense_of_beam(&self.model.steps, driven);
        (
            along(sense, driven.component(|axis| state.q[slot(axis)])),
            along(sense, driven.component(|axis| state.applied[slot(axis)])),
            -normal,
        )
    }

    /// Force of a step's drive along itself in the increment that ends at the trial [N].
    pub(in crate::solve) fn driving_force(&self, step_run: &StepRun) -> f64 {
        let (system, trial) = (&self.system, &self.trial);
        match self.driven_beam(step_run.index) {
            Some(driven) => {
                let slot = |axis| system.dofs.beam_slot(driven.beam, axis);
                let sense = sense_of_beam(&self.model.steps, driven);
                let applied = |axis| step_run.newton.applied(system, trial, slot(axis));
                along(sense, driven.component(applied))
            }
            None => self.driven_end(step_run.index).map_or(0.0, |driven| {
                let sense = sense_of_spring(&self.model.steps, driven);
                let force = system.spring_forces(trial)[driven.spring];
                along(sense, driven.component(force))
            }),
        }
    }

    /// Displacement of a step's drive along itself in the increment that ends at the trial [mm].
    pub(in crate::solve) fn driven_way(&self, step_run: &StepRun) -> f64 {
        let (system, trial, steps) = (&self.system, &self.trial, &self.model.steps);
        match self.driven_beam(step_run.index) {
            Some(driven) => {
                let slot = |axis| system.dofs.beam_slot(driven.beam, axis);
                let way = |axis| step_run.newton.q()[slot(axis)] - self.state.q[slot(axis)];
                along(sense_of_beam(steps, driven), driven.component(way))
            }
            None => self.driven_end(step_run.index).map_or(0.0, |driven| {
                let ends = [&trial.spring_ends, &self.state.spring_ends];
                let [now, then] = ends.map(|ends| ends[driven.spring]);
                let way = [0, 1, 2].map(|axis| now[axis] - then[axis]);
                along(sense_of_spring(steps, driven), driven.component(way))
            }),
        }
    }

    /// Rise of the driving force that the first tangent predicts for the increment that ends at the trial [N]; none
    /// if the increment did not start from that tangent or no face is driven.
    pub(in crate::solve) fn linear_rise(&self, step_run: &StepRun) -> Option<f64> {
        let driven = self.driven_beam(step_run.index)?;
        let sense = sense_of_beam(&self.model.steps, driven);
        let forces = step_run.newton.linear_forces()?;
        let force = |axis| forces[self.system.dofs.beam_slot(driven.beam, axis)];
        Some(along(sense, driven.component(force)))
    }

    /// Beam whose motion the history shows, and its direction: that of the step, else of another step.
    fn driven_beam(&self, step: usize) -> Option<Driven> {
        let steps = &self.model.steps;
        let own = steps[step].driven;
        // A step that drives a spring shows the spring, whatever a preload has shown.
        let others = || steps.iter().find_map(|s| s.driven);
        own.or_else(|| others().filter(|_| DrivenEnd::of(&steps[step]).is_none()))
    }

    /// Spring whose end is driven in the step, else in another, and its direction.
    fn driven_end(&self, step: usize) -> Option<DrivenEnd> {
        let mut steps = std::iter::once(&self.model.steps[step]).chain(&self.model.steps);
        steps.find_map(DrivenEnd::of)
    }

    /// Displacement of the driven end of a spring [mm], its force along the drive [N], and 0, where a step drives a
    /// spring and no face.
    fn driven_spring(&self, step: usize) -> (f64, f64, f64) {
        self.driven_end(step).map_or((0.0, 0.0, 0.0), |driven| {
            let sense = sense_of_spring(&self.model.steps, driven);
            let part = |all: &[[f64; 3]]| along(sense, driven.component(all[driven.spring]));
            (
                part(&self.state.spring_ends),
                part(&self.state.spring_forces),
                0.0,
            )
        })
    }

    /// Displacement [mm] and force [kN] of the drive, or of the load, for the watch of a step.
    pub(in crate::solve) fn watched(&self, step: usize) -> [f64; 2] {
        let own = self.model.steps[step]
            .loads
            .iter()
            .position(Option::is_some);
        let [displacement, force] = match own.or_else(|| self.model.live_load()) {
            Some(load) if !self.model.steps[step].drives() => self.loaded(step, load),
            _ => {
                let (displacement, force, _) = self.driven(step);
                [displacement, force]
            }
        };
        [displacement, 1e-3 * force]
    }

    /// Displacement [mm] of a load, and its force along its first value [N]. Where a displacement steers the step, it is
    /// that one. Otherwise it is the mean over the loaded nodes, weighted by the nodal forces of the load at rest, so that
    /// force times displacement is the work of the load.
    #[expect(
        clippy::too_many_lines,
        reason = "force and displacement of a load share its weights"
    )]
    fn loaded(&self, step: usize, told: usize) -> [f64; 2] {
        let (model, state) = (self.model, &self.state);
        let load = &model.loads[told];
        let outside = &self.system.outside;
        let force_of = |value: [f64; 3], x: &[[f64; 3]]| {
            let mut force = vec![[0.0; 3]; x.len()];
            outside.add(told, value, x, &mut force);
            force
        };
        let sum = |force: &[[f64; 3]]| {
            let all = force
                .iter()
                .fold([0.0; 3], |sum, f| [0, 1, 2].map(|i| sum[i] + f[i]));
            load.along(all)
        };
        let around = load.direction == [0.0; 3];
        let one = if load.is_pressure() {
            [1.0, 0.0, 0.0]
        } else {
            load.direction
        };
        let mut weights = force_of(one, &model.mesh.nodes);
        self.system.dofs.fold(&mut weights);
        if around {
            self.level(&mut weights);
        }
        // A pressure on all sides has no direction; it is measured by its area.
        let size = |f: &[f64; 3]| f.iter().map(|f| f * f).sum::<f64>().sqrt();
        let whole = if around {
            weights.iter().map(size).sum()
        } else {
            sum(&weights)
        };
        let force = if around {
            load.told(state.loads[told]) * whole
        } else {
            let mut x = vec![[0.0; 3]; model.mesh.nodes.len()];
            self.system.dofs.spread(&state.q, &mut x);
            for (x, rest) in x.iter_mut().zip(&model.mesh.nodes) {
                *x = [0, 1, 2].map(|i| rest[i] + x[i]);
            }
            sum(&force_of(state.loads[told], &x))
        };
        let steered = model.steps[step..]
            .iter()
            .chain(&model.steps)
            .find_map(|s| s.control);
        let displacement = if let Some(control) = steered {
            let value = probes(model, &self.system.dofs, state)[control.probe];
            along(sense_of_control(&model.steps), value)
        } else {
            let slots = self.system.dofs.slot.iter();
            let work = |(weight, slots): (&[f64; 3], &[u32; 3])| -> f64 {
                let moved = |i: usize| match slots[i] {
                    HELD => 0.0,
                    slot => weight[i] * state.q[slot as usize],
                };
                (0..3).map(moved).sum()
            };
            let work: f64 = weights.iter().zip(slots).map(work).sum();
            // A load of 0 has no weights.
            if whole == 0.0 { 0.0 } else { work / whole }
        };
        // A suction is a pressure below 0: it counts along its own sense, as other loads do.
        if load.is_pressure() && first_pressure(model, told) < 0.0 {
            let own = if steered.is_some() {
                displacement
            } else {
                -displacement
            };
            return [own, -force];
        }
        [displacement, force]
    }

    /// Removes the forces normal to symmetry planes at nodes in them: the other half cancels these.
    fn level(&self, forces: &mut [[f64; 3]]) {
        for support in &self.model.supports {
            if let HeldBy::Plane { axis, .. } = support.by {
                for n in &support.nodes {
                    forces[*n as usize][axis] = 0.0;
                }
            }
        }
    }

    /// Additional columns of the last commit ([`Model::columns`]): probes, the value of each load and its resultant,
    /// which is the last part of `reactions` [N], the largest value of each output of the solids, the force [kN] and the
    /// stretch [mm] of each tie, the reactions of the supports, the sections.
    pub(in crate::solve) fn columns(&self, reactions: &[[f64; 3]]) -> Vec<f64> {
        let (model, state) = (self.model, &self.state);
        let mut columns = probes(model, &self.system.dofs, state);
        let first = reactions.len() - model.loads.len();
        for (l, load) in model.loads.iter().enumerate() {
            if load.columns.len() > 1 {
                columns.push(load.told(state.loads[l]));
            }
            columns.push(1e-3 * load.along(reactions[first + l]));
        }
        columns.extend(self.most_of_outputs());
        for reading in self.system.ties.readings(&state.ties) {
            columns.extend([1e-3 * reading.force, reading.stretch]);
        }
        columns.extend(model.reaction_values(reactions));
        let cuts = self.system.cuts.iter();
        columns.extend(cuts.flat_map(|cut| self.system.section_values(cut, &self.trial)));
        columns
    }
}
