//! The run: steps, increments, commits.

use std::cell::OnceCell;

use super::checkpoint::CheckpointError;
use super::course::{Course, Leg};
use super::explain;
use super::fidelity::{Instead, Part, Reached, leans};
use super::fingerprint::Fingerprint;
use super::judge::{growth, resolving};
use super::ladder::{Answer, Ladder, QUIET};
use super::method::Method;
use super::newton::Newton;
use super::outcome::{Attempt, Clock, Outcome, Refusal, Report, Solves};
use super::state::State;
use super::stop::Watch;
use super::tally::{Snaps, Swings};
use crate::model::Model;
use crate::model::scene::{BeamMotion, Procedure, Step, Tangent};
use crate::results::{Recorder, Sizes, Status, Summary};
use crate::system::bulk::BulkError;
use crate::system::{Steered, System, Trial};

/// A run that could not begin, or could not be recorded.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// An element or a material does not work.
    #[error(transparent)]
    Bulk(#[from] BulkError),
    /// Results could not be written.
    #[error("results could not be written: {0}")]
    Output(#[from] std::io::Error),
    /// A checkpoint that the model cannot go on from.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
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
pub(super) const CUT: f64 = 0.4;
/// Runs a model from rest through all its steps.
///
/// # Errors
/// [`RunError`]. Lost convergence is no error but a [`Status`] with everything before it kept.
pub fn run(model: &Model, recorder: &mut dyn Recorder) -> Result<Summary, RunError> {
    run_part(model, &Part::default(), recorder)
}

/// Runs a model that is this part of what is shown.
fn run_part(model: &Model, part: &Part, recorder: &mut dyn Recorder) -> Result<Summary, RunError> {
    if let Some(instead) = Instead::of(model) {
        return instead.show(model, part, recorder, Reached::default(), run_part);
    }
    if let Some(told) = part.told() {
        recorder.note(&told);
    }
    // On a thread of the pool: from outside it each of the hundreds of small parallel pieces of an
    // iteration would put this thread to sleep and wake it again.
    rayon::scope(|_| Run::new(model, part)?.finish(None, recorder))
}

/// A run in progress.
pub(super) struct Run<'m> {
    pub(super) model: &'m Model,
    part: Part,
    pub(super) system: System,
    pub(super) state: State,
    pub(super) trial: Trial,
    pub(super) summary: Summary,
    pub(super) clock: Clock,
    pub(super) output_seconds: f64,
    pub(super) snaps: Snaps,
    pub(super) swings: Swings,
    /// Of the model, when the first checkpoint wants it.
    pub(super) fingerprint: OnceCell<Fingerprint>,
}

impl<'m> Run<'m> {
    pub(super) fn new(model: &'m Model, part: &Part) -> Result<Self, RunError> {
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
        // Warnings of the model were told when it was built.
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
            swings: Swings::default(),
            fingerprint: OnceCell::new(),
        })
    }

    /// All steps, or the rest of one in progress and those after it.
    pub(super) fn finish(
        mut self,
        course: Option<Course<'m>>,
        recorder: &mut dyn Recorder,
    ) -> Result<Summary, RunError> {
        let (mut next, mut go_on) = (0, true);
        if let Some(course) = course {
            next = course.index + 1;
            go_on = self.walk(course, recorder)?;
        }
        while go_on && next < self.model.steps.len() {
            let course = self.begin(next)?;
            next += 1;
            go_on = self.walk(course, recorder)?;
        }
        self.summary.warnings.extend(self.snaps.warning());
        self.summary.warnings.extend(self.swings.warning());
        Ok(self.summary)
    }

    /// Whether a part of the scene would stay in its planes as the whole, where a step ends or its loads turn round; what
    /// moves is not asked, nor what lies where it fell: whether that stands or is loose its stiffness at rest does not tell. If not, the run ends here: what it has found is not what the whole does.
    fn keeps_symmetry(&mut self, course: &Course, recorder: &mut dyn Recorder) -> bool {
        let step = course.index;
        let moves = course.step.procedure.has_inertia() || course.ladder.method().has_inertia();
        if moves || self.state.fell || self.state.energies.moving() > QUIET {
            return true;
        }
        let (model, state) = (self.model, &self.state);
        let (system, trial) = (&mut self.system, &mut self.trial);
        let Some(planes) = leans(model, &self.part, step, system, state, trial) else {
            return true;
        };
        self.summary.status = Status::NotConverged;
        self.summary.message = self.part.told_to_lean(&planes, &model.steps[step].name);
        recorder.note(&self.summary.message);
        false
    }

    /// A step to its end; false if the run ends here.
    fn walk(
        &mut self,
        mut course: Course<'m>,
        recorder: &mut dyn Recorder,
    ) -> Result<bool, RunError> {
        while let Some(leg) = course.next() {
            let (before, time) = (course.solves, self.state.time);
            let index = course.index;
            let part = course.part(&leg);
            let mut tell = |count| recorder.progress(index, time, before + count);
            let outcome = course.newton.converge(
                &mut self.system,
                &self.state,
                &mut self.trial,
                Attempt {
                    increment: leg.increment,
                    load: course.load,
                    load_end: course.branch.factor(leg.increment.end()),
                    repeat: course.repeat,
                    advance: leg.advance(&course.trail, course.control.as_ref(), part),
                },
                Solves::new(&mut tell),
            );
            let go_on = match outcome {
                Outcome::Converged(report) if self.try_as_shock(&mut course, leg) => {
                    course.solves += report.iterations;
                    self.cut_back(&mut course);
                    true
                }
                Outcome::Converged(report) => match self.jump(&course, leg) {
                    None => self.accept(&mut course, leg, report, recorder)?,
                    Some(refusal) => {
                        course.solves += report.iterations;
                        self.cut_back(&mut course);
                        self.refuse(&mut course, leg, &refusal, recorder)
                    }
                },
                Outcome::Refused(refusal, spent) => {
                    course.solves += spent;
                    self.cut_back(&mut course);
                    self.refuse(&mut course, leg, &refusal, recorder)
                }
            };
            if !go_on {
                return Ok(false);
            }
        }
        self.clock = self.clock + course.newton.clock;
        Ok(self.keeps_symmetry(&course, recorder))
    }

    /// Prepares a step.
    fn begin(&mut self, index: usize) -> Result<Course<'m>, RunError> {
        let model = self.model;
        let step = &model.steps[index];
        self.system.steered = steered(model, step);
        let newton = Newton::new(model, step, &self.system, &self.state);
        self.summary.sizes.dofs = self.summary.sizes.dofs.max(newton.unknowns());
        self.system.bulk.stabilise(step.viscosity);
        let massless = self.massless(step);
        if let (true, Some(place)) = (step.procedure.has_inertia(), &massless) {
            return Err(RunError::NoMass {
                step: index,
                name: step.name.clone(),
                place: place.clone(),
            });
        }
        let mut ladder = Ladder::new(model, step, massless.is_none());
        if self.state.energies.moving() > QUIET {
            // What the ladder has set in motion falls on.
            ladder.go_on_moving();
        }
        let mut course = Course::new(newton, ladder, index, step);
        course.steer(model, &self.system);
        course.watch = Watch::new(step, self.watched(index)[0]);
        if step.procedure.has_inertia() {
            self.set_in_motion(index);
        } else if !course.ladder.method().has_inertia() {
            self.bring_to_rest();
        }
        self.adopt(&mut course);
        // The boundary conditions change: the last increment says nothing of the next.
        self.state.last = None;
        Ok(course)
    }

    /// Goes on by the method of the ladder.
    fn adopt(&mut self, course: &mut Course) {
        let rung = course.ladder.rung();
        course
            .newton
            .adopt(rung, &mut self.system, &mut self.state, &mut self.trial);
    }

    /// Commits an increment and chooses the next; false if the run should stop.
    fn accept(
        &mut self,
        course: &mut Course<'m>,
        leg: Leg,
        report: Report,
        recorder: &mut dyn Recorder,
    ) -> Result<bool, RunError> {
        let solves = course.solves + report.iterations;
        let size = leg.increment.size;
        let added = report.load_factor - course.load;
        let before = self.state.energies;
        if let Some(motion) = course.newton.motion() {
            motion.end_shock();
        }
        let dq = self.commit(&mut course.newton, course.step, size, added);
        course.load = report.load_factor;
        let (index, cuts) = (course.index, course.cutbacks);
        let row = self.row(index, leg.method, report, leg.increment.end(), solves, cuts);
        match leg.method {
            // What the ladder leaves to inertia moves; what is to be quasi-static should not.
            Method::QuasiStatic if course.step.procedure == Procedure::QuasiStatic => {
                self.swings.add(&row);
            }
            Method::Implex if course.step.procedure == Procedure::Auto => self.snaps.add(&row),
            Method::QuasiStatic => {
                let reach = self.system.contact.reach();
                self.state.fell |= self.state.q.iter().any(|q| q.abs() > reach);
            }
            _ => {}
        }
        let growth = growth(leg, report, course.ladder.floor());
        if leg.method.follows_path() {
            course.schedule.reach(course.branch.time(course.load));
        } else if leg.method == Method::QuasiStatic && course.step.procedure == Procedure::Auto {
            let hurry = self.state.energies.kinetic / before.kinetic;
            course
                .schedule
                .accept(leg.increment, growth.min(resolving(hurry)));
        } else {
            course.schedule.accept(leg.increment, growth);
        }
        if let Some(measure) = course.measured_by() {
            let share = self.state.energies.dissipated_share(&before);
            let dissipates = measure == Method::ArcLength || share > SHARE;
            let (system, trial) = (&self.system, &self.trial);
            if !dissipates
                || !course
                    .trail
                    .learn(measure, system, trial, &dq, (size, added), growth)
            {
                course.trail.forget();
            }
        }
        let seen = self.watched(course.index);
        let why = course.watch.as_mut().and_then(|watch| watch.take(seen));
        let whole = course.is_whole();
        let end = whole || why.is_some();
        if let (Some(why), false) = (&why, whole) {
            self.stop(course, why, recorder);
        }
        let keep = self.record(&row, recorder, end)?;
        self.summary.increments += 1;
        self.summary.iterations += solves;
        (course.cutbacks, course.solves) = (0, 0);
        (course.repeat, course.end_refused) = (true, false);
        let done = course.schedule.done();
        if leg.method == Method::Static || course.beyond.is_some_and(|beyond| beyond <= done) {
            course.beyond = None;
        }
        let moving = self.state.energies.moving();
        let sense = course.sense();
        let forth = (sense * added, sense * course.load);
        if course.ladder.descend(report, moving, forth.0, forth.1) {
            if leg.method.has_inertia() {
                self.bring_to_rest();
                self.state.last = None;
            }
            if leg.method.follows_path() {
                // The pace of the path is none of the load.
                let pace = forth.0 / course.branch.slope().abs();
                course.schedule.resume(pace.max(course.ladder.floor()));
                self.state.last = None;
            }
            self.adopt(course);
            let why = format!("{} has passed the trouble", leg.method.name());
            self.note(course, &why, recorder);
        }
        let mut keeps_symmetry = true;
        if !end && course.is_at_row() {
            keeps_symmetry = self.keeps_symmetry(course, recorder);
            self.turn(course);
        }
        self.tally(&course.newton);
        let all_done = end && course.index + 1 == self.model.steps.len();
        self.offer(course, all_done || !keep || !keeps_symmetry, recorder)?;
        self.tally(&course.newton);
        if !keep {
            self.summary.status = Status::Interrupted;
            "stopped by the user".clone_into(&mut self.summary.message);
        }
        Ok(keep && keeps_symmetry)
    }

    /// Goes on along the next branch of the amplitude.
    fn turn(&mut self, course: &mut Course<'m>) {
        let before = course.branch.slope();
        course.row += 1;
        course.branch = course.step.branch(course.row);
        course.schedule.turn(course.branch);
        let slope = course.branch.slope();
        course
            .newton
            .turn(slope, &mut self.system, &mut self.state, &mut self.trial);
        if before * slope > 0.0 {
            // The same way at another rate.
            if let Some(last) = &mut self.state.last {
                last.dt *= before / slope;
            }
            return;
        }
        // Where loads turn round the last increment says nothing of the next.
        self.state.last = None;
        course.trail.forget();
        course.schedule.begin_small();
        course.beyond = None;
        if course.ladder.turn() {
            self.adopt(course);
        }
    }

    /// Chooses what to try after a refusal; false if nothing is left.
    fn refuse(
        &mut self,
        course: &mut Course,
        leg: Leg,
        refusal: &Refusal,
        recorder: &mut dyn Recorder,
    ) -> bool {
        let on_path = leg.method.follows_path();
        let method = course.ladder.method();
        if method.follows_path() && course.trail.leads(method) && !on_path {
            // The rest of the step in one: the path goes on instead.
            course.end_refused = true;
            return true;
        }
        let spent = if on_path {
            !course.trail.cut(CUT)
        } else {
            false
        };
        let size = leg.increment.size;
        if *refusal == Refusal::Snap {
            course.beyond = Some(leg.increment.end());
        }
        if course.ladder.is_last() && course.beyond.take().is_some() {
            // Not even there: over it in increments as large as may be.
            course.schedule.resume(course.step.increments.max);
            return true;
        }
        let mut answer = course.ladder.refused(refusal, size, spent);
        if method.follows_path() && !on_path && course.ladder.is_small(size) {
            // Nothing has dissipated yet, and nothing is found before something does.
            if self.guess(course, method, size) {
                return true;
            }
        }
        if answer == Answer::Cut && !on_path && course.schedule.cut(leg.increment, CUT).is_err() {
            answer = course.ladder.refused(refusal, size, true);
        }
        match answer {
            Answer::Cut => true,
            Answer::Climb => {
                let why = format!(
                    "{}: {}",
                    leg.method.name(),
                    explain::why(self.model, &self.part, course.step, refusal)
                );
                loop {
                    course.ladder.climb(refusal, course.sense() * course.load);
                    let next = course.ladder.method();
                    // Where loads stay there is no path of theirs.
                    let stays = course.branch.slope() == 0.0;
                    if !next.follows_path()
                        || (!stays && course.trail.leads(next))
                        || (!stays && self.guess(course, next, size))
                    {
                        break;
                    }
                }
                self.adopt(course);
                match course.ladder.method() {
                    Method::QuasiStatic => {
                        self.state.last = None;
                        course.schedule.resume(size.min(course.ladder.floor()));
                    }
                    // Its equations are linear: whatever cut the increment is not their trouble.
                    Method::Implex => course.schedule.resume(size.max(course.ladder.floor())),
                    // Nothing leads through: it is jumped over, as it was found or else from as far as may be.
                    Method::Static if course.ladder.is_last() => {
                        let beyond = course.beyond.map(|at| at - course.schedule.done());
                        let jump = beyond.unwrap_or(course.step.increments.max);
                        course.schedule.resume(jump);
                    }
                    method if method.follows_path() => course.trail.mend(),
                    _ => {}
                }
                self.note(course, &why, recorder);
                true
            }
            Answer::GiveUp => {
                self.summary.iterations += course.solves;
                self.tally(&course.newton);
                self.summary.status = Status::NotConverged;
                let done = match course.step.amplitude {
                    None => course.load,
                    Some(_) => course.schedule.done(),
                };
                self.summary.message =
                    explain::explain(self.model, &self.part, course.index, leg, done, refusal);
                false
            }
        }
    }

    /// Measures the path by the increment that was refused, for want of a better one; false if nothing
    /// dissipated in it.
    fn guess(&mut self, course: &mut Course, method: Method, size: f64) -> bool {
        let q = course.newton.q();
        let dq: Vec<f64> = q.iter().zip(&self.state.q).map(|(q, s)| q - s).collect();
        let (system, trial) = (&self.system, &self.trial);
        course
            .trail
            .learn(method, system, trial, &dq, (size, 0.0), GUESS)
    }

    /// Counts a refused or repeated increment.
    fn cut_back(&mut self, course: &mut Course) {
        course.cutbacks += 1;
        course.repeat = false;
        self.summary.cutbacks += 1;
    }

    /// Tells of a change of method.
    fn note(&mut self, course: &Course, why: &str, recorder: &mut dyn Recorder) {
        let text = format!(
            "step {} ({}), {}: {why}; goes on by {}",
            course.index,
            course.step.name,
            course.progress(),
            course.ladder.method().name()
        );
        recorder.note(&text);
        self.summary.log.push(text);
    }

    /// Ends a step before its loads are whole, as the deck has it.
    fn stop(&mut self, course: &mut Course, why: &str, recorder: &mut dyn Recorder) {
        course.stopped = true;
        let text = format!(
            "step {} ({}) ends at {}: {why}",
            course.index,
            course.step.name,
            course.progress()
        );
        recorder.note(&text);
        self.summary.log.push(text);
    }

    /// Statics brings to rest what moved.
    fn bring_to_rest(&mut self) {
        let state = &mut self.state;
        state.energies.numerical += std::mem::take(&mut state.energies.kinetic);
        for rates in [
            &mut state.velocity,
            &mut state.acceleration,
            &mut state.damping,
        ] {
            rates.fill(0.0);
        }
    }

    /// What moves in a step and has no mass.
    pub(super) fn massless(&self, step: &Step) -> Option<String> {
        let (model, system) = (self.model, &self.system);
        let free_beams = step.motion.iter().enumerate().flat_map(|(b, motion)| {
            let free = |i: &usize| matches!(motion[*i], BeamMotion::Force(_));
            (0..3).filter(free).map(move |i| (b, i))
        });
        let mut unknowns =
            (0..system.dofs.beam_start).chain(free_beams.map(|(b, i)| system.dofs.beam_slot(b, i)));
        let slot = unknowns.find(|&slot| system.mass.slot[slot] <= 0.0)?;
        Some(if slot >= system.dofs.beam_start {
            let beam = (slot - system.dofs.beam_start) / 3;
            format!("the beam {}", model.beams[beam].name)
        } else {
            let node = self.part.node(system.dofs.node_of(slot).0);
            format!("node {node}")
        })
    }

    /// Velocities of the model in the first step with inertia.
    fn set_in_motion(&mut self, index: usize) {
        let (model, system, state) = (self.model, &self.system, &mut self.state);
        let first = model.steps.iter().position(|s| s.procedure.has_inertia());
        if first == Some(index) && !model.initial_velocity.is_empty() {
            system
                .mass
                .mean_velocity(&system.dofs, &model.initial_velocity, &mut state.velocity);
            state.energies.kinetic = system.mass.kinetic_energy(&state.velocity);
            state.energies.external += state.energies.kinetic;
        }
    }

    /// Wall time so far.
    fn tally(&mut self, newton: &Newton) {
        let c = self.clock + newton.clock;
        self.summary.factorisations = c.factorisations;
        self.summary.reused = c.reused;
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

/// Stiffness along what steers the load of a step, which secant tangents want.
pub(super) fn steered(model: &Model, step: &Step) -> Option<Steered> {
    let controls = step.procedure == Procedure::DisplacementControl;
    let control = step
        .control
        .filter(|_| controls && step.tangent == Tangent::Secant)?;
    Steered::new(model, control)
}

/// Part of the energy that an increment takes in or gives back, from which on what it dissipates
/// measures the path.
const SHARE: f64 = 0.02;
/// Of an increment that was refused, the part that is tried first along the path.
const GUESS: f64 = 0.1;
