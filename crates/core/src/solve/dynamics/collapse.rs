//! Collapse: `auto` has gone over to inertia because statics found no equilibrium, and bodies fall.
//!
//! Displacements are measured from the last equilibrium. A body falls if its mean displacement since then is larger than its
//! smallest edge (of the box around it at rest) and larger by that than the way which anything was driven meanwhile, and if the
//! kinetic energy is still above [`QUIET`] times the energy that solids and joints have taken. A step that only loads ends there:
//! it asks for an equilibrium, and there is none. A step that drives goes on until such bodies have half of the mass of all that nothing holds: stones may
//! fall off a wall that still carries. Procedures with inertia that the deck names are never ended: their motion is wanted.

use serde::{Deserialize, Serialize};

use crate::assembly::System;
use crate::assembly::dofs::HELD;
use crate::model::Model;
use crate::model::scene::{BeamMotion, Procedure};
use crate::solve::Recorder;
use crate::solve::stepping::history_row::drives;
use crate::solve::stepping::run::Run;
use crate::solve::stepping::step_run::StepRun;
use crate::state::Method;
use crate::state::QUIET;
use crate::state::State;
use crate::state::{Fall, FallenBody, Status};

/// Part of the mass that falls when a step that drives ends.
const MOST: f64 = 0.5;
/// Part of its smallest edge by which a body must have moved at the end of the run to count as fallen, if it moves faster and
/// faster.
const AT_END: f64 = 0.1;
/// Part of the largest displacement from which on a body is named beside the one that has it.
const NAMED: f64 = 0.5;

/// The last equilibrium before inertia took over.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(in crate::solve) struct LastEquilibrium {
    step: usize,
    load_factor: f64,
    /// Displacements there [mm]. `[slot]`
    q: Vec<f64>,
    /// `[spring][xyz]`
    spring_ends: Vec<[f64; 3]>,
    /// Whether the kinetic energy grew in the last increment.
    hastens: bool,
}

impl LastEquilibrium {
    /// Whether it is of the model of a state.
    pub(in crate::solve) fn fits(&self, state: &State) -> bool {
        self.q.len() == state.q.len() && self.spring_ends.len() == state.spring_ends.len()
    }
}

/// A body since the last equilibrium.
struct Moved {
    /// Mean displacement [mm].
    by: [f64; 3],
    /// Smallest edge of the box around it at rest [mm].
    edge: f64,
    /// Its nodes, of which `by` is the mean.
    count: f64,
    /// [tonne]
    mass: f64,
    /// Whether something holds one of its nodes in all directions.
    held: bool,
}

impl Moved {
    fn way(&self) -> f64 {
        length(self.by)
    }
}

impl Run<'_> {
    /// Inertia takes over from an equilibrium.
    pub(in crate::solve) fn depart(&mut self, step: usize, load_factor: f64) {
        self.last_equilibrium = Some(LastEquilibrium {
            step,
            load_factor,
            q: self.state.q.clone(),
            spring_ends: self.state.spring_ends.clone(),
            hastens: false,
        });
    }

    /// Ends the run if the scene has collapsed in the increment of the last commit, before which the kinetic energy was
    /// `before` [N mm].
    pub(in crate::solve) fn collapses(
        &mut self,
        step_run: &StepRun,
        method: Method,
        before: f64,
    ) -> bool {
        let is_auto = step_run.step.procedure == Procedure::Auto;
        if !is_auto || method != Method::QuasiStatic {
            return false;
        }
        let energies = self.state.energies;
        let Some(last_equilibrium) = &mut self.last_equilibrium else {
            return false;
        };
        last_equilibrium.hastens = energies.kinetic > before;
        if energies.moving() <= QUIET {
            return false;
        }
        let Some((bodies, driven)) = self.moved(step_run.index) else {
            return false;
        };
        let falls = |body: &Moved| body.way() > body.edge + driven;
        let mass = |of: &dyn Fn(&Moved) -> bool| -> f64 {
            let bodies = bodies.iter().filter(|body| of(body));
            bodies.map(|body| body.mass).sum()
        };
        let fallen = mass(&falls);
        let collapsed = if drives(step_run.step) {
            fallen > MOST * mass(&|body| !body.held)
        } else {
            fallen > 0.0
        };
        if collapsed {
            self.summary.status = Status::Collapsed;
            self.summary.fall = self.fall(step_run.index, &bodies, driven);
        }
        collapsed
    }

    /// Tells of a collapse while the run goes.
    pub(in crate::solve) fn tell_collapse(
        &mut self,
        step_run: &StepRun,
        recorder: &mut dyn Recorder,
    ) {
        let text = format!(
            "step {} ({}) ends at {}: no equilibrium is left, bodies fall",
            step_run.index,
            step_run.step.name,
            step_run.progress()
        );
        recorder.note(&text);
        self.summary.log.push(text);
    }

    /// What still falls or moves when the last step has ended.
    pub(in crate::solve) fn tell_what_moves(&mut self) {
        let Some(last) = self.model.steps.len().checked_sub(1) else {
            return;
        };
        let energies = self.state.energies;
        if self.summary.status != Status::Completed || energies.moving() <= QUIET {
            return;
        }
        let (Some(last_equilibrium), Some((bodies, driven))) =
            (&self.last_equilibrium, self.moved(last))
        else {
            return;
        };
        let drives = drives(&self.model.steps[last]);
        let part = if drives { 1.0 } else { AT_END };
        let falls = |body: &Moved| body.way() > part * body.edge + driven;
        let any = bodies.iter().any(falls);
        if drives && !any {
            return;
        }
        if !drives && any && last_equilibrium.hastens {
            self.summary.status = Status::Collapsed;
        }
        self.summary.fall = self.fall(last, &bodies, driven);
    }

    /// What the bodies have done since the last equilibrium, and how far anything was driven [mm]; nothing where inertia did
    /// not take over. `[unit]`
    fn moved(&self, step: usize) -> Option<(Vec<Moved>, f64)> {
        let last_equilibrium = self.last_equilibrium.as_ref()?;
        let (state, dofs) = (&self.state, &self.system.dofs);
        let ways = state.q.iter().zip(&last_equilibrium.q);
        let dq: Vec<f64> = ways.map(|(now, then)| now - then).collect();
        let mut u = vec![[0.0; 3]; self.model.mesh.nodes.len()];
        dofs.spread(&dq, &mut u);
        let mut driven = 0.0_f64;
        for (b, motion) in self.model.steps[step].motion.iter().enumerate() {
            for (i, motion) in motion.iter().enumerate() {
                if matches!(motion, BeamMotion::Driven(_)) {
                    driven = driven.max(dq[dofs.beam_slot(b, i)].abs());
                }
            }
        }
        for (now, then) in state.spring_ends.iter().zip(&last_equilibrium.spring_ends) {
            driven = driven.max(length([0, 1, 2].map(|i| now[i] - then[i])));
        }
        Some((moved(self.model, &self.system, &u), driven))
    }

    /// The bodies that moved most, those that moved farther than half as far.
    fn fall(&self, step: usize, bodies: &[Moved], driven: f64) -> Option<Fall> {
        let last_equilibrium = self.last_equilibrium.as_ref()?;
        let most = bodies.iter().map(Moved::way).fold(0.0, f64::max);
        let named = |body: &Moved| body.way() >= (NAMED * most).max(driven) && body.way() > 0.0;
        let down = self.down(step);
        let named = bodies.iter().enumerate().filter(|(_, body)| named(body));
        let mut named: Vec<FallenBody> = named
            .map(|(unit, body)| FallenBody {
                name: self.model.mesh.called(unit as u32),
                moved_mm: body.way(),
                fall_mm: (0..3).map(|i| body.by[i] * down[i]).sum(),
                unit: unit as u32,
            })
            .collect();
        named.sort_by(|a, b| b.moved_mm.total_cmp(&a.moved_mm));
        Some(Fall {
            step: last_equilibrium.step,
            step_name: self.model.steps[last_equilibrium.step].name.clone(),
            load_factor: last_equilibrium.load_factor,
            kinetic_energy_J: 1e-3 * self.state.energies.kinetic,
            bodies: named,
        })
    }

    /// Direction in which things fall in a step: that of gravity, now or in the step's middle; nothing without gravity.
    fn down(&self, step: usize) -> [f64; 3] {
        let gravity = self.model.steps[step].gravity.at(1.0);
        let size = length(gravity);
        gravity.map(|g| if size > 0.0 { g / size } else { 0.0 })
    }
}

/// Mean displacement, size and mass of each body. `[unit]`
fn moved(model: &Model, system: &System, u: &[[f64; 3]]) -> Vec<Moved> {
    let mesh = &model.mesh;
    let units = mesh.unit.iter().max().map_or(0, |unit| *unit as usize + 1);
    let mut boxes = vec![[[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]]; units];
    let mut bodies: Vec<Moved> = (0..units)
        .map(|_| Moved {
            by: [0.0; 3],
            edge: 0.0,
            count: 0.0,
            mass: 0.0,
            held: false,
        })
        .collect();
    // Bodies share no nodes.
    let mut seen = vec![false; mesh.nodes.len()];
    for (nodes, unit) in mesh.elements.iter().zip(&mesh.unit) {
        let (body, own) = (&mut bodies[*unit as usize], &mut boxes[*unit as usize]);
        for n in nodes.map(|n| n as usize) {
            if std::mem::replace(&mut seen[n], true) {
                continue;
            }
            body.count += 1.0;
            body.mass += system.mass.node[n];
            body.held |= system.dofs.slot[n] == [HELD; 3];
            for i in 0..3 {
                body.by[i] += u[n][i];
                own[0][i] = own[0][i].min(mesh.nodes[n][i]);
                own[1][i] = own[1][i].max(mesh.nodes[n][i]);
            }
        }
    }
    for (body, [low, high]) in bodies.iter_mut().zip(boxes) {
        if body.count > 0.0 {
            body.by = body.by.map(|sum| sum / body.count);
            let edges = (0..3).map(|i| high[i] - low[i]);
            body.edge = edges.fold(f64::INFINITY, f64::min);
        }
    }
    bodies
}

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}
