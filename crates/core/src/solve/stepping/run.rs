//! A run: its steps, increments and commits.

use std::cell::OnceCell;

use super::counts::{Carried, MotionWarnings, Snaps};
use super::energy_watch::EnergyWatch;
use super::fallback::Fallback;
use super::step_run::StepRun;
use super::stop::Watch;
use crate::assembly::bulk::BulkError;
use crate::assembly::{Steered, System, Trial};
use crate::model::Model;
use crate::model::scene::{Procedure, Step, Tangent};
use crate::model::sizes::Sizes;
use crate::solve::Recorder;
use crate::solve::dynamics::collapse::LastEquilibrium;
use crate::solve::fidelity::{Part, Reached, Reduction};
use crate::solve::increment::newton::Newton;
use crate::solve::increment::outcome::{Attempt, Outcome, Problem, Solves};
use crate::solve::restart::checkpoint::CheckpointError;
use crate::solve::restart::fingerprint::Fingerprint;
use crate::state::Clock;
use crate::state::QUIET;
use crate::state::State;
use crate::state::{Status, Summary};

/// Error of a run that could not start or could not be recorded.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// An element or a material cannot be prepared.
    #[error(transparent)]
    Bulk(#[from] BulkError),
    /// Results could not be written.
    #[error("results could not be written: {0}")]
    Output(#[from] std::io::Error),
    /// A checkpoint does not fit the model.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// A joint law gives a traction or a history that is not finite.
    #[error(
        "the joint law {law} gives a traction or a history that is not finite at contact point {point}, \
         for the opening {} and the slip {}, {} mm: check the law there, and that its parameters are finite",
        gap[0], gap[1], gap[2]
    )]
    JointLaw {
        /// Name of the law.
        law: &'static str,
        /// Index of the contact point.
        point: usize,
        /// Opening and slip at the last commit [mm].
        gap: [f64; 3],
    },
    /// The deck asks for a limit analysis.
    #[error("strategy = \"limit\" is a limit analysis, which has no steps: see limit::analyse")]
    LimitOnly,
    /// A step with inertia has parts without mass.
    #[error(
        "step {step} ({name}) has inertia and {place} has no mass: give every material a density"
    )]
    NoMass {
        /// Index of the step.
        step: usize,
        /// Its name in the deck.
        name: String,
        /// Place without mass.
        place: String,
    },
}

/// Factor of a rejected increment (docs/theory/procedures.md, eq. 13).
pub(in crate::solve) const CUT: f64 = 0.4;

/// Runs a model from rest through all its steps.
///
/// # Errors
/// [`RunError`]. Lost convergence is not an error but a [`Status`]; all results before it are kept.
pub fn run(model: &Model, recorder: &mut dyn Recorder) -> Result<Summary, RunError> {
    run_part(model, &Part::default(), recorder).map(Summary::in_words)
}

/// Runs a model from rest of which a part was solved that lost its symmetry ([`Summary::lost_symmetry`]). Its fidelity
/// is to be full.
///
/// # Errors
/// [`RunError`].
pub fn run_whole(model: &Model, recorder: &mut dyn Recorder) -> Result<Summary, RunError> {
    const TOLD: &str = "the part that was solved has lost its symmetry: all of the scene is solved, from its first step";
    recorder.note(TOLD);
    let mut summary = run(model, recorder)?;
    summary.log.insert(0, TOLD.to_owned());
    Ok(summary)
}

/// Runs a model that is the given part of the scene shown.
fn run_part(model: &Model, part: &Part, recorder: &mut dyn Recorder) -> Result<Summary, RunError> {
    if let Some(instead) = Reduction::of(model) {
        return instead.show(model, part, recorder, Reached::default(), run_part);
    }
    if let Some(told) = part.told() {
        recorder.note(&told);
    }
    // Work on a thread of the pool. From outside it, each of the hundreds of small parallel tasks of an iteration
    // would put this thread to sleep and wake it again.
    rayon::scope(|_| Run::new(model, part)?.finish(None, recorder))
}

/// A run in progress.
pub(in crate::solve) struct Run<'m> {
    pub(in crate::solve) model: &'m Model,
    pub(in crate::solve) part: Part,
    pub(in crate::solve) system: System,
    pub(in crate::solve) state: State,
    pub(in crate::solve) trial: Trial,
    pub(in crate::solve) summary: Summary,
    pub(in crate::solve) clock: Clock,
    pub(in crate::solve) output_seconds: f64,
    pub(in crate::solve) snaps: Snaps,
    pub(in crate::solve) swings: MotionWarnings,
    pub(in crate::solve) carried: Carried,
    pub(in crate::solve) energy_watch: EnergyWatch,
    /// The last equilibrium, while inertia acts in place of statics.
    pub(in crate::solve) last_equilibrium: Option<LastEquilibrium>,
    /// Fingerprint of the model, computed for the first checkpoint.
    pub(in crate::solve) fingerprint: OnceCell<Fingerprint>,
}

impl<'m> Run<'m> {
    pub(in crate::solve) fn new(model: &'m Model, part: &Part) -> Result<Self, RunError> {
        if model.limit_only {
            return Err(RunError::LimitOnly);
        }
        let numbered = |why: BulkError| why.with_number(|e| part.element(e));
        let mut system = System::new(model).map_err(numbered)?;
        let state = system.initial_state(model);
        let units = model.mesh.unit.iter().max().map_or(0, |u| *u as usize + 1);
        let sizes = Sizes {
            units,
            elements: model.mesh.elements.len(),
            nodes: model.mesh.nodes.len(),
            dofs: 0,
            contact_points: system.contact.points.len(),
        };
        // Warnings of the model were reported when it was built.
        let mut summary = Summary::begun(sizes, rayon::current_num_threads());
        summary.mirror_planes.clone_from(&part.planes);
        summary.log.extend(part.told());
        let (clock, trial) = (Clock::default(), Trial::default());
        Ok(Self {
            model,
            part: part.clone(),
            system,
            state,
            trial,
            summary,
            clock,
            output_seconds: 0.0,
            snaps: Snaps::default(),
            swings: MotionWarnings::default(),
            carried: Carried::default(),
            energy_watch: EnergyWatch::default(),
            last_equilibrium: None,
            fingerprint: OnceCell::new(),
        })
    }

    /// Runs all steps, or the rest of a step in progress and the steps after it.
    pub(in crate::solve) fn finish(
        mut self,
        step_run: Option<StepRun<'m>>,
        recorder: &mut dyn Recorder,
    ) -> Result<Summary, RunError> {
        // A collapsed status means that an earlier run was killed between its collapse and its summary.
        let (mut next, mut go_on) = (0, self.summary.status != Status::Collapsed);
        if let (Some(step_run), true) = (step_run, go_on) {
            next = step_run.index + 1;
            go_on = self.walk(step_run, recorder)?;
        }
        while go_on && next < self.model.steps.len() {
            let step_run = self.begin(next)?;
            next += 1;
            go_on = self.walk(step_run, recorder)?;
        }
        self.report_moving_bodies();
        self.summary.warnings.extend(self.snaps.warning());
        self.summary.warnings.extend(self.snaps.loosened_warning());
        self.summary.warnings.extend(self.swings.warning());
        self.summary.warnings.extend(self.swings.time_warning());
        let whole = self.part.wholes();
        self.summary.warnings.extend(self.carried.warning(whole));
        self.summary.warnings.extend(self.carried.viscous_warning());
        self.summary.warnings.extend(self.energy_watch.warning());
        self.summary
            .warnings
            .extend(self.energy_watch.made_warning());
        self.summary.warnings.extend(self.narrowed_bands());
        self.summary.warnings.extend(self.entered_bodies());
        Ok(self.summary)
    }

    /// Runs a step to its end; false if the run ends there.
    fn walk(
        &mut self,
        mut step_run: StepRun<'m>,
        recorder: &mut dyn Recorder,
    ) -> Result<bool, RunError> {
        while let Some(request) = step_run.next() {
            let (before, time) = (step_run.attempts.solves, self.state.time);
            let index = step_run.index;
            let part = step_run.part(&request);
            let mut tell = |count| recorder.progress(index, time, before + count);
            let outcome = step_run.newton.converge(&mut Problem {
                system: &mut self.system,
                state: &self.state,
                trial: &mut self.trial,
                attempt: Attempt {
                    increment: request.increment,
                    load: step_run.load,
                    load_end: step_run.branch.of.factor(request.increment.end()),
                    repeat: step_run.repeat,
                    advance: request.advance(
                        &step_run.path.measure,
                        step_run.path.control.as_ref(),
                        part,
                    ),
                },
                solves: Solves::new(&mut tell),
            });
            let go_on = match outcome {
                Outcome::Converged(report)
                    if self.try_as_shock(&mut step_run, request)
                        || self.loosens_bound(&mut step_run, request, report)
                        || self.repeat_for_peak(&mut step_run, request, report) =>
                {
                    step_run.attempts.solves += report.iterations;
                    self.cut_back(&mut step_run);
                    true
                }
                Outcome::Converged(report) => {
                    let rejection = self.jump(&step_run, request);
                    let crosses = rejection.is_none() && self.jumps_over(&mut step_run, request);
                    if rejection.is_some() || crosses {
                        step_run.attempts.solves += report.iterations;
                        self.cut_back(&mut step_run);
                    }
                    match rejection {
                        Some(rejection) => {
                            self.relax_or_reject(&mut step_run, request, &rejection, recorder)?
                        }
                        None if crosses => self.cross_snap(&mut step_run, request, recorder)?,
                        None => self.accept(&mut step_run, request, report, recorder)?,
                    }
                }
                Outcome::Rejected(rejection, spent) => {
                    step_run.attempts.solves += spent;
                    self.cut_back(&mut step_run);
                    self.relax_or_reject(&mut step_run, request, &rejection, recorder)?
                }
            };
            if !go_on {
                return Ok(false);
            }
        }
        self.clock = self.clock + step_run.newton.clock;
        self.warn_of_instability(&step_run);
        Ok(self.keeps_symmetry(&step_run, recorder))
    }

    /// Prepares a step.
    fn begin(&mut self, index: usize) -> Result<StepRun<'m>, RunError> {
        let model = self.model;
        let step = &model.steps[index];
        self.system.steered = steered(model, step);
        let newton = Newton::new(model, step, &self.system, &self.state);
        self.summary.sizes.dofs = self.summary.sizes.dofs.max(newton.unknowns());
        self.system.bulk.stabilise(step.viscosity, f64::INFINITY);
        let massless = self.massless(step);
        if let (true, Some(place)) = (step.procedure.has_inertia(), &massless) {
            return Err(RunError::NoMass {
                step: index,
                name: step.name.clone(),
                place: place.clone(),
            });
        }
        let mut fallback = Fallback::new(model, step, massless.is_none());
        if self.state.energies.moving() > QUIET {
            // Bodies that `auto` set in motion continue to move.
            fallback.start_moving();
            if self.last_equilibrium.is_none() {
                self.note_equilibrium(index, 0.0);
            }
        }
        let mut step_run = StepRun::new(newton, fallback, index, step);
        step_run.steer(model, &self.system);
        let [displacement, force] = self.watched(index);
        step_run.watch = Watch::new(&model.steps, step, displacement, self.part.wholes());
        step_run.see(force);
        if step.procedure.has_inertia() {
            self.set_in_motion(index);
        } else if !step_run.fallback.method().has_inertia() {
            self.bring_to_rest();
        }
        self.adopt(&mut step_run);
        // The boundary conditions change, so the last increment does not predict the next.
        (self.state.last, self.state.moved) = (None, None);
        self.state.wants_double = false;
        Ok(step_run)
    }

    /// Sets the method and tangents of the fallback.
    pub(in crate::solve) fn adopt(&mut self, step_run: &mut StepRun) {
        let choice = step_run.fallback.choice();
        step_run
            .newton
            .adopt(choice, &mut self.system, &mut self.state, &mut self.trial);
    }

    /// Continues along the next branch of the amplitude.
    pub(super) fn turn(&mut self, step_run: &mut StepRun<'m>) {
        let before = step_run.branch.of.slope();
        self.state.moved = None;
        step_run.branch.index += 1;
        step_run.branch.of = step_run.step.branch(step_run.branch.index);
        step_run.schedule.turn(step_run.branch.of);
        let slope = step_run.branch.of.slope();
        step_run
            .newton
            .turn(slope, &mut self.system, &mut self.state, &mut self.trial);
        if before * slope > 0.0 {
            // The direction stays and the rate changes.
            if let Some(last) = &mut self.state.last {
                last.dt *= before / slope;
            }
            return;
        }
        step_run.branch.carried = f64::NEG_INFINITY;
        step_run.branch.unstable_from = None;
        // Where loads reverse, the last increment does not predict the next.
        self.state.last = None;
        step_run.path.measure.forget();
        step_run.peak.forget();
        step_run.see(self.watched(step_run.index)[1]);
        step_run.schedule.begin_small();
        step_run.snap.beyond = None;
        if step_run.fallback.turn() {
            self.adopt(step_run);
        }
    }

    /// Reports a change of method.
    pub(in crate::solve) fn note(
        &mut self,
        step_run: &StepRun,
        why: &str,
        recorder: &mut dyn Recorder,
    ) {
        let text = format!(
            "step {} ({}), {}: {why}; continues with {}",
            step_run.index,
            step_run.step.name,
            step_run.progress(),
            step_run.fallback.method().name()
        );
        recorder.note(&text);
        self.summary.log.push(text);
    }

    /// Ends a step early by its `stop` table.
    pub(super) fn stop(&mut self, step_run: &mut StepRun, why: &str, recorder: &mut dyn Recorder) {
        step_run.stopped = true;
        let text = format!(
            "step {} ({}) ends at {}: {why}",
            step_run.index,
            step_run.step.name,
            step_run.progress()
        );
        recorder.note(&text);
        self.summary.log.push(text);
    }

    /// Enters counts and wall times so far into the summary.
    pub(in crate::solve) fn tally(&mut self, newton: &Newton) {
        let c = self.clock + newton.clock;
        self.summary.factorisations = c.factorisations;
        self.summary.reused = c.reused;
        self.summary.local_solves = c.local_solves;
        self.summary.evaluations = c.evaluations;
        self.summary.seconds_by_phase = [
            c.elements,
            c.contact,
            c.assembly,
            c.factorise,
            c.solve,
            self.output_seconds,
        ];
    }
}

/// Stiffness along the displacement that steers the load of a step, for secant tangents (docs/theory/procedures.md,
/// eq. 6).
pub(in crate::solve) fn steered(model: &Model, step: &Step) -> Option<Steered> {
    let controls = step.procedure == Procedure::DisplacementControl;
    let control = step
        .control
        .filter(|_| controls && step.tangent == Tangent::Secant)?;
    Steered::new(model, control)
}
