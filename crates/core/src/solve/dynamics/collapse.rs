//! Collapse: a step changed to inertia because statics found no equilibrium, and bodies fall (docs/theory/inertia.md,
//! eq. 11).
//!
//! Displacements are measured from the last equilibrium. A body falls if its mean displacement since then exceeds its
//! smallest edge (of the box around it at rest) plus the largest displacement of a drive meanwhile, and if the
//! kinetic energy still exceeds [`QUIET`] times the energy that solids and joints have taken. A step that only loads
//! then ends: it seeks an equilibrium, and there is none. At held loads it ends earlier: when
//! [`SEVERAL`] bodies have moved by [`AT_END`] of their edges, and the kinetic energy grows and exceeds [`ACCELERATES`]
//! times the elastic one. So does a step whose load a displacement steers if this load
//! acts on a body that falls, or that has moved by [`AT_END`] of its edge while the kinetic energy grows and exceeds
//! the elastic energy: the body no longer resists the load. Otherwise a step that drives or steers continues
//! until falling bodies have more than half of the mass of all bodies without support, because stones may fall off a
//! wall that still carries load.
//! Procedures with inertia that the deck names are never ended, because their motion is the result.

use serde::{Deserialize, Serialize};

use crate::assembly::System;
use crate::assembly::dofs::HELD;
use crate::model::Model;
use crate::model::scene::{BeamMotion, Step};
use crate::solve::Recorder;
use crate::solve::stepping::run::Run;
use crate::solve::stepping::step_run::StepRun;
use crate::state::Method;
use crate::state::QUIET;
use crate::state::State;
use crate::state::is_moving;
use crate::state::{Fall, FallenBody, Status};

/// Part of the unsupported mass that must fall before a step that drives ends.
const MOST: f64 = 0.5;
/// Displacement over the smallest edge from which an accelerating body counts as fallen at the end of the run, or
/// under a steered load.
const AT_END: f64 = 0.1;
/// Kinetic energy over the elastic one from which bodies fall that accelerate at held loads.
const ACCELERATES: f64 = 0.2;
/// Number of bodies that are a mechanism then. Single ones may land again.
const SEVERAL: usize = 5;
/// Part of the largest displacement from which further bodies are named.
const NAMED: f64 = 0.5;

/// The last equilibrium before inertia took over.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(in crate::solve) struct LastEquilibrium {
    step: usize,
    load_factor: f64,
    /// Displacements at this equilibrium [mm]. `[slot]`
    q: Vec<f64>,
    /// Positions of the spring ends [mm]. `[spring][xyz]`
    spring_ends: Vec<[f64; 3]>,
    /// Whether the kinetic energy grew in the last increment.
    hastens: bool,
}

impl LastEquilibrium {
    /// Whether the equilibrium belongs to the model of a state.
    pub(in crate::solve) fn fits(&self, state: &State) -> bool {
        self.q.len() == state.q.len() && self.spring_ends.len() == state.spring_ends.len()
    }
}

/// Displacement of a body since the last equilibrium, with its size and mass.
struct Moved {
    /// Mean displacement [mm].
    by: [f64; 3],
    /// Smallest edge of the box around it at rest [mm].
    edge: f64,
    /// Number of its nodes.
    count: f64,
    /// Mass [tonne].
    mass: f64,
    /// Whether one of its nodes is held in all directions.
    held: bool,
    /// Whether a load that changes in the step acts on it.
    loaded: bool,
}

impl Moved {
    fn way(&self) -> f64 {
        length(self.by)
    }
}

impl Run<'_> {
    /// Notes the present equilibrium, from which inertia takes over at this part of the loads. Loads that statics carried
    /// before count on: a path beyond their peak leads to lower ones.
    pub(in crate::solve) fn depart(&mut self, step_run: &StepRun, load_factor: f64) {
        let sense = step_run.sense();
        let carried = if step_run.step.prescribes() {
            load_factor
        } else if let Some(load_factor) = step_run.branch.unstable_from {
            load_factor
        } else {
            sense * (sense * load_factor).max(step_run.branch.carried)
        };
        self.note_equilibrium(step_run.index, carried);
    }

    /// Notes the present equilibrium of a step, which carried this part of its loads.
    pub(in crate::solve) fn note_equilibrium(&mut self, step: usize, load_factor: f64) {
        self.last_equilibrium = Some(LastEquilibrium {
            step,
            load_factor,
            q: self.state.q.clone(),
            spring_ends: self.state.spring_ends.clone(),
            hastens: false,
        });
    }

    /// Whether the scene collapsed in the increment of the last commit; sets status and fall if so. `(before, carried,
    /// light)`: kinetic energy [N mm] and load factor at the start of the increment; whether a light body moves.
    pub(in crate::solve) fn collapses(
        &mut self,
        step_run: &StepRun,
        method: Method,
        (before, carried, light): (f64, f64, bool),
    ) -> bool {
        let seeks = step_run.step.procedure.seeks_equilibrium();
        if !seeks || method != Method::QuasiStatic {
            return false;
        }
        let energies = self.state.energies;
        let Some(last_equilibrium) = &mut self.last_equilibrium else {
            return false;
        };
        let hastens = energies.kinetic > before;
        // Under little more than its limit load a block gains speed, but never much energy beside its friction.
        let slides = step_run.held > 0 && hastens;
        let moves = light || slides || is_moving(energies.kinetic, before, energies.taken());
        if !step_run.step.prescribes() && !moves {
            // The loads grow at rest: the wall carried those at the start of the increment. At its end it may have begun to
            // slide. A fall begins slowly, with a kinetic energy that grows from increment to increment.
            if !hastens {
                self.depart(step_run, carried);
            }
            return false;
        }
        last_equilibrium.hastens = hastens;
        if energies.moving() <= QUIET && !slides && !light {
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
        let steered = step_run.step.control.is_some();
        let held = step_run.held > 0;
        let least = if held { ACCELERATES } else { 1.0 };
        let flies = hastens && energies.kinetic > least * energies.elastic;
        let part = if flies { AT_END } else { 1.0 };
        let gives_way = |body: &Moved| body.loaded && body.way() > part * body.edge + driven;
        let collapsed = if steered && bodies.iter().any(gives_way) {
            true
        } else if step_run.step.prescribes() {
            fallen > MOST * mass(&|body| !body.held)
        } else {
            let moved = bodies.iter().filter(|body| body.way() > AT_END * body.edge);
            let mechanism = held && flies && moved.count() >= SEVERAL;
            fallen > 0.0 || mechanism
        };
        if collapsed && steered && self.carried.runs_away() {
            self.summary.status = Status::NotConverged;
            self.summary.message = format!(
                "step {} ({}): inertia drives the load that a displacement steers beyond all bounds; smaller increments \
                 (increments.max) may find its equilibrium",
                step_run.index, step_run.step.name
            );
        } else if collapsed {
            self.summary.status = Status::Collapsed;
            let factor = step_run.load;
            self.summary.fall = self.fall((step_run.index, factor), &bodies, driven);
        }
        collapsed
    }

    /// Whether a body that no bond holds moves beside its own forces, in an increment of `auto` with inertia in a step
    /// that only loads. Beside parts under high pressure its energy is nothing.
    pub(in crate::solve) fn light_body_moves(&self, step_run: &StepRun, method: Method) -> bool {
        let step = step_run.step;
        let seeks = step.procedure.seeks_equilibrium() && step.only_loads();
        let (true, Method::QuasiStatic, Some(last)) = (seeks, method, &self.last_equilibrium)
        else {
            return false;
        };
        let newton = &step_run.newton;
        let loads = &newton.loading.loads.total;
        let at = (&self.system, &self.trial);
        (newton.scales.bodies).any_moves(at, &self.state, loads, &last.q)
    }

    /// Whether bodies gain speed under loads that stay when no further increment is found, as where elements are crushed
    /// to nothing; sets status and fall if so.
    pub(in crate::solve) fn falls_to_the_end(&mut self, step_run: &StepRun) -> bool {
        let energies = self.state.energies;
        let step = step_run.step;
        let hastens = self
            .last_equilibrium
            .as_ref()
            .is_some_and(|last| last.hastens);
        let flies = hastens && energies.kinetic > ACCELERATES * energies.elastic;
        if !flies || !step.procedure.seeks_equilibrium() || step.prescribes() {
            return false;
        }
        let Some((bodies, driven)) = self.moved(step_run.index) else {
            return false;
        };
        self.summary.status = Status::Collapsed;
        self.summary.fall = self.fall((step_run.index, step_run.load), &bodies, driven);
        true
    }

    /// Reports a collapse during the run.
    pub(in crate::solve) fn report_collapse(
        &mut self,
        step_run: &StepRun,
        recorder: &mut dyn Recorder,
    ) {
        if self.summary.status != Status::Collapsed {
            return; // the message tells it
        }
        let text = format!(
            "step {} ({}) ends at {}: no equilibrium is left, bodies fall",
            step_run.index,
            step_run.step.name,
            step_run.progress()
        );
        recorder.note(&text);
        self.summary.log.push(text);
    }

    /// Reports bodies that still fall or move at the end of the last step.
    pub(in crate::solve) fn report_moving_bodies(&mut self) {
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
        let prescribes = self.model.steps[last].prescribes();
        let part = if prescribes { 1.0 } else { AT_END };
        let falls = |body: &Moved| body.way() > part * body.edge + driven;
        let any = bodies.iter().any(falls);
        if prescribes && !any {
            return;
        }
        if !prescribes && any && last_equilibrium.hastens {
            self.summary.status = Status::Collapsed;
        }
        self.summary.fall = self.fall((last, 1.0), &bodies, driven);
    }

    /// Motion of the bodies since the last equilibrium `[unit]`, and the largest displacement of a drive meanwhile
    /// [mm]; none if inertia did not take over.
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
        let step = &self.model.steps[step];
        if let Some(control) = step.control {
            let probe = &self.model.probes[control.probe];
            let way = probe.gradient().map(|(n, axis, part)| part * u[n][axis]);
            driven = driven.max(way.sum::<f64>().abs());
        }
        Some((moved(self.model, &self.system, step, &u), driven))
    }

    /// Fall of the bodies with the largest displacements: at least half of the largest one, and that of the drive.
    /// `step`: its index, and the part of its loads that acts.
    fn fall(&self, step: (usize, f64), bodies: &[Moved], driven: f64) -> Option<Fall> {
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
            found_in: (step.0 != last_equilibrium.step)
                .then(|| format!("step {} ({})", step.0, self.model.steps[step.0].name)),
        })
    }

    /// Unit vector of the gravity at a part of the loads of a step; zero without gravity.
    fn down(&self, (step, part): (usize, f64)) -> [f64; 3] {
        let gravity = self.model.steps[step].gravity.at(part);
        let size = length(gravity);
        gravity.map(|g| if size > 0.0 { g / size } else { 0.0 })
    }
}

/// Whether a load that changes in the step acts on a node. `[node]`
fn loaded(model: &Model, step: &Step) -> Vec<bool> {
    let mut loaded = vec![false; model.mesh.nodes.len()];
    for (load, value) in model.loads.iter().zip(&step.loads) {
        if value.is_some() {
            for n in load.nodes() {
                loaded[n as usize] = true;
            }
        }
    }
    loaded
}

/// Mean displacement, size, mass and loads in the step of each body. `[unit]`
fn moved(model: &Model, system: &System, step: &Step, u: &[[f64; 3]]) -> Vec<Moved> {
    let mesh = &model.mesh;
    let loaded = loaded(model, step);
    let units = mesh.unit.iter().max().map_or(0, |unit| *unit as usize + 1);
    let mut bodies: Vec<Moved> = (0..units)
        .map(|_| Moved {
            by: [0.0; 3],
            edge: 0.0,
            count: 0.0,
            mass: 0.0,
            held: false,
            loaded: false,
        })
        .collect();
    // Bodies share no nodes.
    let mut seen = vec![false; mesh.nodes.len()];
    for (nodes, unit) in mesh.elements.iter().zip(&mesh.unit) {
        let body = &mut bodies[*unit as usize];
        for n in nodes.map(|n| n as usize) {
            if std::mem::replace(&mut seen[n], true) {
                continue;
            }
            body.count += 1.0;
            body.mass += system.mass.node[n];
            body.held |= system.dofs.slot[n] == [HELD; 3];
            body.loaded |= loaded[n];
            for i in 0..3 {
                body.by[i] += u[n][i];
            }
        }
    }
    for (body, edge) in bodies.iter_mut().zip(mesh.smallest_edges()) {
        if body.count > 0.0 {
            body.by = body.by.map(|sum| sum / body.count);
            body.edge = edge;
        }
    }
    bodies
}

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}
