//! The run: steps, increments, commits.

use std::time::Instant;

use wythe_contact::{InterfaceHistory, PointStatus};

use super::explain::explain;
use super::newton::{IMBALANCE, Newton};
use super::outcome::{Attempt, Clock, Outcome, Refusal, Report, Solves};
use super::probes::probes;
use super::schedule::{Increment, Schedule};
use super::state::{LastIncrement, State};
use super::tally::{Snaps, Swings};
use crate::model::Model;
use crate::model::scene::{BeamMotion, Dynamics, Procedure, Step};
use crate::results::{Frame, HistoryRow, Recorder, Sizes, Status, Summary};
use crate::system::bulk::BulkError;
use crate::system::{System, Trial};

/// A run that could not begin, or could not be recorded.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// An element or a material does not work.
    #[error(transparent)]
    Bulk(#[from] BulkError),
    /// Results could not be written.
    #[error("results could not be written: {0}")]
    Output(#[from] std::io::Error),
    /// Inertia without mass.
    #[error(
        "step {step} ({name}) has inertia and {place} has no mass: give every material a density"
    )]
    NoMass {
        /// Step.
        step: usize,
        /// Its name in the deck.
        name: String,
        /// What has none.
        place: String,
    },
}

/// Factor of a refused increment (lessons: 0.4).
const CUT: f64 = 0.4;
/// Largest growth of an increment.
const GROW: f64 = 1.5;
/// Solves above which an increment does not grow.
const MANY: usize = 10;

/// Runs a model from rest through all its steps.
///
/// # Errors
/// [`RunError`]. Lost convergence is no error but a [`Status`] with everything before it kept.
pub fn run(model: &Model, recorder: &mut dyn Recorder) -> Result<Summary, RunError> {
    // On a thread of the pool: from outside it each of the hundreds of small parallel pieces of an
    // iteration would put this thread to sleep and wake it again.
    rayon::scope(|_| {
        let mut run = Run::new(model)?;
        for step in 0..model.steps.len() {
            if !run.step(step, recorder)? {
                break;
            }
        }
        run.summary.warnings.extend(run.snaps.warning());
        run.summary.warnings.extend(run.swings.warning());
        Ok(run.summary)
    })
}

/// A run in progress.
struct Run<'m> {
    model: &'m Model,
    system: System,
    state: State,
    trial: Trial,
    summary: Summary,
    clock: Clock,
    output_seconds: f64,
    snaps: Snaps,
    swings: Swings,
}

impl<'m> Run<'m> {
    fn new(model: &'m Model) -> Result<Self, RunError> {
        let mut system = System::new(model)?;
        let state = system.initial_state(model);
        let units = model.mesh.unit.iter().max().map_or(0, |u| *u as usize + 1);
        let sizes = Sizes {
            units,
            elements: model.mesh.elements.len(),
            nodes: model.mesh.nodes.len(),
            dofs: 0,
            contact_points: system.contact.points.len(),
        };
        let summary = Summary {
            status: Status::Completed,
            message: String::new(),
            sizes,
            increments: 0,
            iterations: 0,
            cutbacks: 0,
            seconds_by_phase: [0.0; 6],
            threads: rayon::current_num_threads(),
            // Those of the model were told when it was built.
            warnings: Vec::new(),
        };
        let (clock, trial) = (Clock::default(), Trial::default());
        Ok(Self {
            model,
            system,
            state,
            trial,
            summary,
            clock,
            output_seconds: 0.0,
            snaps: Snaps::default(),
            swings: Swings::default(),
        })
    }

    /// One step; false if the run ends here.
    fn step(&mut self, index: usize, recorder: &mut dyn Recorder) -> Result<bool, RunError> {
        let model = self.model;
        let step = &model.steps[index];
        self.set_in_motion(index)?;
        let mut newton = Newton::new(
            model,
            step,
            &mut self.system,
            &mut self.state,
            &mut self.trial,
        );
        self.summary.sizes.dofs = self.summary.sizes.dofs.max(newton.unknowns());
        self.system.bulk.stabilise(step.viscosity);
        let mut schedule = Schedule::new(step.increments);
        // The boundary conditions change: the last increment says nothing of the next.
        self.state.last = None;
        let (mut cutbacks, mut repeat, mut solves) = (0, true, 0);
        let floor = SNAP * step.increments.initial;
        // A unit snaps: the secant stiffness finds no equilibrium in any increment, extrapolated
        // solids do.
        let mut snap = false;
        while let Some(increment) = schedule.next() {
            let (before, time) = (solves, self.state.time);
            let mut tell = |count| recorder.progress(index, time, before + count);
            let outcome = newton.converge(
                &mut self.system,
                &self.state,
                &mut self.trial,
                Attempt {
                    increment,
                    repeat,
                    extrapolate: snap || step.procedure == Procedure::Implex,
                },
                Solves::new(&mut tell),
            );
            match outcome {
                Outcome::Converged(report)
                    if self.is_impact(step)
                        && increment.size > floor
                        && schedule.cut(increment, CUT).is_ok() =>
                {
                    solves += report.iterations;
                    cutbacks += 1;
                    self.summary.cutbacks += 1;
                    repeat = false;
                }
                Outcome::Converged(report) => {
                    solves += report.iterations;
                    self.commit(&newton, step, increment);
                    let row = self.row(index, report, solves, cutbacks);
                    if step.dynamics == Dynamics::QuasiStatic {
                        self.swings.add(&row);
                    }
                    if snap {
                        self.snaps.add(&row);
                        snap = report.extrapolation_error > IMBALANCE;
                    }
                    let end = increment.end() >= 1.0 - 1e-12;
                    let keep = self.record(&row, recorder, end)?;
                    self.summary.increments += 1;
                    self.summary.iterations += solves;
                    self.tally(&newton);
                    if !keep {
                        self.summary.status = Status::Interrupted;
                        "stopped by the user".clone_into(&mut self.summary.message);
                        return Ok(false);
                    }
                    schedule.accept(increment, growth(increment, report, floor));
                    (cutbacks, repeat, solves) = (0, true, 0);
                }
                Outcome::Refused(refusal, spent) => {
                    solves += spent;
                    cutbacks += 1;
                    self.summary.cutbacks += 1;
                    repeat = false;
                    if step.procedure == Procedure::Secant && !snap && increment.size <= floor {
                        snap = true;
                        continue;
                    }
                    if schedule.cut(increment, CUT).is_err() {
                        self.summary.iterations += solves;
                        self.tally(&newton);
                        self.give_up(index, increment, &refusal);
                        return Ok(false);
                    }
                }
            }
        }
        self.clock = self.clock + newton.clock;
        Ok(true)
    }

    /// Whether bodies met or parted in the increment that the trial ends, where that matters: a shock
    /// is resolved by small increments.
    fn is_impact(&self, step: &Step) -> bool {
        if !matches!(step.dynamics, Dynamics::Dynamic { .. }) {
            return false;
        }
        let presses = |history: &InterfaceHistory| history.traction[0] < 0.0;
        let (mut before, mut after, mut changed) = (0, 0, 0);
        for (old, new) in self.state.interface.iter().zip(&self.trial.interface) {
            let (old, new) = (presses(old), presses(new));
            before += usize::from(old);
            after += usize::from(new);
            changed += usize::from(old != new);
        }
        changed as f64 > IMPACT * before.max(after) as f64
    }

    /// Velocities that the step finds: those of the model in the first step with inertia; none where
    /// inertia does not act.
    fn set_in_motion(&mut self, index: usize) -> Result<(), RunError> {
        let (model, system, state) = (self.model, &self.system, &mut self.state);
        let step = &model.steps[index];
        let energies = &mut state.energies;
        if !step.dynamics.has_inertia() {
            // Statics brings to rest what moved.
            energies.numerical += std::mem::take(&mut energies.kinetic);
            for rates in [
                &mut state.velocity,
                &mut state.acceleration,
                &mut state.damping,
            ] {
                rates.fill(0.0);
            }
            return Ok(());
        }
        let free_beams = step.motion.iter().enumerate().flat_map(|(b, motion)| {
            let free = |i: &usize| matches!(motion[*i], BeamMotion::Force(_));
            (0..3).filter(free).map(move |i| (b, i))
        });
        let mut unknowns =
            (0..system.dofs.beam_start).chain(free_beams.map(|(b, i)| system.dofs.beam_slot(b, i)));
        if let Some(slot) = unknowns.find(|&slot| system.mass.slot[slot] <= 0.0) {
            let place = if slot >= system.dofs.beam_start {
                let beam = (slot - system.dofs.beam_start) / 3;
                format!("the beam {}", model.beams[beam].name)
            } else {
                format!("node {}", system.dofs.node_of(slot).0)
            };
            let name = step.name.clone();
            return Err(RunError::NoMass {
                step: index,
                name,
                place,
            });
        }
        let first = model.steps.iter().position(|s| s.dynamics.has_inertia());
        if first == Some(index) && !model.initial_velocity.is_empty() {
            system
                .mass
                .mean_velocity(&system.dofs, &model.initial_velocity, &mut state.velocity);
            energies.kinetic = system.mass.kinetic_energy(&state.velocity);
            energies.external += energies.kinetic;
        }
        Ok(())
    }

    /// The trial becomes the state.
    fn commit(&mut self, newton: &Newton, step: &Step, increment: Increment) {
        let (state, trial) = (&mut self.state, &mut self.trial);
        let dq: Vec<f64> = newton
            .q()
            .iter()
            .zip(&state.q)
            .map(|(new, old)| new - old)
            .collect();
        let dtraction = trial
            .interface
            .iter()
            .zip(&state.interface)
            .map(|(new, old)| [0, 1, 2].map(|i| new.traction[i] - old.traction[i]))
            .collect();
        newton.account(&self.system, state, trial, &dq);
        let energies = &mut state.energies;
        energies.elastic = trial.element_energy.iter().map(|e| e.elastic).sum::<f64>()
            + trial.point_energy.iter().map(|e| e[0]).sum::<f64>()
            + self
                .system
                .springs
                .energy(state.spring_forces.iter().copied());
        energies.plastic_damage += trial
            .element_energy
            .iter()
            .map(|e| e.plastic_damage)
            .sum::<f64>();
        energies.viscous += trial.element_energy.iter().map(|e| e.viscous).sum::<f64>();
        energies.interface += trial.point_energy.iter().map(|e| e[1]).sum::<f64>();
        let dt = increment.size * step.duration;
        state.time += dt;
        state.increments += 1;
        state.q.copy_from_slice(newton.q());
        state.force.copy_from_slice(&trial.force);
        state.material.copy_from_slice(&trial.material);
        state.interface.copy_from_slice(&trial.interface);
        state.pairs.copy_from_slice(&trial.pairs);
        state.largest_mean_force = state.largest_mean_force.max(trial.mean_nodal_force);
        state.last = Some(LastIncrement { dq, dtraction, dt });
    }

    /// The row of the last commit.
    fn row(&self, step: usize, report: Report, solves: usize, cutbacks: usize) -> HistoryRow {
        let (state, trial, dofs) = (&self.state, &self.trial, &self.system.dofs);
        let driven = self.model.steps[step]
            .driven
            .or_else(|| self.model.steps.iter().find_map(|s| s.driven));
        let (displacement, force, reaction) = match driven {
            Some((beam, direction)) => {
                let slot = dofs.beam_slot(beam, direction);
                let normal = self.model.beams[beam].normal;
                let along: f64 = (0..3)
                    .map(|i| normal[i] * state.applied[dofs.beam_slot(beam, i)])
                    .sum();
                (state.q[slot], state.applied[slot], -along)
            }
            None => (0.0, 0.0, 0.0),
        };
        let count = |status: PointStatus| trial.status.iter().filter(|s| **s == status).count();
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
            cutbacks,
            external_work_J: e.external * 1e-3,
            elastic_energy_J: e.elastic * 1e-3,
            plastic_damage_dissipation_J: e.plastic_damage * 1e-3,
            interface_dissipation_J: e.interface * 1e-3,
            viscous_dissipation_J: e.viscous * 1e-3,
            open_points: count(PointStatus::Open),
            sliding_points: count(PointStatus::Slip),
            max_interface_damage: most(&mut state.interface.iter().map(|h| h.damage)),
            max_tensile_damage: most(&mut state.material.iter().map(|h| h.tensile_damage)),
            max_compressive_damage: most(&mut state.material.iter().map(|h| h.compressive_damage)),
            out_of_balance: report.out_of_balance,
            residual: report.residual,
            kinetic_energy_J: e.kinetic * 1e-3,
            damping_dissipation_J: e.damping * 1e-3,
            numerical_dissipation_J: e.numerical * 1e-3,
            contact_area_mm2: self.system.contact.pressed_area(&state.interface),
            probes: probes(self.model, dofs, state),
        }
    }

    /// Hands the commit to the recorder; false asks to stop.
    fn record(
        &mut self,
        row: &HistoryRow,
        recorder: &mut dyn Recorder,
        last: bool,
    ) -> Result<bool, RunError> {
        let start = Instant::now();
        let every = self.model.output.every.max(1);
        let frame = (last || row.increment.is_multiple_of(every)).then(|| self.frame());
        recorder.observe(&self.state);
        let keep = recorder.take(self.model, row, frame.as_ref())?;
        self.output_seconds += start.elapsed().as_secs_f64();
        Ok(keep)
    }

    /// Fields of the last commit.
    fn frame(&self) -> Frame {
        let (state, mesh) = (&self.state, &self.model.mesh);
        let mut displacement = vec![[0.0; 3]; mesh.nodes.len()];
        self.system.dofs.spread(&state.q, &mut displacement);
        let mut frame = Frame {
            time: state.time,
            displacement,
            probes: probes(self.model, &self.system.dofs, state),
            ..Frame::default()
        };
        for points in state.material.chunks_exact(8) {
            let mean = |of: fn(&crate::material::MaterialHistory) -> nalgebra::Vector6<f64>| {
                let sum: nalgebra::Vector6<f64> = points.iter().map(of).sum();
                (sum / 8.0).into()
            };
            frame.stress.push(mean(|h| h.stress));
            frame.plastic_strain.push(mean(|h| h.plastic_strain));
            frame
                .tensile_damage
                .push(points.iter().map(|h| h.tensile_damage).fold(0.0, f64::max));
            frame.compressive_damage.push(
                points
                    .iter()
                    .map(|h| h.compressive_damage)
                    .fold(0.0, f64::max),
            );
        }
        frame
    }

    /// Wall time so far.
    fn tally(&mut self, newton: &Newton) {
        let c = self.clock + newton.clock;
        self.summary.seconds_by_phase = [
            c.elements,
            c.contact,
            c.assembly,
            c.factorise,
            c.solve,
            self.output_seconds,
        ];
    }

    fn give_up(&mut self, step: usize, increment: Increment, refusal: &Refusal) {
        self.summary.status = Status::NotConverged;
        self.summary.message = explain(self.model, step, increment, refusal);
    }
}

/// How much larger the next increment may be; extrapolated solids are not pursued below `floor`.
fn growth(increment: Increment, report: Report, floor: f64) -> f64 {
    let by_iterations = if report.iterations > 2 * MANY {
        0.7
    } else if report.iterations > MANY {
        1.0
    } else {
        GROW
    };
    // The extrapolation leaves an imbalance of first order in the increment.
    let by_error = (IMBALANCE / report.extrapolation_error.max(f64::MIN_POSITIVE))
        .sqrt()
        .clamp(0.3, GROW);
    // Where a unit snaps no increment is small enough: there the error is reported, not pursued.
    by_iterations.min(by_error.max((floor / increment.size).min(1.0)))
}

/// Part of the first increment that the snap of a unit, or an impact, does not cut further.
const SNAP: f64 = 0.1;
/// Part of the pressed contact points that begin or cease to press in an impact.
const IMPACT: f64 = 0.2;
