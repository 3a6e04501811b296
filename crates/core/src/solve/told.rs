//! What the history tells of a commit: displacement and force of what is driven or loaded, probes, loads.

use super::course::Course;
use super::drive::Run;
use super::probes::probes;
use crate::model::Model;
use crate::model::scene::{BeamMotion, HeldBy, Step};
use crate::system::dofs::HELD;

/// Whether a step drives a face or the end of a spring.
pub(super) fn drives(step: &Step) -> bool {
    let driven = |motion: &BeamMotion| matches!(motion, BeamMotion::Driven(_));
    let springs = step.springs.iter().flatten();
    step.motion.iter().flatten().any(driven) || springs.into_iter().any(|by| *by != 0.0)
}

/// Sense of the drive of a beam in a direction: that in which the first step that drives it there does. Displacements and
/// forces are counted along it.
pub(super) fn sense_of_beam(steps: &[Step], beam: usize, direction: usize) -> f64 {
    let mut by = steps.iter().filter_map(|step| step.motion.get(beam));
    let sense = by.find_map(|motion| match motion[direction] {
        BeamMotion::Driven(by) if by != 0.0 => Some(by.signum()),
        _ => None,
    });
    sense.unwrap_or(1.0)
}

/// The same of the driven end of a spring.
pub(super) fn sense_of_spring(steps: &[Step], spring: usize, direction: usize) -> f64 {
    let by = steps.iter().filter_map(|step| step.springs.get(spring));
    by.map(|by| by[direction])
        .find(|by| *by != 0.0)
        .map_or(1.0, f64::signum)
}

/// The same of the displacement that steers a load.
pub(super) fn sense_of_control(steps: &[Step]) -> f64 {
    let by = steps.iter().filter_map(|step| step.control);
    by.map(|control| control.displacement)
        .find(|by| *by != 0.0)
        .map_or(1.0, f64::signum)
}

/// A value along the drive; never a zero with a sign.
fn along(sense: f64, value: f64) -> f64 {
    if sense < 0.0 { 0.0 - value } else { value }
}

/// The load that the history tells of in a step of a model: the first that this step changes, or one
/// after it, or before.
fn told_load(model: &Model, step: usize) -> Option<usize> {
    let steps = model.steps[step..].iter().chain(&model.steps);
    let mut loads = steps.filter_map(|step| step.loads.iter().position(Option::is_some));
    loads.next()
}

impl Run<'_> {
    /// Displacement of what is driven [mm] and its force, both along the drive, and the force normal to its face,
    /// compression positive [N], at the last commit. In a model that drives nothing and has loads, those of
    /// a load.
    pub(super) fn driven(&self, step: usize) -> (f64, f64, f64) {
        if !self.model.steps.iter().any(drives)
            && let Some([displacement, force]) = self.loaded(step)
        {
            return (displacement, force, 0.0);
        }
        let (state, dofs) = (&self.state, &self.system.dofs);
        let Some((beam, direction)) = self.driven_beam(step) else {
            return self.driven_spring(step);
        };
        let slot = dofs.beam_slot(beam, direction);
        let normal = self.model.beams[beam].normal;
        let normal: f64 = (0..3)
            .map(|i| normal[i] * state.applied[dofs.beam_slot(beam, i)])
            .sum();
        let sense = sense_of_beam(&self.model.steps, beam, direction);
        (
            along(sense, state.q[slot]),
            along(sense, state.applied[slot]),
            -normal,
        )
    }

    /// Force of what a step drives, along its drive, in the increment that the trial ends [N].
    pub(super) fn driving_force(&self, course: &Course) -> f64 {
        let (system, trial) = (&self.system, &self.trial);
        match self.driven_beam(course.index) {
            Some((beam, direction)) => {
                let slot = system.dofs.beam_slot(beam, direction);
                let sense = sense_of_beam(&self.model.steps, beam, direction);
                along(sense, course.newton.applied(system, trial, slot))
            }
            None => self.driven_end(course.index).map_or(0.0, |(s, i)| {
                let sense = sense_of_spring(&self.model.steps, s, i);
                along(sense, system.spring_forces(trial)[s][i])
            }),
        }
    }

    /// How far the drive of a step goes, along itself, in the increment that the trial ends [mm].
    pub(super) fn driven_way(&self, course: &Course) -> f64 {
        let (system, trial, steps) = (&self.system, &self.trial, &self.model.steps);
        match self.driven_beam(course.index) {
            Some((beam, direction)) => {
                let slot = system.dofs.beam_slot(beam, direction);
                let sense = sense_of_beam(steps, beam, direction);
                along(sense, course.newton.q()[slot] - self.state.q[slot])
            }
            None => self.driven_end(course.index).map_or(0.0, |(s, i)| {
                let way = trial.spring_ends[s][i] - self.state.spring_ends[s][i];
                along(sense_of_spring(steps, s, i), way)
            }),
        }
    }

    /// Rise of the driving force by the tangent at the start of the increment that the trial ends [N], if the increment began
    /// with that tangent and drives a face.
    pub(super) fn linear_rise(&self, course: &Course) -> Option<f64> {
        let (beam, direction) = self.driven_beam(course.index)?;
        let slot = self.system.dofs.beam_slot(beam, direction);
        let sense = sense_of_beam(&self.model.steps, beam, direction);
        let forces = course.newton.linear_forces()?;
        Some(along(sense, forces[slot]))
    }

    /// The beam that a step is told by, and its direction: the step's own, or that of another.
    fn driven_beam(&self, step: usize) -> Option<(usize, usize)> {
        let steps = &self.model.steps;
        steps[step]
            .driven
            .or_else(|| steps.iter().find_map(|s| s.driven))
    }

    /// The spring whose end a step drives, or another does, and its direction.
    fn driven_end(&self, step: usize) -> Option<(usize, usize)> {
        let steps = std::iter::once(&self.model.steps[step]).chain(&self.model.steps);
        steps
            .flat_map(|step| step.springs.iter().enumerate())
            .find_map(|(s, by)| Some((s, (0..3).find(|&i| by[i] != 0.0)?)))
    }

    /// Displacement of the driven end of a spring [mm] and its force along the drive [N], where a step
    /// drives one and no face.
    fn driven_spring(&self, step: usize) -> (f64, f64, f64) {
        self.driven_end(step).map_or((0.0, 0.0, 0.0), |(s, i)| {
            let sense = sense_of_spring(&self.model.steps, s, i);
            (
                along(sense, self.state.spring_ends[s][i]),
                along(sense, self.state.spring_forces[s][i]),
                0.0,
            )
        })
    }

    /// What a step's watch sees: displacement [mm] and force [kN] of its drive, or of its load.
    pub(super) fn watched(&self, step: usize) -> [f64; 2] {
        let [displacement, force] = match self.loaded(step) {
            Some(loaded) if !drives(&self.model.steps[step]) => loaded,
            _ => {
                let (displacement, force, _) = self.driven(step);
                [displacement, force]
            }
        };
        [displacement, 1e-3 * force]
    }

    /// Displacement [mm] and force along its direction [N] of the load that a step is told by, if the model
    /// has any. Where a displacement steers a step it is that; else the mean of the loaded nodes weighted by
    /// what the load at rest does to them, so that with its force it makes its work.
    fn loaded(&self, step: usize) -> Option<[f64; 2]> {
        let (model, state) = (self.model, &self.state);
        let told = told_load(model, step)?;
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
        // A pressure all around has no direction: its area stands for it.
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
            weights.iter().zip(slots).map(work).sum::<f64>() / whole
        };
        Some([displacement, force])
    }

    /// Takes off what the other half takes back of forces at nodes in a plane of symmetry.
    fn level(&self, forces: &mut [[f64; 3]]) {
        for support in &self.model.supports {
            if let HeldBy::Plane { axis, .. } = support.by {
                for n in &support.nodes {
                    forces[*n as usize][axis] = 0.0;
                }
            }
        }
    }

    /// Columns of the last commit beside those of every history: probes, then each load's value and its
    /// force in all, which is among the `reactions` [N], then the outputs of the solids.
    pub(super) fn columns(&self, reactions: &[[f64; 3]]) -> Vec<f64> {
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
        columns
    }
}
